"""The rows that are measured of gestures, performed or captured, each as a distribution."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinesic.bench.figure import Figure
from kinesic.bench.naturalness.captured_table import captured_table
from kinesic.bench.naturalness.measures import GestureMeasures
from kinesic.body.arrays import Floats

EFFORT = ("preparation_speed", "stroke_speed", "return_speed_all", "flow")  # rows that tell categories apart
PERCENTILES = (5, 25, 50, 75, 95)
WHOLE = 0.7  # [s] from which on a return is whole: captured ones are often cut
SPEED = "arm lengths/s"


@dataclass(frozen=True)
class Row:
    """One measure of a gesture."""

    words: str
    unit: str
    better: Literal["lower", "higher"]
    of: Callable[[GestureMeasures], float | None]


def whole_return(hand: GestureMeasures) -> bool:
    """Whether a return is long enough to be whole."""
    return hand.return_time is not None and hand.return_time > WHOLE


ROWS: Mapping[str, Row] = {
    "largest_speed": Row("largest speed", SPEED, "lower", lambda hand: hand.largest_speed),
    "preparation_speed": Row("largest speed, preparation", SPEED, "lower", lambda hand: hand.preparation_speed),
    "stroke_speed": Row("largest speed, stroke", SPEED, "higher", lambda hand: hand.stroke_speed),
    "return_speed": Row(
        "largest speed, returns over 0.7 s",
        SPEED,
        "lower",
        lambda hand: hand.return_speed if whole_return(hand) else None,
    ),
    "return_speed_all": Row("largest speed, all returns", SPEED, "lower", lambda hand: hand.return_speed),
    "return_time": Row(
        "duration of returns over 0.7 s", "s", "higher", lambda hand: hand.return_time if whole_return(hand) else None
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
    """(m,) what is known of one row, over some gestures."""
    found = (ROWS[name].of(hand) for hand in hands)
    return np.array([value for value in found if value is not None], dtype=np.float64)


def row_figures(
    part: str, hands: Iterable[GestureMeasures], goals: Mapping[str, float], *, names: Iterable[str] = ROWS
) -> list[Figure]:
    """Gives the median of each row, with its percentiles and those of captured gestures beside it.

    Args:
        part: what the names of the figures begin with.
        hands: of the gestures.
        goals: of medians, by row.
        names: of the rows.
    """
    gestures = list(hands)
    return [_figure(f"{part}.{name}", name, values(name, gestures), goals.get(name)) for name in names]


def _figure(title: str, name: str, found: Floats, goal: float | None) -> Figure:
    row, captured = ROWS[name], captured_table().percentiles.get(name)
    if not found.size:
        return Figure(title, None, row.unit, goal, row.better, "no gesture has it")
    shares = f"{written(np.percentile(found, PERCENTILES).tolist())} (n {found.size})"
    beside = f"; captured {written(captured)}" if captured else ""
    return Figure(title, float(np.median(found)), row.unit, goal, row.better, shares + beside)


def written(percentiles: Iterable[float]) -> str:
    """Writes percentiles in a line."""
    return " ".join(f"{value:.2f}" for value in percentiles)
