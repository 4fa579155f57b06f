"""Series as pictures: the hands' paths, their speed, and every measure over the parameter."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from kinesic.studies.sweep.measures import SHOWN
from kinesic.studies.sweep.series import MEASURE_OF, Played, Series

SMALL = 7.5  # [pt]
INK, FAINT, OWN = "#333333", "#8a8a8a", "#b3261e"
COLOURS = colormaps["viridis"]
VIEWS = (("from the front", 1), ("from its right", 0))  # title, coordinate that runs across
OTHERS = ("peak_speed", "path_length", "jerk", "overshoot", "torso_travel", "shoulder_travel", "energy", "stroke_error")
DPI = 100


def draw_series(series: Series, path: Path) -> Path:
    """Draws one series as a PNG; returns its path."""
    figure = Figure(figsize=(11.0, 6.2), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(f"{series.gesture}: {series.parameter}", fontsize=11, color=INK)
    axes = figure.subplots(3, 4)
    shades = [COLOURS(0.9 * k / max(1, len(series.played) - 1)) for k in range(len(series.played))]
    for place, (title, across) in zip(axes[0, :2], VIEWS, strict=True):
        _paths(place, series.played, shades, across, title=title)
    _speeds(axes[0, 2], series.played, shades)
    own = MEASURE_OF[series.parameter].name
    _measure(axes[0, 3], series, own, OWN)
    for place, name in zip(axes[1:].flat, OTHERS, strict=True):
        _measure(place, series, name, OWN if name == own else INK)
    figure.savefig(path, dpi=DPI, metadata={"Software": None})
    return path


def _paths(axes: Axes, played: Sequence[Played], shades: Sequence[object], across: int, *, title: str) -> None:
    """Both hands, coloured by value."""
    for one, shade in zip(played, shades, strict=True):
        for hand in one.hands.values():
            axes.plot(hand[:, across], hand[:, 2], color=shade, linewidth=1.0)
    axes.set_aspect("equal", adjustable="datalim")
    _plain(axes, f"hands {title} [m]")


def _speeds(axes: Axes, played: Sequence[Played], shades: Sequence[object]) -> None:
    """Speed of the faster hand about the stroke."""
    for one, shade in zip(played, shades, strict=True):
        speeds = [np.linalg.norm(np.gradient(hand, one.times, axis=0), axis=1) for hand in one.hands.values()]
        axes.plot(one.times, np.max(speeds, axis=0), color=shade, linewidth=1.0, label=f"{one.value:g}")
    axes.axvline(0.0, color=FAINT, linewidth=0.6)
    axes.legend(fontsize=SMALL, frameon=False, handlelength=1.0, loc="upper right")
    _plain(axes, "hand speed [m/s] over time from the stroke [s]")


def _measure(axes: Axes, series: Series, name: str, colour: str) -> None:
    """One measure over the parameter."""
    shown = SHOWN[name]
    found = [(one.value, getattr(one.measures, name)) for one in series.played]
    known = [(value, shown.scale * measured) for value, measured in found if measured is not None]
    if known:
        axes.plot(*zip(*known, strict=True), color=colour, marker="o", markersize=3, linewidth=1.2)
    if name != "stroke_error":
        axes.set_ylim(bottom=0.0)
    _plain(axes, f"{shown.words} [{shown.unit}]" if shown.unit else shown.words)


def _plain(axes: Axes, title: str) -> None:
    axes.set_title(title, fontsize=SMALL + 1, color=INK)
    axes.tick_params(length=2, width=0.5, labelsize=SMALL, labelcolor=FAINT)
    axes.xaxis.set_major_locator(MaxNLocator(5))
    axes.yaxis.set_major_locator(MaxNLocator(4))
    axes.grid(alpha=0.3)
