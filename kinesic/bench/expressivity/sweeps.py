"""Measures what each parameter of expressivity changes in ten gestures, in the twin, and whether strokes keep time.

Drawn: every parameter's own measure in every gesture, and the paths that hands take.
"""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
from matplotlib import colormaps

from kinesic.bench.figure import ALARM, INK, OURS, Figure, picture
from kinesic.controller.arrival import ENTRY_WINDOW
from kinesic.controller.perform import set_up
from kinesic.studies.sweep.measures import SHOWN
from kinesic.studies.sweep.series import LATE, MEASURE_OF, Series, sweep_parameter

# Beat, deictic, emblem, iconic, metaphoric and adaptor; of one hand and of two; near, far, low, high, round and waving.
GESTURES = (
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
SMALL = 7.5  # [pt] of the many small panels
FAINT = "#8a8a8a"
VALUES = colormaps["viridis"]
SHOWN_GESTURES = ("flat_surface", "beat", "ball_round")  # of which paths are drawn
DPI = 100


@cache
def swept() -> tuple[Series, ...]:
    """Sweeps every gesture over every parameter, five values each; measured once in a process."""
    known = set_up()
    return tuple(sweep_parameter(gesture, parameter, known) for parameter in MEASURE_OF for gesture in GESTURES)


def bench() -> list[Figure]:
    """Measures for each parameter how often its measure is monotone, the worst stroke, and its strength."""
    return [
        figure
        for parameter in MEASURE_OF
        for figure in sweep_figures(parameter, [each for each in swept() if each.parameter == parameter])
    ]


def sweep_figures(parameter: str, series: Sequence[Series]) -> list[Figure]:
    """Sums up what a parameter does over some gestures."""
    return [_monotone(parameter, series), _stroke(parameter, series), *strength(parameter, series)]


def _monotone(parameter: str, series: Sequence[Series]) -> Figure:
    share = sum(each.monotone for each in series) / len(series)
    why = ", ".join(each.gesture for each in series if not each.monotone)
    return Figure(f"expressivity.{parameter}_monotone", share, "", 1.0, "higher", f"not: {why}" if why else "")


def _stroke(parameter: str, series: Sequence[Series]) -> Figure:
    """A stroke that never comes counts as far off as the window in which it is looked for."""
    worst = max(series, key=lambda each: ENTRY_WINDOW if each.worst_stroke is None else each.worst_stroke)
    seconds = ENTRY_WINDOW if worst.worst_stroke is None else worst.worst_stroke
    why = "" if worst.in_time else worst.gesture
    return Figure(f"expressivity.{parameter}_stroke", 1000 * seconds, "ms", 1000 * LATE, "lower", why)


def strength(parameter: str, series: Sequence[Series]) -> list[Figure]:
    """Measures by how much the measure changes in the gesture where it changes least."""
    if parameter == "spatial":
        ratios = {each.gesture: _ratio(each, -1.0, 1.0) for each in series}
        return [_least("expressivity.spatial_ratio", ratios, "x", 2.0)]
    if parameter == "openness":
        shifts = {each.gesture: _shift(each) for each in series}
        return [_least("expressivity.openness_shift", shifts, "arm lengths", 0.15)]
    if parameter == "power":
        ratios = {each.gesture: _ratio(each, 0.0, 1.0) for each in series}
        free = {each.gesture: ratios[each.gesture] for each in series if _doubling_allowed(each)}
        note = f"where limits allow it: {len(free)} of {len(series)}"
        return [
            _least("expressivity.power_ratio", free, "x", 2.0, note),
            _least("expressivity.power_ratio_all", ratios, "x", None),
        ]
    return []


def _least(name: str, values: dict[str, float | None], unit: str, goal: float | None, note: str = "") -> Figure:
    known = {gesture: value for gesture, value in values.items() if value is not None}
    if not known:
        return Figure(name, None, unit, goal, "higher", note or "not measurable in any gesture")
    worst = min(known, key=lambda gesture: known[gesture])
    return Figure(name, known[worst], unit, goal, "higher", "; ".join(filter(None, [note, f"least: {worst}"])))


def _at(series: Series, value: float) -> float | None:
    one = next(played for played in series.played if abs(played.value - value) < 1e-9)
    found: float | None = getattr(one.measures, MEASURE_OF[series.parameter].name)
    return found


def _ratio(series: Series, start: float, end: float) -> float | None:
    first, last = _at(series, start), _at(series, end)
    return None if first is None or last is None or first == 0.0 else last / first


def _shift(series: Series) -> float | None:
    first, last = _at(series, 0.0), _at(series, 1.0)
    return None if first is None or last is None else last - first


def _doubling_allowed(series: Series) -> bool:
    """Whether the limits leave the stroke's way at least twice the speed that it has at power 0."""
    plain = next(played.measures for played in series.played if abs(played.value) < 1e-9)
    return plain.allowed_speed >= 2.0 * plain.stroke_speed


def draw(everything: Sequence[Series], path: Path) -> Path:
    """Draws one panel per parameter, one line per gesture; red ones are not monotone. Returns the path of the PNG."""
    with picture(path, 11.0, 5.2, dpi=DPI) as drawn:
        for axes, (parameter, measure) in zip(drawn.subplots(2, 4).flat, MEASURE_OF.items(), strict=True):
            shown = SHOWN[measure.name]
            for series in everything:
                if series.parameter != parameter:
                    continue
                points = [(one.value, getattr(one.measures, measure.name)) for one in series.played]
                known = [(value, shown.scale * found) for value, found in points if found is not None]
                if known:
                    colour = OURS if series.monotone else ALARM
                    axes.plot(*zip(*known, strict=True), color=colour, linewidth=1.0, marker="o", markersize=2)
            axes.set_title(f"{shown.words}{f' [{shown.unit}]' if shown.unit else ''}", fontsize=SMALL + 1, color=INK)
            axes.set_xlabel(parameter, fontsize=SMALL + 1, color=INK)
            axes.tick_params(length=2, width=0.5, labelsize=SMALL, labelcolor=FAINT)
            axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
            axes.grid(alpha=0.3)
    return path


def draw_paths(everything: Sequence[Series], path: Path) -> Path:
    """Draws hands seen from the front, a row per gesture and a column per parameter, dark for low values."""
    gestures = [name for name in SHOWN_GESTURES if any(series.gesture == name for series in everything)]
    with picture(path, 11.0, 1.6 * max(1, len(gestures)) + 0.3, dpi=DPI) as drawn:
        panels = drawn.subplots(max(1, len(gestures)), len(MEASURE_OF), squeeze=False)
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
    return path
