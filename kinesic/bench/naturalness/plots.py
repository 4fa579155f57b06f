"""Draws how gestures of the lexicon move beside those of people."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kinesic.bench.expressivity.lexicon import NEUTRAL_STYLE
from kinesic.bench.figure import INK, OTHERS, OURS, SECOND, SMALL, label_axes, picture
from kinesic.bench.naturalness.bars import APART, COMPARED, MEDIANS, kolmogorov_smirnov
from kinesic.bench.naturalness.captured_table import captured_table
from kinesic.bench.naturalness.lexicon import MeasuredGesture, by_style
from kinesic.bench.naturalness.rows import PERCENTILES, ROWS, values
from kinesic.body.arrays import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PEOPLE = "captured"
DRAWN = (  # rows, a panel each
    *("largest_speed", "preparation_speed", "stroke_speed", "return_speed"),
    *("flow", "units_per_second", "sparc", "path"),
    *("duration", "stroke_time", "hold_time", "return_time"),
)
COLUMNS = 4
MOST = 99  # percent of what is compared, that is drawn
FAINT, STRONG = 2.0, 6.0  # [pt] of lines from the 5th to the 95th percentile, and between the quartiles


def draw(gestures: Sequence[MeasuredGesture], folder: Path) -> list[Path]:
    """Draws the percentiles of every row by manner and, of the neutral one, its distributions.

    Args:
        gestures: of the lexicon, in any manners.
        folder: for the pictures.

    Returns:
        The pictures.
    """
    styles = {style: [each.hand for each in group if each.hand] for style, group in by_style(gestures).items()}
    manners = (PEOPLE, *styles)
    pictures = [folder / "naturalness.png"]
    with picture(pictures[0], 13.0, 0.25 * (len(manners) + 4) * len(DRAWN) / COLUMNS) as drawn:
        panels = drawn.subplots(len(DRAWN) // COLUMNS, COLUMNS, sharey=True)
        panels[0, 0].set_yticks([-row for row in range(len(manners))], manners)
        for axes, name in zip(panels.flat, DRAWN, strict=True):
            known = {style: values(name, hands) for style, hands in styles.items()}
            strips = {style: np.percentile(found, PERCENTILES) for style, found in known.items() if found.size}
            strips[PEOPLE] = np.array(captured_table().percentiles[name])
            _draw_strips(axes, name, {manners.index(manner): strip for manner, strip in strips.items()})
    if NEUTRAL_STYLE in styles:
        pictures.append(folder / "naturalness-distances.png")
        with picture(pictures[1], 13.0, 2.7) as drawn:
            for axes, name in zip(drawn.subplots(1, len(COMPARED), sharey=True), COMPARED, strict=True):
                _draw_shares(axes, name, values(name, styles[NEUTRAL_STYLE]))
    return pictures


def _draw_strips(axes: "Axes", name: str, strips: Mapping[int, Floats]) -> None:
    """One line per manner, by its row: the 5th to the 95th percentile, the quartiles, the median."""
    for row, (low, first, median, third, high) in strips.items():
        colour = (SECOND, OURS, OTHERS)[min(row, 2)]
        axes.plot([low, high], [-row, -row], color=colour, linewidth=FAINT, alpha=0.5, solid_capstyle="butt")
        axes.plot([first, third], [-row, -row], color=colour, linewidth=STRONG, alpha=0.6, solid_capstyle="butt")
        axes.plot([median], [-row], color=INK, marker="o", markersize=3)
    if name in MEDIANS:
        axes.axvline(MEDIANS[name], color=INK, linewidth=0.8, linestyle="--")
    axes.tick_params(labelsize=SMALL, length=2)
    axes.grid(axis="x", alpha=0.3)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    label_axes(axes, ROWS[name].unit, title=ROWS[name].words)


def _draw_shares(axes: "Axes", name: str, ours: Floats) -> None:
    """Shares of gestures up to each value, of people and of the lexicon."""
    people = np.array(captured_table().values[name])
    for found, colour, words in ((people, SECOND, PEOPLE), (ours, OURS, NEUTRAL_STYLE)):
        places = np.sort(found)
        axes.step(places, np.arange(1, len(places) + 1) / len(places), color=colour, where="post", label=words)
    apart = kolmogorov_smirnov(ours, people)
    label_axes(axes, f"{ROWS[name].words} [{ROWS[name].unit}]", title=f"{apart:.2f} apart (goal {APART})")
    axes.tick_params(labelsize=SMALL, length=2)
    axes.grid(alpha=0.3)
    axes.set_ylim(0.0, 1.0)
    axes.set_xlim(0.0, 1.05 * float(np.percentile(np.concatenate([ours, people]), MOST)))
    if name == COMPARED[0]:
        axes.set_ylabel("share of gestures", fontsize=SMALL, color=INK)
        axes.legend(fontsize=SMALL, frameon=False)
