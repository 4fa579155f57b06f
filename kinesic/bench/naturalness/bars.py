"""Metrics of the lexicon's hand motion in the default style, with goals."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from kinesic.bench.metric import Metric
from kinesic.bench.naturalness.captured_table import read_captured_table
from kinesic.bench.naturalness.lexicon import MeasuredGesture
from kinesic.bench.naturalness.measures import GestureMeasures
from kinesic.bench.naturalness.rows import SPEED_UNIT, has_complete_return, values
from kinesic.body.arrays import Flags, Floats

METRIC_PREFIX = "naturalness"  # prefix of the metric names
MEDIAN_GOALS: Mapping[str, float] = {  # goals for the medians of hand-motion measures
    "return_speed": 1.5,  # [arm lengths/s]
    "return_speed_all": 1.5,  # [arm lengths/s]
    "units_per_second": 1.0,  # [1/s] gesture units
    "sparc": -3.0,  # lower bound
}
MAX_RETURN_SPEED = 2.6  # [arm lengths/s] goal for the 95th percentile of the return speed
MIN_FLOW = 0.3  # smallest speed at strokeStart / largest speed before strokeEnd of a flowing gesture
EXPRESSIVE_CATEGORIES = frozenset(("beat", "deictic", "emblem"))  # categories whose fastest phase is the stroke
MIN_VARIETY = 4.0  # goal for the 95th / 5th percentile of gestures' largest speeds
MAX_DISTANCE = 0.25  # goal for the Kolmogorov-Smirnov distance from captured distributions
COMPARED_ROWS = (
    "duration",
    "stroke_time",
    "hold_time",
    "path",
    "largest_speed",
)  # hand-motion measures whose distributions are compared with captured ones


def bar_metrics(gestures: Sequence[MeasuredGesture], arm: float) -> list[Metric]:
    """Return hand-motion metrics: phase speeds, speed variety and limit violations.

    Args:
        gestures: lexicon in one style, with at least one performed gesture.
        arm: arm length of the robot from shoulder to wrist [m].
    """
    hands = [gesture.hand for gesture in gestures if gesture.hand]
    return [*_measure_effort(gestures), *_measure_variety(hands, arm), *_count_violations(gestures)]


def kolmogorov_smirnov(first_sample: Floats, second_sample: Floats) -> float:
    """Return the Kolmogorov-Smirnov distance (0..1) of two samples."""
    points = np.concatenate([first_sample, second_sample])
    first, second = (
        np.searchsorted(np.sort(sample), points, side="right") / len(sample) for sample in (first_sample, second_sample)
    )
    return float(np.abs(first - second).max())


def _measure_effort(gestures: Sequence[MeasuredGesture]) -> list[Metric]:
    """Return speed metrics of gesture phases: preparation, stroke and return."""
    hands = [gesture.hand for gesture in gestures if gesture.hand]
    dynamic = [gesture.hand for gesture in gestures if gesture.hand and gesture.is_dynamic]
    expressive = [
        gesture.hand
        for gesture in gestures
        if gesture.hand and gesture.is_dynamic and gesture.category in EXPRESSIVE_CATEGORIES
    ]
    dynamic_note, expressive_note = (
        f"{len(dynamic)} gestures",
        f"{len(expressive)} gestures: {', '.join(sorted(EXPRESSIVE_CATEGORIES))}",
    )
    strokes = _drop_missing(hand.stroke_to_preparation for hand in dynamic)
    returns = {
        "return_to_preparation": _drop_missing(
            hand.return_to_preparation for hand in hands if has_complete_return(hand)
        ),
        "return_to_preparation_all": _drop_missing(hand.return_to_preparation for hand in hands),
    }
    peaks = np.array([(hand.stroke_speed or 0.0) > (hand.preparation_speed or 0.0) for hand in hands])
    is_flowing, stroke_speeds = values("flow", dynamic) >= MIN_FLOW, values("stroke_speed", dynamic)
    expressive_speeds = values("stroke_speed", expressive)
    return [
        *(
            Metric(
                f"{METRIC_PREFIX}.{name}_p95",
                _percentile(values(name, hands), 95),
                SPEED_UNIT,
                MAX_RETURN_SPEED,
                "lower",
            )
            for name in ("return_speed", "return_speed_all")
        ),
        *(Metric(f"{METRIC_PREFIX}.{name}", _percentile(ratios), "", 1.0, "lower") for name, ratios in returns.items()),
        Metric(f"{METRIC_PREFIX}.stroke_dynamic", _percentile(stroke_speeds), SPEED_UNIT, 1.5, "higher", dynamic_note),
        Metric(
            f"{METRIC_PREFIX}.stroke_expressive",
            _percentile(expressive_speeds),
            SPEED_UNIT,
            1.5,
            "higher",
            expressive_note,
        ),
        Metric(f"{METRIC_PREFIX}.stroke_to_preparation", _percentile(strokes), "", 0.55, "higher", dynamic_note),
        Metric(f"{METRIC_PREFIX}.flow_share", _fraction(is_flowing), "", 0.5, "higher", dynamic_note),
        Metric(f"{METRIC_PREFIX}.peak_in_stroke", _fraction(peaks), "", None, "higher", "captured 0.74"),
    ]


def _measure_variety(hands: Sequence[GestureMeasures], arm: float) -> list[Metric]:
    """Return speed variety and Kolmogorov-Smirnov distances from captured distributions."""
    table, speeds = read_captured_table(), values("largest_speed", hands)
    people = {name: np.array(sample) for name, sample in table.values.items()}
    low, high = np.percentile(speeds, (5, 95)).tolist()
    whole = kolmogorov_smirnov(values("duration", hands), people["whole_duration"])
    metres = kolmogorov_smirnov(arm * speeds, table.arm * people["largest_speed"])
    arms = kolmogorov_smirnov(values("arm_lengths", hands), people["path"] / table.arm)
    return [
        Metric(f"{METRIC_PREFIX}.variety", high / low, "", MIN_VARIETY, "higher", "captured 9.3"),
        *(
            Metric(
                f"{METRIC_PREFIX}.ks_{name}",
                kolmogorov_smirnov(values(name, hands), people[name]),
                "",
                MAX_DISTANCE,
                "lower",
            )
            for name in COMPARED_ROWS
        ),
        Metric(
            f"{METRIC_PREFIX}.ks_duration_whole",
            whole,
            "",
            None,
            "lower",
            "compared with captured gestures with a complete return",
        ),
        Metric(f"{METRIC_PREFIX}.ks_path_arms", arms, "", None, "lower", "in arm lengths"),
        Metric(f"{METRIC_PREFIX}.ks_largest_speed_metres", metres, "", None, "lower", "in m/s"),
    ]


def _count_violations(gestures: Sequence[MeasuredGesture]) -> list[Metric]:
    """Count dropped gestures, shifted strokes and violated limits."""
    late = [gesture.gesture for gesture in gestures if gesture.is_late]
    dropped = [gesture.gesture for gesture in gestures if gesture.hand is None]
    violations = float(sum(gesture.violations for gesture in gestures))
    return [
        Metric(f"{METRIC_PREFIX}.dropped", float(len(dropped)), "gestures", 0.0, "lower", ", ".join(dropped)),
        Metric(f"{METRIC_PREFIX}.stroke_moved", float(len(late)), "strokes", 0.0, "lower", ", ".join(late)),
        Metric(f"{METRIC_PREFIX}.violations", violations, "limits", 0.0, "lower"),
    ]


def _drop_missing(measured: Iterable[float | None]) -> Floats:
    return np.array([value for value in measured if value is not None], dtype=np.float64)


def _percentile(sample: Floats, percent: float = 50) -> float | None:
    return float(np.percentile(sample, percent)) if sample.size else None


def _fraction(flags: Flags) -> float | None:
    return float(flags.mean()) if flags.size else None
