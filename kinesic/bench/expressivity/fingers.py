"""Benchmark of fingers: each gesture planned alone on upper36.

Hand shapes must be complete in time, and fingers must keep their distance.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.bench.metric import Metric
from kinesic.body.arrays import Floats
from kinesic.expressivity.hands.fingers import finger_joints, shape_angles
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.expressivity.lexicon.hand_shapes import find_shape
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.session.setup import set_up
from kinesic.studies.gestures.isolated import BEHAVIOUR_ID, plan_gesture

METRIC_PREFIX = "expressivity.fingers"  # prefix of the metric names
FINGER_ROBOT = "upper36"  # robot whose fingers are measured
MAX_SHAPE_ERROR = np.radians(4.0)  # [rad] largest finger angle error of a complete hand shape
MIN_COMPLETE = 95.0  # [%] goal for the fraction of hands with complete shapes at strokeStart


@dataclass(frozen=True)
class FingerResult:
    """Hand-shape errors and finger clearance of one planned gesture."""

    gesture: str
    dropped: bool
    shape_errors: tuple[float, ...]  # [rad] largest finger joint error at strokeStart, for each hand with a shape
    clearance: float  # [m] smallest distance of a finger from other segments


def bench() -> list[Metric]:
    """Plan each gesture and measure hand-shape errors and finger clearance."""
    setup = set_up(FINGER_ROBOT)
    return finger_metrics([judge_fingers(form, setup) for form in setup.lexicon.forms])


def finger_metrics(results: Sequence[FingerResult]) -> list[Metric]:
    """Summarize the finger results of gestures as metrics."""
    shape_errors = [error for result in results for error in result.shape_errors]
    complete_percent = (
        100.0 * float(np.mean([error <= MAX_SHAPE_ERROR for error in shape_errors])) if shape_errors else 100.0
    )
    late = ", ".join(
        result.gesture for result in results if any(error > MAX_SHAPE_ERROR for error in result.shape_errors)
    )
    clearance = 1000 * min(result.clearance for result in results)
    dropped = [result.gesture for result in results if result.dropped]
    return [
        Metric(f"{METRIC_PREFIX}.shapes", float(len(shape_errors)), "hands", None, "higher"),
        Metric(f"{METRIC_PREFIX}.complete", complete_percent, "% at strokeStart", MIN_COMPLETE, "higher", late),
        Metric(f"{METRIC_PREFIX}.clearance", clearance, "mm", 10.0, "higher"),
        Metric(f"{METRIC_PREFIX}.dropped", float(len(dropped)), "gestures", 0.0, "lower", ", ".join(dropped)),
    ]


def judge_fingers(form: GestureForm, setup: Setup) -> FingerResult:
    """Plan one gesture and measure its hand-shape errors and finger clearance."""
    planned = plan_gesture(form, setup)
    dropped = planned.keyframes.outcomes[BEHAVIOUR_ID].kind == "dropped"
    return FingerResult(
        form.id, dropped, () if dropped else _measure_shape_errors(form, planned), _measure_clearance(planned)
    )


def _measure_shape_errors(form: GestureForm, planned: Plan) -> tuple[float, ...]:
    """Return each hand's largest deviation [rad] from its finger shape at strokeStart."""
    starts = [sync.planned for sync in planned.syncs if sync.sync == "strokeStart"]
    if not starts or not form.keys:
        return ()
    robot, time = planned.setup.robot, np.array([planned.trajectory.zero + starts[0]])
    angles: Floats = planned.trajectory.sample(time)[0][0]
    return tuple(
        float(np.abs(angles[list(finger_joints(robot, side))] - shape_angles(shape, robot, side)).max())
        for side, pose in form.keys[0].hands.items()
        if (shape := find_shape(pose.shape or "")) is not None
    )


def _measure_clearance(planned: Plan) -> float:
    """Return the fingers' smallest distance [m] from other segments.

    The result is infinite without fingers.

    Only times at which fingers are the closest segments count.
    """
    rows = zip(planned.clearance.distances, planned.clearance.pairs, strict=True)
    return min((float(gap) for gap, pair in rows if any(part.endswith("_fingers") for part in pair)), default=np.inf)
