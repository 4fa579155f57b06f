"""Measures of hand motion that are compared as distributions."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinesic.bench.metric import Metric
from kinesic.bench.naturalness.captured_table import read_captured_table
from kinesic.bench.naturalness.measures import GestureMeasures
from kinesic.body.arrays import Floats

# Measures that distinguish gesture categories.
EFFORT_ROWS = ("preparation_speed", "stroke_speed", "return_speed_all", "flow")
ROW_PERCENTILES = (5, 25, 50, 75, 95)  # [%] percentiles in the notes of a metric
MIN_COMPLETE_RETURN = 0.7  # [s] shortest complete return; shorter returns may be cut in captured clips
SPEED_UNIT = "arm lengths/s"


@dataclass(frozen=True)
class Row:
    """Measure of hand motion with its label, unit and preferred direction."""

    words: str  # label in plots and tables
    unit: str
    better: Literal["lower", "higher"]
    value_of: Callable[[GestureMeasures], float | None]


def has_complete_return(hand: GestureMeasures) -> bool:
    """Return whether the hand's return lasts longer than `MIN_COMPLETE_RETURN`."""
    return hand.return_time is not None and hand.return_time > MIN_COMPLETE_RETURN


MOTION_ROWS: Mapping[str, Row] = {
    "largest_speed": Row("largest speed", SPEED_UNIT, "lower", lambda hand: hand.largest_speed),
    "preparation_speed": Row("largest speed, preparation", SPEED_UNIT, "lower", lambda hand: hand.preparation_speed),
    "stroke_speed": Row("largest speed, stroke", SPEED_UNIT, "higher", lambda hand: hand.stroke_speed),
    "return_speed": Row(
        "largest speed, returns over 0.7 s",
        SPEED_UNIT,
        "lower",
        lambda hand: hand.return_speed if has_complete_return(hand) else None,
    ),
    "return_speed_all": Row("largest speed, all returns", SPEED_UNIT, "lower", lambda hand: hand.return_speed),
    "return_time": Row(
        "duration of returns over 0.7 s",
        "s",
        "higher",
        lambda hand: hand.return_time if has_complete_return(hand) else None,
    ),
    "flow": Row("flow at strokeStart", "", "higher", lambda hand: hand.flow),
    "units": Row("movement units", "", "lower", lambda hand: float(hand.units)),
    "units_per_second": Row("movement units per second", "1/s", "lower", lambda hand: hand.units_per_second),
    "sparc": Row("spectral arc length", "", "higher", lambda hand: hand.sparc),
    "preparation_sparc": Row("spectral arc length, preparation", "", "higher", lambda hand: hand.preparation_sparc),
    "duration": Row("duration", "s", "higher", lambda hand: hand.duration),
    "stroke_time": Row("duration, stroke", "s", "higher", lambda hand: hand.stroke_time),
    "hold_time": Row("duration, hold", "s", "lower", lambda hand: hand.hold_time),
    "path": Row("path of the wrist", "m", "higher", lambda hand: hand.path),
    "arm_lengths": Row("path of the wrist", "arm lengths", "higher", lambda hand: hand.arm_lengths),
    "lead": Row("lead of the largest speed", "s", "lower", lambda hand: hand.lead),
}


def values(name: str, hands: Iterable[GestureMeasures]) -> Floats:
    """Return the available values (m,) of one hand-motion measure."""
    row_values = (MOTION_ROWS[name].value_of(hand) for hand in hands)
    return np.array([value for value in row_values if value is not None], dtype=np.float64)


def row_metrics(
    part: str, hands: Iterable[GestureMeasures], goals: Mapping[str, float], *, names: Iterable[str] = MOTION_ROWS
) -> list[Metric]:
    """Return the median of each hand-motion measure with percentiles as notes.

    Args:
        part: prefix of the metric names.
        hands: measured hands of the gestures.
        goals: goals of the medians, by row.
        names: names of the rows.
    """
    gestures = list(hands)
    return [_metric(f"{part}.{name}", name, values(name, gestures), goals.get(name)) for name in names]


def _metric(title: str, name: str, sample: Floats, goal: float | None) -> Metric:
    row, captured = MOTION_ROWS[name], read_captured_table().percentiles.get(name)
    if not sample.size:
        return Metric(title, None, row.unit, goal, row.better, "no gesture has it")
    note = f"{format_percentiles(np.percentile(sample, ROW_PERCENTILES).tolist())} (n {sample.size})"
    captured_note = f"; captured {format_percentiles(captured)}" if captured else ""
    return Metric(title, float(np.median(sample)), row.unit, goal, row.better, note + captured_note)


def format_percentiles(percentiles: Iterable[float]) -> str:
    """Format percentiles as one line of text."""
    return " ".join(f"{value:.2f}" for value in percentiles)
