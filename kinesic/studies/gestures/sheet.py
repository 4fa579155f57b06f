"""Pictures of gestures: strips of key postures, and contact sheets by category."""

import io
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.files.late_pillow import Image
from kinesic.report.silhouette import (
    OWNER_COLOURS,
    OutlineWindow,
    PenStroke,
    fade_lines,
    outline_lines,
    project,
    silhouette,
)
from kinesic.studies.gestures.isolated import Show
from kinesic.studies.gestures.portraits import draw_stills

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MAX_POSTURES = 6  # largest number of key postures in the strip of one gesture

_FIGURE_HEIGHT = 0.97  # [paper units of `scale` inches] height of each drawn robot, tall or small
_LABEL_HEIGHT = 0.08  # [paper units of `scale` inches] height of the name below a drawn robot
_HEADING_HEIGHT = 0.16  # [paper units of `scale` inches] height of a category's heading
_FOOTER_HEIGHT = 0.20  # [paper units of `scale` inches] height of the footer of a strip
_SHEET_COLUMNS = 16  # number of drawn robots in a row of a contact sheet
_TITLE_COLOUR = "#222222"  # colour of titles
_NOTE_COLOUR = "#777777"  # colour of the texts below the drawn postures
_PATH_WIDTH = 0.007  # [m] line width of a palm path; in shaded pictures [paper units]
_PATH_BRIGHTNESS = 0.6  # brightness of a palm path / brightness of its arm
_ARROW_LENGTH = 0.035  # [m] length of an arrow head; in shaded pictures [paper units]
_POINTS_PER_INCH = 72  # typographic points per inch
_LINE_TONES = 96  # number of colours of a line drawing
_SHADED_TONES = 256  # number of colours of a shaded picture
PORTRAIT_ASPECT = 0.87  # width / height of a shaded picture of one posture


def draw_strip(show: Show, robot: Robot, path: Path, *, says: str = "", scale: float = 3.0, dots: int = 110) -> Path:
    """Draw key postures and palm paths of one gesture.

    Args:
        show: postures of the gesture.
        robot: robot that performs.
        path: path of the picture; its suffix selects the format.
        says: text below the picture.
        scale: inches per paper unit; a figure is 0.97 units high.
        dots: dots per inch.

    Returns:
        The path.
    """
    count = len(show.postures)
    bodies = [silhouette(robot, angles, _find_shapes(show.form, k, count)) for k, angles in enumerate(show.postures)]
    lines = [[*outline_lines(body), *_draw_palm_paths(show)] for body in bodies]
    window = OutlineWindow.around(line for drawn in lines for line in drawn)
    wide = window.wide * _FIGURE_HEIGHT / window.tall
    paper, axes = _strip_paper(show, wide, scale)
    for k, drawn in enumerate(lines):
        _draw(axes, drawn, window, np.array([k * wide, _FOOTER_HEIGHT]), scale)
    _caption(axes, show, says, scale)
    return _save(paper, path, dots)


def draw_portraits(
    show: Show, robot: Robot, path: Path, *, says: str = "", scale: float = 3.0, dots: int = 110
) -> Path:
    """Draw the key postures of one gesture with shading.

    The arguments are those of `draw_strip`.

    Raises:
        FilmError: OpenGL is not available.
    """
    wide = _FIGURE_HEIGHT * PORTRAIT_ASPECT
    tall = round(_FIGURE_HEIGHT * scale * dots)
    view, pictures = draw_stills(robot, show.postures, show.faces, (round(tall * PORTRAIT_ASPECT), tall))
    paper, axes = _strip_paper(show, wide, scale)
    for k, picture in enumerate(pictures):
        left, low = k * wide, _FOOTER_HEIGHT
        axes.imshow(picture, extent=(left, left + wide, low, low + _FIGURE_HEIGHT), aspect="auto", interpolation="none")
        middle = np.array([left + wide / 2, low + _FIGURE_HEIGHT / 2])
        paths = [
            line
            for side, path_points in show.paths.items()
            for line in _draw_path_with_arrow(_FIGURE_HEIGHT * view.project(path_points) + middle, side)
        ]
        _add_lines(axes, outline_lines(paths), scale)
    axes.set_xlim(0, len(pictures) * wide)
    axes.set_ylim(0, _FIGURE_HEIGHT + _FOOTER_HEIGHT)
    _caption(axes, show, says, scale)
    return _save(paper, path, dots, tones=_SHADED_TONES)


def _strip_paper(show: Show, wide: float, scale: float) -> tuple["Figure", "Axes"]:
    """Create an empty picture strip, labelled with the posture names."""
    paper, axes = _make_paper(len(show.postures) * wide, _FIGURE_HEIGHT + _FOOTER_HEIGHT, scale)
    for k in range(len(show.postures)):
        name = "stroke" if k == show.stroke else f"{k + 1}"
        axes.text((k + 0.5) * wide, _FOOTER_HEIGHT - 0.04, name, color=_NOTE_COLOUR, fontsize=2.9 * scale, ha="center")
    return paper, axes


def _caption(axes: "Axes", show: Show, says: str, scale: float) -> None:
    title = f"{show.form.id} ({show.form.category})"
    axes.text(0.02, 0.11, title, color=_TITLE_COLOUR, fontsize=3.5 * scale, weight="bold")
    axes.text(0.02, 0.03, says, color=_TITLE_COLOUR, fontsize=2.9 * scale)


def draw_gesture_sheet(shows: Sequence[Show], robot: Robot, path: Path, *, scale: float = 1.4, dots: int = 120) -> Path:
    """Draw a contact sheet: each gesture's stroke over its faded start posture.

    The figures are grouped by category.

    Args:
        shows: postures of gestures, in any order.
        robot: robot that performs.
        path: path of the picture; its suffix selects the format.
        scale: inches per paper unit; a figure is 0.97 units high.
        dots: dots per inch.

    Returns:
        The path.
    """
    drawn = {show.form.id: _draw_gesture_lines(show, robot) for show in shows}
    window = OutlineWindow.around(line for lines in drawn.values() for line in lines)
    wide, groups = window.wide * _FIGURE_HEIGHT / window.tall, _groups(shows)
    rows = sum(ceil(len(group) / _SHEET_COLUMNS) for _, group in groups)
    tall = rows * (_FIGURE_HEIGHT + _LABEL_HEIGHT) + len(groups) * _HEADING_HEIGHT
    paper, axes = _make_paper(_SHEET_COLUMNS * wide, tall, scale)
    top = tall
    for category, group in groups:
        top -= _HEADING_HEIGHT
        axes.text(
            0.04, top + 0.04, f"{category} ({len(group)})", color=_TITLE_COLOUR, fontsize=9 * scale, weight="bold"
        )
        for k, show in enumerate(group):
            row, column = divmod(k, _SHEET_COLUMNS)
            left, low = column * wide, top - (row + 1) * (_FIGURE_HEIGHT + _LABEL_HEIGHT)
            _draw(axes, drawn[show.form.id], window, np.array([left, low + _LABEL_HEIGHT]), scale)
            axes.text(left + wide / 2, low + 0.03, show.form.id, color=_TITLE_COLOUR, fontsize=5.6 * scale, ha="center")
        top -= ceil(len(group) / _SHEET_COLUMNS) * (_FIGURE_HEIGHT + _LABEL_HEIGHT)
    return _save(paper, path, dots)


def _draw_gesture_lines(show: Show, robot: Robot) -> list[PenStroke]:
    """Return the lines of a gesture: faded start, stroke posture, palm paths."""
    begins = fade_lines([line for line in silhouette(robot, show.postures[0], {}) if line.owner != "trunk"])
    shapes = _find_shapes(show.form, show.stroke, len(show.postures))
    return [*begins, *outline_lines(silhouette(robot, show.postures[show.stroke], shapes)), *_draw_palm_paths(show)]


def _groups(shows: Iterable[Show]) -> list[tuple[str, list[Show]]]:

    def key(show: Show) -> tuple[str, str]:
        return show.form.category, show.form.id

    return [(name, list(group)) for name, group in groupby(sorted(shows, key=key), lambda show: show.form.category)]


def _find_shapes(form: GestureForm, k: int, count: int) -> dict[Side, str | None]:
    """Return the hand shapes at one of a gesture's drawn postures."""
    keys = form.keys
    key_index = round(k * (len(keys) - 1) / max(1, count - 1)) if len(keys) > 1 else 0
    shapes: dict[Side, str | None] = {}
    for key in keys[: key_index + 1]:
        shapes |= {side: pose.shape for side, pose in key.hands.items()}
    return shapes


def _draw_palm_paths(show: Show) -> list[PenStroke]:
    """Return a gesture's palm paths with arrow heads as lines."""
    return [line for side, path in show.paths.items() for line in _draw_path_with_arrow(project(path), side)]


def _draw_path_with_arrow(points: Floats, side: Side) -> Iterator[PenStroke]:
    """Yield the lines of one palm path and its arrow head."""
    red, green, blue = (_PATH_BRIGHTNESS * part for part in OWNER_COLOURS[side])
    yield PenStroke(points, _PATH_WIDTH, (red, green, blue))
    before = points[np.linalg.norm(points - points[-1], axis=1) > _ARROW_LENGTH]
    if len(before):
        along = _ARROW_LENGTH * (points[-1] - before[-1]) / np.linalg.norm(points[-1] - before[-1])
        across = 0.5 * np.array([-along[1], along[0]])
        head = np.stack([points[-1] - along + across, points[-1], points[-1] - along - across])
        yield PenStroke(head, _PATH_WIDTH, (red, green, blue))


def _make_paper(wide: float, tall: float, scale: float) -> tuple["Figure", "Axes"]:
    """Return an empty matplotlib figure, `scale` inches per drawing unit."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415 - an extra
    from matplotlib.figure import Figure  # noqa: PLC0415 - an extra

    paper = Figure(figsize=(wide * scale, tall * scale), facecolor="white")
    FigureCanvasAgg(paper)
    axes = paper.add_axes((0, 0, 1, 1))
    axes.set_xlim(0, wide)
    axes.set_ylim(0, tall)
    axes.set_axis_off()
    return paper, axes


def _draw(axes: "Axes", lines: Sequence[PenStroke], window: OutlineWindow, at: Floats, scale: float) -> None:
    """Draw a robot's lines, scaled and moved to a paper position."""
    times = _FIGURE_HEIGHT / window.tall
    corner = np.array([-window.wide / 2, window.low])
    moved = [replace(line, points=times * (line.points - corner) + at, width=times * line.width) for line in lines]
    _add_lines(axes, moved, scale)


def _add_lines(axes: "Axes", lines: Sequence[PenStroke], scale: float) -> None:
    """Add lines to the figure in drawing order."""
    from matplotlib.collections import LineCollection  # noqa: PLC0415 - an extra

    axes.add_collection(
        LineCollection(
            [line.points for line in lines],
            linewidths=[line.width * scale * _POINTS_PER_INCH for line in lines],
            colors=[line.colour for line in lines],
            capstyle="round",
            joinstyle="round",
        ),
        autolim=False,
    )


def check_picture(path: Path) -> None:
    """Check that a path's suffix is a picture format.

    Raises:
        ConfigError: it is not; the text lists the formats.
    """
    from matplotlib.backend_bases import FigureCanvasBase  # noqa: PLC0415 - an extra

    formats = FigureCanvasBase.get_supported_filetypes()
    if path.suffix[1:].lower() not in formats:
        raise ConfigError(
            f"{path}: the suffix of a picture must be one of {', '.join(f'.{suffix}' for suffix in sorted(formats))}"
        )


def _save(paper: "Figure", path: Path, dots: int, *, tones: int = _LINE_TONES) -> Path:
    """Save a matplotlib sheet as a picture file.

    PNG files get few colours to be small.
    """
    if path.suffix.lower() != ".png":
        paper.savefig(path, dpi=dots)
        return path
    drawn = io.BytesIO()
    paper.savefig(drawn, dpi=dots, format="png", metadata={"Software": None})
    Image.open(drawn).convert("RGB").quantize(tones).save(path, optimize=True)
    return path
