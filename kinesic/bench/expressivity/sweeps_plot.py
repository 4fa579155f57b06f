"""The sweeps as pictures: every parameter's own measure in every gesture, and the paths that hands take."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from kinesic.studies.sweep.measures import SHOWN
from kinesic.studies.sweep.series import MEASURE_OF, Series

SMALL = 7.5  # [pt]
INK, FAINT, GOOD, BAD = "#333333", "#8a8a8a", "#2b7a78", "#b3261e"
VALUES = colormaps["viridis"]
SHOWN_GESTURES = ("flat_surface", "beat", "ball_round")  # of which paths are drawn
DPI = 100


def draw(everything: Sequence[Series], path: Path) -> Path:
    """One panel per parameter, one line per gesture; red ones are not monotone. Returns the path of the PNG."""
    figure = Figure(figsize=(11.0, 5.2), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, (parameter, measure) in zip(figure.subplots(2, 4).flat, MEASURE_OF.items(), strict=True):
        shown = SHOWN[measure.name]
        for series in everything:
            if series.parameter != parameter:
                continue
            points = [(one.value, getattr(one.measures, measure.name)) for one in series.played]
            known = [(value, shown.scale * found) for value, found in points if found is not None]
            if known:
                colour = GOOD if series.monotone else BAD
                axes.plot(*zip(*known, strict=True), color=colour, linewidth=1.0, marker="o", markersize=2)
        axes.set_title(f"{shown.words}{f' [{shown.unit}]' if shown.unit else ''}", fontsize=SMALL + 1, color=INK)
        axes.set_xlabel(parameter, fontsize=SMALL + 1, color=INK)
        axes.tick_params(length=2, width=0.5, labelsize=SMALL, labelcolor=FAINT)
        axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=DPI, metadata={"Software": None})
    return path


def draw_paths(everything: Sequence[Series], path: Path) -> Path:
    """Hands seen from the front, a row per gesture and a column per parameter, dark for low values."""
    gestures = [name for name in SHOWN_GESTURES if any(series.gesture == name for series in everything)]
    figure = Figure(figsize=(11.0, 1.6 * max(1, len(gestures)) + 0.3), layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(max(1, len(gestures)), len(MEASURE_OF), squeeze=False)
    for row, gesture in zip(panels, gestures, strict=False):
        for axes, parameter in zip(row, MEASURE_OF, strict=True):
            series = next(each for each in everything if (each.gesture, each.parameter) == (gesture, parameter))
            shades = VALUES(np.linspace(0.0, 0.9, len(series.played)))
            for one, shade in zip(series.played, shades, strict=True):
                for hand in one.hands.values():
                    axes.plot(hand[:, 1], hand[:, 2], color=shade, linewidth=0.8)
            axes.set_aspect("equal", adjustable="datalim")
            axes.set_xticks([])
            axes.set_yticks([])
            if gesture == gestures[0]:
                axes.set_title(parameter, fontsize=SMALL + 1, color=INK)
        row[0].set_ylabel(gesture, fontsize=SMALL + 1, color=INK)
    figure.savefig(path, dpi=DPI, metadata={"Software": None})
    return path
