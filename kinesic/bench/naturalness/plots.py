"""Plots of gesture motion of the lexicon compared with people."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kinesic.bench.expressivity.lexicon import NEUTRAL_STYLE
from kinesic.bench.metric import INK_COLOUR, LABEL_SIZE, MAIN_COLOUR, OTHER_COLOUR, SECOND_COLOUR, label_axes, picture
from kinesic.bench.naturalness.bars import COMPARED_ROWS, MAX_DISTANCE, MEDIAN_GOALS, kolmogorov_smirnov
from kinesic.bench.naturalness.captured_table import read_captured_table
from kinesic.bench.naturalness.lexicon import MeasuredGesture, group_by_style
from kinesic.bench.naturalness.rows import MOTION_ROWS, ROW_PERCENTILES, values
from kinesic.body.arrays import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PEOPLE_LABEL = "captured"
DRAWN_ROWS = (  # hand-motion measures, one panel each
    *("largest_speed", "preparation_speed", "stroke_speed", "return_speed"),
    *("flow", "units_per_second", "sparc", "path"),
    *("duration", "stroke_time", "hold_time", "return_time"),
)
PANEL_COLUMNS = 4  # panels per row of the plot
MAX_PERCENTILE = 99  # [%] percentile of the values at which the plot's axis ends
RANGE_LINE_WIDTH = 2.0  # [pt] width of the line from the 5th to the 95th percentile
QUARTILE_LINE_WIDTH = 6.0  # [pt] width of the line between the quartiles


def draw(gestures: Sequence[MeasuredGesture], folder: Path) -> list[Path]:
    """Draw percentiles by style and distributions of the neutral style.

    Args:
        gestures: gestures of the lexicon in any styles.
        folder: folder of the pictures.

    Returns:
        Paths of the pictures.
    """
    styles = {
        style: [gesture.hand for gesture in group if gesture.hand] for style, group in group_by_style(gestures).items()
    }
    labels = (PEOPLE_LABEL, *styles)
    pictures = [folder / "naturalness.png"]
    with picture(pictures[0], 13.0, 0.25 * (len(labels) + 4) * len(DRAWN_ROWS) / PANEL_COLUMNS) as drawn:
        panels = drawn.subplots(len(DRAWN_ROWS) // PANEL_COLUMNS, PANEL_COLUMNS, sharey=True)
        panels[0, 0].set_yticks([-row for row in range(len(labels))], labels)
        for axes, name in zip(panels.flat, DRAWN_ROWS, strict=True):
            rows = {style: values(name, hands) for style, hands in styles.items()}
            strips = {style: np.percentile(row, ROW_PERCENTILES) for style, row in rows.items() if row.size}
            strips[PEOPLE_LABEL] = np.array(read_captured_table().percentiles[name])
            _draw_strips(axes, name, {labels.index(label): strip for label, strip in strips.items()})
    if NEUTRAL_STYLE in styles:
        pictures.append(folder / "naturalness-distances.png")
        with picture(pictures[1], 13.0, 2.7) as drawn:
            for axes, name in zip(drawn.subplots(1, len(COMPARED_ROWS), sharey=True), COMPARED_ROWS, strict=True):
                _draw_distributions(axes, name, values(name, styles[NEUTRAL_STYLE]))
    return pictures


def _draw_strips(axes: "Axes", name: str, strips: Mapping[int, Floats]) -> None:
    """Draw percentiles of each style as lines.

    5th to 95th, quartiles and median.
    """
    for row, (low, first, median, third, high) in strips.items():
        colour = (SECOND_COLOUR, MAIN_COLOUR, OTHER_COLOUR)[min(row, 2)]
        axes.plot([low, high], [-row, -row], color=colour, linewidth=RANGE_LINE_WIDTH, alpha=0.5, solid_capstyle="butt")
        axes.plot(
            [first, third], [-row, -row], color=colour, linewidth=QUARTILE_LINE_WIDTH, alpha=0.6, solid_capstyle="butt"
        )
        axes.plot([median], [-row], color=INK_COLOUR, marker="o", markersize=3)
    if name in MEDIAN_GOALS:
        axes.axvline(MEDIAN_GOALS[name], color=INK_COLOUR, linewidth=0.8, linestyle="--")
    axes.tick_params(labelsize=LABEL_SIZE, length=2)
    axes.grid(axis="x", alpha=0.3)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    label_axes(axes, MOTION_ROWS[name].unit, title=MOTION_ROWS[name].words)


def _draw_distributions(axes: "Axes", name: str, lexicon_values: Floats) -> None:
    """Draw cumulative distributions of the lexicon and of people."""
    people = np.array(read_captured_table().values[name])
    for sample, colour, label in ((people, SECOND_COLOUR, PEOPLE_LABEL), (lexicon_values, MAIN_COLOUR, NEUTRAL_STYLE)):
        sorted_values = np.sort(sample)
        axes.step(
            sorted_values,
            np.arange(1, len(sorted_values) + 1) / len(sorted_values),
            color=colour,
            where="post",
            label=label,
        )
    distance = kolmogorov_smirnov(lexicon_values, people)
    label_axes(
        axes,
        f"{MOTION_ROWS[name].words} [{MOTION_ROWS[name].unit}]",
        title=f"distance {distance:.2f} (goal {MAX_DISTANCE})",
    )
    axes.tick_params(labelsize=LABEL_SIZE, length=2)
    axes.grid(alpha=0.3)
    axes.set_ylim(0.0, 1.0)
    axes.set_xlim(0.0, 1.05 * float(np.percentile(np.concatenate([lexicon_values, people]), MAX_PERCENTILE)))
    if name == COMPARED_ROWS[0]:
        axes.set_ylabel("fraction of gestures", fontsize=LABEL_SIZE, color=INK_COLOUR)
        axes.legend(fontsize=LABEL_SIZE, frameon=False)
