"""Benchmark of expressivity parameters: size and monotonicity of their effects.

It measures effect on ten gestures in the twin and timing.

The plots show every parameter's measure in every gesture, and paths of the hands.
"""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
from matplotlib import colormaps

from kinesic.bench.metric import CONTRAST_COLOUR, INK_COLOUR, MAIN_COLOUR, Metric, picture
from kinesic.metrics.arrival import ENTRY_WINDOW
from kinesic.session.setup import set_up
from kinesic.studies.sweep.measures import MEASURE_FORMATS
from kinesic.studies.sweep.series import MAX_STROKE_ERROR, MEASURE_OF, Series, sweep_parameter

# Beats, deictic gestures, emblems, iconic and metaphoric gestures and adaptors; with one and two hands; near, far, low,
# high, round and waving.
SWEPT_GESTURES = (
    "beat",
    "here_down",
    "you",
    "greet_wave",
    "stop",
    "ball_round",
    "flat_surface",
    "conduit",
    "process_roll",
    "heart",
)
LABEL_SIZE = 7.5  # [pt] font size of labels in small panels
FAINT_COLOUR = "#8a8a8a"  # colour of tick labels
VALUE_COLOURS = colormaps["viridis"]  # colours of hand paths by parameter value
SHOWN_GESTURES = ("flat_surface", "beat", "ball_round")  # gestures with drawn paths
PLOT_DPI = 100  # [pixels/inch] resolution of the saved plots


@cache
def sweep_all() -> tuple[Series, ...]:
    """Measure each swept gesture at five values of every parameter.

    The result is cached.
    """
    setup = set_up()
    return tuple(sweep_parameter(gesture, parameter, setup) for parameter in MEASURE_OF for gesture in SWEPT_GESTURES)


def bench() -> list[Metric]:
    """Measure monotonicity, worst stroke timing error and effect of each parameter."""
    return [
        metric
        for parameter in MEASURE_OF
        for metric in sweep_metrics(parameter, [series for series in sweep_all() if series.parameter == parameter])
    ]


def sweep_metrics(parameter: str, series: Sequence[Series]) -> list[Metric]:
    """Return the metrics of one expressivity parameter over the swept gestures."""
    return [_monotone(parameter, series), _stroke_metric(parameter, series), *effect_metrics(parameter, series)]


def _monotone(parameter: str, series: Sequence[Series]) -> Metric:
    fraction = sum(one.monotone for one in series) / len(series)
    why = ", ".join(one.gesture for one in series if not one.monotone)
    return Metric(f"expressivity.{parameter}_monotone", fraction, "", 1.0, "higher", f"not: {why}" if why else "")


def _stroke_metric(parameter: str, series: Sequence[Series]) -> Metric:
    """Return the metric of the worst stroke error in a sweep.

    A stroke that never arrives counts as the length of the search window.
    """
    worst = max(series, key=lambda one: ENTRY_WINDOW if one.worst_stroke is None else one.worst_stroke)
    seconds = ENTRY_WINDOW if worst.worst_stroke is None else worst.worst_stroke
    why = "" if worst.in_time else worst.gesture
    return Metric(f"expressivity.{parameter}_stroke", 1000 * seconds, "ms", 1000 * MAX_STROKE_ERROR, "lower", why)


def effect_metrics(parameter: str, series: Sequence[Series]) -> list[Metric]:
    """Return metrics of a parameter's smallest effect over the gestures.

    Only `spatial`, `openness` and `power` have such metrics.
    """
    if parameter == "spatial":
        ratios = {one.gesture: _ratio(one, -1.0, 1.0) for one in series}
        return [_smallest("expressivity.spatial_ratio", ratios, "x", 2.0)]
    if parameter == "openness":
        shifts = {one.gesture: _shift(one) for one in series}
        return [_smallest("expressivity.openness_shift", shifts, "arm lengths", 0.15)]
    if parameter == "power":
        ratios = {one.gesture: _ratio(one, 0.0, 1.0) for one in series}
        free = {one.gesture: ratios[one.gesture] for one in series if _may_double_speed(one)}
        note = f"gestures whose limits allow it: {len(free)} of {len(series)}"
        return [
            _smallest("expressivity.power_ratio", free, "x", 2.0, note),
            _smallest("expressivity.power_ratio_all", ratios, "x", None),
        ]
    return []


def _smallest(name: str, values: dict[str, float | None], unit: str, goal: float | None, note: str = "") -> Metric:
    measured = {gesture: value for gesture, value in values.items() if value is not None}
    if not measured:
        return Metric(name, None, unit, goal, "higher", note or "not measurable in any gesture")
    worst = min(measured, key=lambda gesture: measured[gesture])
    return Metric(name, measured[worst], unit, goal, "higher", "; ".join(filter(None, [note, f"smallest: {worst}"])))


def _measure_at(series: Series, value: float) -> float | None:
    one = next(played for played in series.played if abs(played.value - value) < 1e-9)
    value_there: float | None = getattr(one.measures, MEASURE_OF[series.parameter].name)
    return value_there


def _ratio(series: Series, start: float, end: float) -> float | None:
    first, last = _measure_at(series, start), _measure_at(series, end)
    return None if first is None or last is None or first == 0.0 else last / first


def _shift(series: Series) -> float | None:
    first, last = _measure_at(series, 0.0), _measure_at(series, 1.0)
    return None if first is None or last is None else last - first


def _may_double_speed(series: Series) -> bool:
    """Return whether limits allow twice the stroke speed of neutral power.

    Power is neutral at value 0.
    """
    plain = next(played.measures for played in series.played if abs(played.value) < 1e-9)
    return plain.allowed_speed >= 2.0 * plain.stroke_speed


def draw(all_series: Sequence[Series], path: Path) -> Path:
    """Plot the parameter sweeps as PNG and return the file's path.

    Curves that are not monotone are red.
    """
    with picture(path, 11.0, 5.2, dpi=PLOT_DPI) as drawn:
        for axes, (parameter, measure) in zip(drawn.subplots(2, 4).flat, MEASURE_OF.items(), strict=True):
            quantity = MEASURE_FORMATS[measure.name]
            for series in all_series:
                if series.parameter != parameter:
                    continue
                points = [(one.value, getattr(one.measures, measure.name)) for one in series.played]
                curve = [(value, quantity.scale * result) for value, result in points if result is not None]
                if curve:
                    colour = MAIN_COLOUR if series.monotone else CONTRAST_COLOUR
                    axes.plot(*zip(*curve, strict=True), color=colour, linewidth=1.0, marker="o", markersize=2)
            axes.set_title(
                f"{quantity.words}{f' [{quantity.unit}]' if quantity.unit else ''}",
                fontsize=LABEL_SIZE + 1,
                color=INK_COLOUR,
            )
            axes.set_xlabel(parameter, fontsize=LABEL_SIZE + 1, color=INK_COLOUR)
            axes.tick_params(length=2, width=0.5, labelsize=LABEL_SIZE, labelcolor=FAINT_COLOUR)
            axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
            axes.grid(alpha=0.3)
    return path


def draw_paths(all_series: Sequence[Series], path: Path) -> Path:
    """Draw hand paths from the front, by gesture and parameter.

    Low values are dark.
    """
    gestures = [name for name in SHOWN_GESTURES if any(series.gesture == name for series in all_series)]
    with picture(path, 11.0, 1.6 * max(1, len(gestures)) + 0.3, dpi=PLOT_DPI) as drawn:
        panels = drawn.subplots(max(1, len(gestures)), len(MEASURE_OF), squeeze=False)
        for row, gesture in zip(panels, gestures, strict=False):
            for axes, parameter in zip(row, MEASURE_OF, strict=True):
                series = next(one for one in all_series if (one.gesture, one.parameter) == (gesture, parameter))
                shades = VALUE_COLOURS(np.linspace(0.0, 0.9, len(series.played)))
                for one, shade in zip(series.played, shades, strict=True):
                    for hand in one.hands.values():
                        axes.plot(hand[:, 1], hand[:, 2], color=shade, linewidth=0.8)
                axes.set_aspect("equal", adjustable="datalim")
                axes.set_xticks([])
                axes.set_yticks([])
                if gesture == gestures[0]:
                    axes.set_title(parameter, fontsize=LABEL_SIZE + 1, color=INK_COLOUR)
            row[0].set_ylabel(gesture, fontsize=LABEL_SIZE + 1, color=INK_COLOUR)
    return path
