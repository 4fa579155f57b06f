"""Draws the figures of the report as deterministic SVG in the colours of the page, light or dark."""

import io
import re
import warnings
from collections.abc import Iterable
from enum import StrEnum
from typing import TYPE_CHECKING, Literal

import numpy as np
from markupsafe import Markup

from kinesic.body.arrays import Floats
from kinesic.report.checks.servos import FULL, DriveLoad

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


class Colour(StrEnum):
    """Stand-ins that become variables of the page's style sheet, so that one figure suits light and dark."""

    INK = "#010101"
    FAINT = "#020202"
    GRID = "#030303"
    OUTSIDE = "#040404"
    ASKED = "#050505"
    PLANNED = "#060606"
    PERFORMED = "#070707"
    SPEECH = "#080808"
    FAIL = "#090909"


_NO_METADATA = dict.fromkeys(("Creator", "Date", "Format", "Type"))
_UNNEEDED_ID = re.compile(r' id="(?:figure|axes|patch|line2d|text|matplotlib\.axis|xtick|ytick|legend)\w*"')
_SIZE = re.compile(r' (?:width|height)="[^"]*"')
_PATH = re.compile(r' d="[^"]*"')
_LONG_NUMBER = re.compile(r"(\.\d\d)\d+")

TIME = "performance time"
WIDTH = 11.0  # [in] of every figure; the page scales it
SMALL = 7.5  # [pt]
POINTS = 1000  # of one line; more cannot be seen
_LETTER = 0.55 * SMALL / 72  # [in] mean width
DASHES = (0, (4, 2))  # of lines that show what was performed
BINS = 150
TALLEST = 1.25  # duty at the top
HEIGHT = 24


def empty_figure(height: float) -> "Figure":
    """Makes an empty figure, `height` [in] high."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - slow to import, and few performances are drawn

    return Figure(figsize=(WIDTH, height))


def svg(drawn: "Figure") -> Markup:
    """Makes an element of the page from a figure."""
    from matplotlib import rc_context  # noqa: PLC0415 - as above

    text = io.StringIO()
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "kinesic"}), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph", category=UserWarning)  # the browser has fonts of its own
        drawn.savefig(text, format="svg", transparent=True, metadata=_NO_METADATA)
    body = text.getvalue()
    body = body[body.index("<svg") :]
    opening, rest = body.split(">", 1)
    body = _SIZE.sub("", opening) + ">" + rest
    body = _PATH.sub(lambda found: _LONG_NUMBER.sub(r"\1", found.group()), _UNNEEDED_ID.sub("", body))
    for colour in Colour:
        body = body.replace(colour, f"var(--{colour.name.lower()})")
    columns = sorted(
        {(box.x0, box.x1) for axes in drawn.axes if axes.get_label() == TIME and (box := axes.get_position())}
    )
    heads = "".join(f'<i class="playhead" data-from="{x0:.5f}" data-to="{x1:.5f}"></i>' for x0, x1 in columns)
    return Markup(f'<div class="plot"><div>{body}{heads}</div></div>')  # Matplotlib escapes every text in it


def time_axes(axes: "Axes", *, end: float, ticks: int = 3) -> None:
    """Prepares plain axes over performance time, 0..end [s], on which the replay shows where it is."""
    plain(axes, ticks=ticks)
    axes.set_xlim(0.0, end)
    axes.set_label(TIME)


def plain(axes: "Axes", *, ticks: int = 3) -> None:
    """Reduces axes to few ticks, a faint grid and faint spines."""
    from matplotlib.ticker import MaxNLocator  # noqa: PLC0415 - as above

    axes.yaxis.set_major_locator(MaxNLocator(ticks))
    axes.tick_params(length=2, width=0.5, labelsize=SMALL, color=Colour.FAINT, labelcolor=Colour.FAINT)
    axes.grid(visible=True, color=Colour.GRID, linewidth=0.5)
    axes.set_axisbelow(True)
    for spine in axes.spines.values():
        spine.set(color=Colour.GRID, linewidth=0.5)


def write_text(
    axes: "Axes",
    at: tuple[float, float],
    words: str,
    *,
    colour: str = Colour.INK,
    place: Literal["axes", "time", "data"] = "axes",
    align: Literal["left", "center", "right"] = "left",
) -> None:
    """Writes a text as it stands, without mathematics.

    Args:
        axes: where.
        at: the text's side that `align` names, and its base line.
        words: may come from strangers.
        colour: of the text.
        place: "axes": both of `at` are shares of the axes; "time": the first is a time; "data": both are data.
        align: which side of the text lies there.
    """
    transform = {"axes": axes.transAxes, "time": axes.get_xaxis_transform(), "data": axes.transData}[place]
    printable = "".join(letter if letter.isprintable() else " " for letter in words)
    axes.text(*at, printable, fontsize=SMALL, color=colour, ha=align, transform=transform, parse_math=False)


def write_heading(axes: "Axes", what: str, note: str, *, height: float) -> None:
    """Writes what is shown above the left end of axes, and a note above the right end, at a share of their height."""
    write_text(axes, (0.0, height), what)
    write_text(axes, (1.0, height), note, colour=Colour.FAINT, align="right")


def fit_text(words: str, width: float) -> str:
    """Cuts a text to a width [in]."""
    letters = int(width / _LETTER)
    return words if len(words) <= letters else words[: letters - 1] + "\u2026" if letters > 1 else ""


def spaced_indices(times: Iterable[float], least: float) -> list[int]:
    """Picks times, in increasing order, that leave at least `least` [s] between them, by their indices."""
    kept: list[int] = []
    last = -np.inf
    for k, time in enumerate(times):
        if time - last >= least:
            kept.append(k)
            last = time
    return kept


def thin_line(times: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Thins a line of (m,) times and values to about `POINTS` points that show the same extremes."""
    size = int(np.ceil(2 * len(times) / POINTS))
    if size < 3:
        return times, values
    starts = np.arange(0, len(times), size)
    pieces = np.split(values, starts[1:])
    extremes = [
        sorted({start + int(p.argmin()), start + int(p.argmax())}) for start, p in zip(starts, pieces, strict=True)
    ]
    kept = np.unique([0, len(times) - 1, *(k for pair in extremes for k in pair)])
    return times[kept], values[kept]


def spark(load: DriveLoad) -> Markup:
    """Draws the largest duty of each piece of time as an area, and a line at full duty."""
    edges = np.linspace(0, len(load.duties), min(BINS, len(load.duties)) + 1).astype(int)[:-1]
    tops = HEIGHT * (1 - np.minimum(np.maximum.reduceat(load.duties, edges), TALLEST) / TALLEST)
    points = "".join(f"L{k} {top:.3g}" for k, top in enumerate(tops))
    full = HEIGHT * (1 - FULL / TALLEST)
    return Markup(
        f'<svg class="spark" viewBox="0 0 {max(len(tops) - 1, 1)} {HEIGHT}" preserveAspectRatio="none" '
        f'role="img" aria-label="duty over time"><path d="M0 {HEIGHT}{points}V{HEIGHT}Z"/>'
        f'<path class="full" d="M0 {full:.3g}H{len(tops)}"/></svg>'
    )
