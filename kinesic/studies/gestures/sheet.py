"""Pictures of gestures: one as a strip of key postures, many as a contact sheet grouped by category."""

import io
from collections.abc import Iterable, Sequence
from itertools import groupby
from math import ceil
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backend_bases import FigureCanvasBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from PIL import Image

from kinesic.body.arrays import Floats
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.studies.gestures.isolated import Show
from kinesic.studies.gestures.silhouette import COLOURS, PenStroke, outline_lines, pale, project, silhouette

MOST = 6  # key postures in a strip

_LEFT, _RIGHT, _LOW, _HIGH = -0.42, 0.42, 0.37, 1.34  # [m] what is seen of the robot
_WIDE, _TALL = _RIGHT - _LEFT, _HIGH - _LOW
_LABEL, _HEADING = 0.08, 0.16  # [m] on paper, below each figure and above each category
_COLUMNS = 16
_INK, _FAINT = "#222222", "#777777"
_WAY_WIDTH, _DARKER = 0.007, 0.6  # [m], and times the colour of the arm
_ARROW = 0.035  # [m]
_POINTS = 72  # to an inch
_TONES = 96


def draw_strip(show: Show, robot: Robot, path: Path, *, says: str = "", scale: float = 3.0, dots: int = 110) -> Path:
    """Draws the key postures of one gesture side by side, the ways of its palms in each.

    Args:
        show: the gesture.
        robot: that plays it.
        path: of the picture; its ending says the format.
        says: what is written below.
        scale: [in/m] on paper.
        dots: to an inch.

    Returns:
        The path.
    """
    count = len(show.postures)
    paper, axes = _paper(count * _WIDE, _TALL + 2 * _LABEL, scale)
    for k, angles in enumerate(show.postures):
        body = silhouette(robot, angles, _shapes(show.form, k, count))
        lines = [*outline_lines(body), *_ways(show)]
        _draw(axes, lines, np.array([k * _WIDE - _LEFT, 2 * _LABEL - _LOW]), scale)
        name = "stroke" if k == show.stroke else f"{k + 1}"
        axes.text((k + 0.5) * _WIDE, 2 * _LABEL + 0.01, name, color=_FAINT, fontsize=2.9 * scale, ha="center")
    title = f"{show.form.id} ({show.form.category})"
    axes.text(0.02, 0.11, title, color=_INK, fontsize=3.5 * scale, weight="bold")
    axes.text(0.02, 0.03, says, color=_INK, fontsize=2.9 * scale)
    return _saved(paper, path, dots)


def draw_gesture_sheet(shows: Sequence[Show], robot: Robot, path: Path, *, scale: float = 1.4, dots: int = 120) -> Path:
    """Draws each gesture once, at its stroke, over the shadow of how its arms begin; grouped by category.

    Args:
        shows: in any order.
        robot: that plays them.
        path: of the picture; its ending says the format.
        scale: [in/m] on paper.
        dots: to an inch.

    Returns:
        The path.
    """
    groups = _groups(shows)
    rows = sum(ceil(len(group) / _COLUMNS) for _, group in groups)
    tall = rows * (_TALL + _LABEL) + len(groups) * _HEADING
    paper, axes = _paper(_COLUMNS * _WIDE, tall, scale)
    top = tall
    for category, group in groups:
        top -= _HEADING
        axes.text(0.04, top + 0.04, f"{category} ({len(group)})", color=_INK, fontsize=9 * scale, weight="bold")
        for k, show in enumerate(group):
            row, column = divmod(k, _COLUMNS)
            corner = np.array([column * _WIDE, top - (row + 1) * (_TALL + _LABEL)])
            _cell(axes, show, robot, corner, scale)
        top -= ceil(len(group) / _COLUMNS) * (_TALL + _LABEL)
    return _saved(paper, path, dots)


def _cell(axes: Axes, show: Show, robot: Robot, corner: Floats, scale: float) -> None:
    """One gesture of the sheet, its lower left corner given [m on paper]."""
    count = len(show.postures)
    begins = pale([line for line in silhouette(robot, show.postures[0], {}) if line.owner != "trunk"])
    body = silhouette(robot, show.postures[show.stroke], _shapes(show.form, show.stroke, count))
    at = corner + np.array([-_LEFT, _LABEL - _LOW])
    _draw(axes, [*begins, *outline_lines(body), *_ways(show)], at, scale)
    middle = corner[0] + _WIDE / 2
    axes.text(middle, corner[1] + 0.03, show.form.id, color=_INK, fontsize=5.6 * scale, ha="center")


def _groups(shows: Iterable[Show]) -> list[tuple[str, list[Show]]]:

    def key(show: Show) -> tuple[str, str]:
        return show.form.category, show.form.id

    return [(name, list(group)) for name, group in groupby(sorted(shows, key=key), lambda show: show.form.category)]


def _shapes(form: GestureForm, k: int, count: int) -> dict[Side, str | None]:
    """Hand shapes at one of the drawn postures: those of the form's key that is as far along."""
    keys = form.keys
    near = round(k * (len(keys) - 1) / max(1, count - 1)) if len(keys) > 1 else 0
    shapes: dict[Side, str | None] = {}
    for key in keys[: near + 1]:
        shapes |= {side: pose.shape for side, pose in key.hands.items()}
    return shapes


def _ways(show: Show) -> list[PenStroke]:
    """The ways of the palms, with arrows where they end."""
    lines: list[PenStroke] = []
    for side, path in show.paths.items():
        points = project(path)
        red, green, blue = (_DARKER * part for part in COLOURS[side])
        lines.append(PenStroke(points, _WAY_WIDTH, (red, green, blue)))
        before = points[np.linalg.norm(points - points[-1], axis=1) > _ARROW]
        if len(before):
            along = _ARROW * (points[-1] - before[-1]) / np.linalg.norm(points[-1] - before[-1])
            across = 0.5 * np.array([-along[1], along[0]])
            head = np.stack([points[-1] - along + across, points[-1], points[-1] - along - across])
            lines.append(PenStroke(head, _WAY_WIDTH, (red, green, blue)))
    return lines


def _paper(wide: float, tall: float, scale: float) -> tuple[Figure, Axes]:
    """An empty sheet of (wide, tall) [m], `scale` [in/m]."""
    paper = Figure(figsize=(wide * scale, tall * scale), facecolor="white")
    FigureCanvasAgg(paper)
    axes = paper.add_axes((0, 0, 1, 1))
    axes.set_xlim(0, wide)
    axes.set_ylim(0, tall)
    axes.set_axis_off()
    return paper, axes


def _draw(axes: Axes, lines: Sequence[PenStroke], at: Floats, scale: float) -> None:
    """Lines in their order, moved to a place on paper (2,) [m]."""
    axes.add_collection(
        LineCollection(
            [line.points + at for line in lines],
            linewidths=[line.width * scale * _POINTS for line in lines],
            colors=[line.colour for line in lines],
            capstyle="round",
            joinstyle="round",
        ),
        autolim=False,
    )


def check_picture(path: Path) -> None:
    """Refuses a path whose ending names no format of pictures.

    Raises:
        ConfigError: it does not; names those that do.
    """
    known = FigureCanvasBase.get_supported_filetypes()
    if path.suffix[1:].lower() not in known:
        raise ConfigError(
            f"{path}: a picture of gestures ends in {', '.join(f'.{ending}' for ending in sorted(known))}"
        )


def _saved(paper: Figure, path: Path, dots: int) -> Path:
    """Writes a picture; PNG with few colours, so that it is small."""
    if path.suffix.lower() != ".png":
        paper.savefig(path, dpi=dots)
        return path
    drawn = io.BytesIO()
    paper.savefig(drawn, dpi=dots, format="png", metadata={"Software": None})
    Image.open(drawn).convert("RGB").quantize(_TONES).save(path, optimize=True)
    return path
