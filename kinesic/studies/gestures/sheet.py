"""Pictures of gestures: one as a strip of key postures, many as a contact sheet grouped by category."""

import io
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
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
from kinesic.studies.gestures.framing import OutlineWindow
from kinesic.studies.gestures.isolated import Show
from kinesic.studies.gestures.portraits import draw_stills
from kinesic.studies.gestures.silhouette import COLOURS, PenStroke, outline_lines, pale, project, silhouette

MOST_POSTURES = 6  # key postures in a strip

_TALL = 0.97  # on paper, whose unit that makes: what is seen of a robot is drawn so high, however tall it is
_LABEL, _HEADING = 0.08, 0.16  # below each figure and above each category
_FOOTER = 0.20  # below a strip
_COLUMNS = 16
_INK, _FAINT = "#222222", "#777777"
_WAY_WIDTH, _DARKER = 0.007, 0.6  # of the picture's height, and times the colour of the arm
_ARROW = 0.035  # of the picture's height
_POINTS = 72  # to an inch
_TONES = 96
_MOST_TONES = 256
PORTRAIT = 0.87  # width to height of a portrait


def draw_strip(show: Show, robot: Robot, path: Path, *, says: str = "", scale: float = 3.0, dots: int = 110) -> Path:
    """Draws the key postures of one gesture side by side, the ways of its palms in each.

    Args:
        show: the gesture.
        robot: that plays it.
        path: of the picture; its ending says the format.
        says: what is written below.
        scale: [in] of the paper's unit; a figure is 0.97 units high.
        dots: to an inch.

    Returns:
        The path.
    """
    count = len(show.postures)
    bodies = [silhouette(robot, angles, _shapes(show.form, k, count)) for k, angles in enumerate(show.postures)]
    lines = [[*outline_lines(body), *_ways(show)] for body in bodies]
    window = OutlineWindow.around(line for drawn in lines for line in drawn)
    wide = window.wide * _TALL / window.tall
    paper, axes = _strip_paper(show, wide, scale)
    for k, drawn in enumerate(lines):
        _draw(axes, drawn, window, np.array([k * wide, _FOOTER]), scale)
    _caption(axes, show, says, scale)
    return _saved(paper, path, dots)


def draw_portraits(
    show: Show, robot: Robot, path: Path, *, says: str = "", scale: float = 3.0, dots: int = 110
) -> Path:
    """Draws the same as `draw_strip` does, with light and shade; its arguments are the same.

    Raises:
        FilmError: OpenGL does not draw on this machine.
    """
    wide = _TALL * PORTRAIT
    tall = round(_TALL * scale * dots)
    view, pictures = draw_stills(robot, show.postures, show.faces, (round(tall * PORTRAIT), tall))
    paper, axes = _strip_paper(show, wide, scale)
    for k, picture in enumerate(pictures):
        left, low = k * wide, _FOOTER
        axes.imshow(picture, extent=(left, left + wide, low, low + _TALL), aspect="auto", interpolation="none")
        middle = np.array([left + wide / 2, low + _TALL / 2])
        ways = [line for side, way in show.paths.items() for line in _way(_TALL * view.project(way) + middle, side)]
        _add_lines(axes, outline_lines(ways), scale)
    axes.set_xlim(0, len(pictures) * wide)
    axes.set_ylim(0, _TALL + _FOOTER)
    _caption(axes, show, says, scale)
    return _saved(paper, path, dots, tones=_MOST_TONES)


def _strip_paper(show: Show, wide: float, scale: float) -> tuple[Figure, Axes]:
    """An empty strip, with the names of its postures."""
    paper, axes = _paper(len(show.postures) * wide, _TALL + _FOOTER, scale)
    for k in range(len(show.postures)):
        name = "stroke" if k == show.stroke else f"{k + 1}"
        axes.text((k + 0.5) * wide, _FOOTER - 0.04, name, color=_FAINT, fontsize=2.9 * scale, ha="center")
    return paper, axes


def _caption(axes: Axes, show: Show, says: str, scale: float) -> None:
    title = f"{show.form.id} ({show.form.category})"
    axes.text(0.02, 0.11, title, color=_INK, fontsize=3.5 * scale, weight="bold")
    axes.text(0.02, 0.03, says, color=_INK, fontsize=2.9 * scale)


def draw_gesture_sheet(shows: Sequence[Show], robot: Robot, path: Path, *, scale: float = 1.4, dots: int = 120) -> Path:
    """Draws each gesture once, at its stroke, over the shadow of how its arms begin; grouped by category.

    Args:
        shows: in any order.
        robot: that plays them.
        path: of the picture; its ending says the format.
        scale: [in] of the paper's unit; a figure is 0.97 units high.
        dots: to an inch.

    Returns:
        The path.
    """
    drawn = {show.form.id: _outlined(show, robot) for show in shows}
    window = OutlineWindow.around(line for lines in drawn.values() for line in lines)
    wide, groups = window.wide * _TALL / window.tall, _groups(shows)
    rows = sum(ceil(len(group) / _COLUMNS) for _, group in groups)
    tall = rows * (_TALL + _LABEL) + len(groups) * _HEADING
    paper, axes = _paper(_COLUMNS * wide, tall, scale)
    top = tall
    for category, group in groups:
        top -= _HEADING
        axes.text(0.04, top + 0.04, f"{category} ({len(group)})", color=_INK, fontsize=9 * scale, weight="bold")
        for k, show in enumerate(group):
            row, column = divmod(k, _COLUMNS)
            left, low = column * wide, top - (row + 1) * (_TALL + _LABEL)
            _draw(axes, drawn[show.form.id], window, np.array([left, low + _LABEL]), scale)
            axes.text(left + wide / 2, low + 0.03, show.form.id, color=_INK, fontsize=5.6 * scale, ha="center")
        top -= ceil(len(group) / _COLUMNS) * (_TALL + _LABEL)
    return _saved(paper, path, dots)


def _outlined(show: Show, robot: Robot) -> list[PenStroke]:
    """One gesture of the sheet."""
    begins = pale([line for line in silhouette(robot, show.postures[0], {}) if line.owner != "trunk"])
    shapes = _shapes(show.form, show.stroke, len(show.postures))
    return [*begins, *outline_lines(silhouette(robot, show.postures[show.stroke], shapes)), *_ways(show)]


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
    return [line for side, path in show.paths.items() for line in _way(project(path), side)]


def _way(points: Floats, side: Side) -> Iterator[PenStroke]:
    """One way, and the arrow at its end."""
    red, green, blue = (_DARKER * part for part in COLOURS[side])
    yield PenStroke(points, _WAY_WIDTH, (red, green, blue))
    before = points[np.linalg.norm(points - points[-1], axis=1) > _ARROW]
    if len(before):
        along = _ARROW * (points[-1] - before[-1]) / np.linalg.norm(points[-1] - before[-1])
        across = 0.5 * np.array([-along[1], along[0]])
        head = np.stack([points[-1] - along + across, points[-1], points[-1] - along - across])
        yield PenStroke(head, _WAY_WIDTH, (red, green, blue))


def _paper(wide: float, tall: float, scale: float) -> tuple[Figure, Axes]:
    """An empty sheet of (wide, tall) [m], `scale` [in/m]."""
    paper = Figure(figsize=(wide * scale, tall * scale), facecolor="white")
    FigureCanvasAgg(paper)
    axes = paper.add_axes((0, 0, 1, 1))
    axes.set_xlim(0, wide)
    axes.set_ylim(0, tall)
    axes.set_axis_off()
    return paper, axes


def _draw(axes: Axes, lines: Sequence[PenStroke], window: OutlineWindow, at: Floats, scale: float) -> None:
    """Lines in their order, what is seen of them put with its lower left corner to a place (2,) on paper."""
    times = _TALL / window.tall
    corner = np.array([-window.wide / 2, window.low])
    moved = [replace(line, points=times * (line.points - corner) + at, width=times * line.width) for line in lines]
    _add_lines(axes, moved, scale)


def _add_lines(axes: Axes, lines: Sequence[PenStroke], scale: float) -> None:
    """Lines in their order, on paper."""
    axes.add_collection(
        LineCollection(
            [line.points for line in lines],
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


def _saved(paper: Figure, path: Path, dots: int, *, tones: int = _TONES) -> Path:
    """Writes a picture; PNG with few colours, so that it is small."""
    if path.suffix.lower() != ".png":
        paper.savefig(path, dpi=dots)
        return path
    drawn = io.BytesIO()
    paper.savefig(drawn, dpi=dots, format="png", metadata={"Software": None})
    Image.open(drawn).convert("RGB").quantize(tones).save(path, optimize=True)
    return path
