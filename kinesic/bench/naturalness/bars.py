"""What the lexicon must reach to move as people do, in the default manner."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from kinesic.bench.figure import Figure
from kinesic.bench.naturalness.captured_table import captured_table
from kinesic.bench.naturalness.lexicon import MeasuredGesture
from kinesic.bench.naturalness.measures import GestureMeasures
from kinesic.bench.naturalness.rows import SPEED, values, whole_return
from kinesic.body.arrays import Flags, Floats

PART = "naturalness"
MEDIANS: Mapping[str, float] = {  # goals of rows
    "return_speed": 1.5,
    "return_speed_all": 1.5,
    "units_per_second": 1.0,
    "sparc": -3.0,
}
LARGEST_RETURN = 2.6  # [arm lengths/s]
FLOWING = 0.3  # of the largest speed, with which a hand passes through strokeStart
EXPRESSIVE = frozenset(("beat", "deictic", "emblem"))  # categories in which the stroke is the effort
VARIED = 4.0  # the 95th by the 5th percentile of the largest speed
APART = 0.25  # that a distribution may be from the captured one
COMPARED = ("duration", "stroke_time", "hold_time", "path", "largest_speed")  # with the captured distributions


def bar_figures(gestures: Sequence[MeasuredGesture], arm: float) -> list[Figure]:
    """Measures all bars that are no median of a row.

    Args:
        gestures: the lexicon in one manner, at least one of them performed.
        arm: [m] of the robot, from shoulder to wrist.
    """
    hands = [each.hand for each in gestures if each.hand]
    return [*_effort_figures(gestures), *_variety_figures(hands, arm), *_law_figures(gestures)]


def kolmogorov_smirnov(ours: Floats, theirs: Floats) -> float:
    """Measures how far two samples are apart: the Kolmogorov-Smirnov distance, 0 to 1."""
    places = np.concatenate([ours, theirs])
    mine, others = (np.searchsorted(np.sort(sample), places, side="right") / len(sample) for sample in (ours, theirs))
    return float(np.abs(mine - others).max())


def _effort_figures(gestures: Sequence[MeasuredGesture]) -> list[Figure]:
    """How effort is spread over the phases."""
    hands = [each.hand for each in gestures if each.hand]
    dynamic = [each.hand for each in gestures if each.hand and each.dynamic]
    expressive = [each.hand for each in gestures if each.hand and each.dynamic and each.category in EXPRESSIVE]
    few, fewer = f"{len(dynamic)} gestures", f"{len(expressive)} gestures: {', '.join(sorted(EXPRESSIVE))}"
    strokes = _known(hand.stroke_to_preparation for hand in dynamic)
    returns = {
        "return_to_preparation": _known(hand.return_to_preparation for hand in hands if whole_return(hand)),
        "return_to_preparation_all": _known(hand.return_to_preparation for hand in hands),
    }
    peaks = np.array([(hand.stroke_speed or 0.0) > (hand.preparation_speed or 0.0) for hand in hands])
    flowing, stroking = values("flow", dynamic) >= FLOWING, values("stroke_speed", dynamic)
    told = values("stroke_speed", expressive)
    return [
        *(
            Figure(f"{PART}.{name}_p95", _percentile(values(name, hands), 95), SPEED, LARGEST_RETURN, "lower")
            for name in ("return_speed", "return_speed_all")
        ),
        *(Figure(f"{PART}.{name}", _percentile(found), "", 1.0, "lower") for name, found in returns.items()),
        Figure(f"{PART}.stroke_dynamic", _percentile(stroking), SPEED, 1.5, "higher", few),
        Figure(f"{PART}.stroke_expressive", _percentile(told), SPEED, 1.5, "higher", fewer),
        Figure(f"{PART}.stroke_to_preparation", _percentile(strokes), "", 0.55, "higher", few),
        Figure(f"{PART}.flow_share", _share(flowing), "", 0.5, "higher", few),
        Figure(f"{PART}.peak_in_stroke", _share(peaks), "", None, "higher", "captured 0.74"),
    ]


def _variety_figures(hands: Sequence[GestureMeasures], arm: float) -> list[Figure]:
    """How far gestures differ from one another, and their distributions from the captured ones."""
    table, speeds = captured_table(), values("largest_speed", hands)
    people = {name: np.array(found) for name, found in table.values.items()}
    low, high = np.percentile(speeds, (5, 95)).tolist()
    whole = kolmogorov_smirnov(values("duration", hands), people["whole_duration"])
    metres = kolmogorov_smirnov(arm * speeds, table.arm * people["largest_speed"])
    arms = kolmogorov_smirnov(values("arm_lengths", hands), people["path"] / table.arm)
    return [
        Figure(f"{PART}.variety", high / low, "", VARIED, "higher", "captured 9.3"),
        *(
            Figure(f"{PART}.ks_{name}", kolmogorov_smirnov(values(name, hands), people[name]), "", APART, "lower")
            for name in COMPARED
        ),
        Figure(f"{PART}.ks_duration_whole", whole, "", None, "lower", "from captured gestures whose return is whole"),
        Figure(f"{PART}.ks_path_arms", arms, "", None, "lower", "in arm lengths"),
        Figure(f"{PART}.ks_largest_speed_metres", metres, "", None, "lower", "in m/s"),
    ]


def _law_figures(gestures: Sequence[MeasuredGesture]) -> list[Figure]:
    """What natural motion must not cost."""
    late = [each.gesture for each in gestures if each.late]
    dropped = [each.gesture for each in gestures if each.hand is None]
    beyond = float(sum(each.violations for each in gestures))
    return [
        Figure(f"{PART}.dropped", float(len(dropped)), "gestures", 0.0, "lower", ", ".join(dropped)),
        Figure(f"{PART}.stroke_moved", float(len(late)), "strokes", 0.0, "lower", ", ".join(late)),
        Figure(f"{PART}.violations", beyond, "limits", 0.0, "lower"),
    ]


def _known(found: Iterable[float | None]) -> Floats:
    return np.array([value for value in found if value is not None], dtype=np.float64)


def _percentile(found: Floats, share: float = 50) -> float | None:
    return float(np.percentile(found, share)) if found.size else None


def _share(found: Flags) -> float | None:
    return float(found.mean()) if found.size else None
