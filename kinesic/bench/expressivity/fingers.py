"""Hands with fingers: each gesture planned alone on upper36; shapes are there in time, and fingers keep clear."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.bench.figure import Figure
from kinesic.body.arrays import Floats
from kinesic.controller.perform import set_up
from kinesic.expressivity.hands.fingers import finger_joints, shape_angles
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.expressivity.lexicon.hand_shapes import find_shape
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.studies.gestures.isolated import BEHAVIOUR, plan_gesture

PART, ROBOT = "expressivity.fingers", "upper36"
COMPLETE = np.radians(4.0)  # that a drive may still lack, where the shape is there
LEAST_COMPLETE = 95.0  # [%]


@dataclass(frozen=True)
class FingerResult:
    """What fingers do in one gesture."""

    gesture: str
    dropped: bool
    lacks: tuple[float, ...]  # [rad] of each hand that takes a shape, of its worst drive at strokeStart
    clearance: float  # [m] least of fingers, to whatever counts


def bench() -> list[Figure]:
    """Plans each gesture of the lexicon."""
    known = set_up(ROBOT)
    return finger_figures([judge_fingers(form, known) for form in known.lexicon.forms])


def finger_figures(results: Sequence[FingerResult]) -> list[Figure]:
    """Sums up."""
    lacks = [lack for result in results for lack in result.lacks]
    complete = 100.0 * float(np.mean([lack <= COMPLETE for lack in lacks])) if lacks else 100.0
    late = ", ".join(result.gesture for result in results if any(lack > COMPLETE for lack in result.lacks))
    clearance = 1000 * min(result.clearance for result in results)
    dropped = [result.gesture for result in results if result.dropped]
    return [
        Figure(f"{PART}.shapes", float(len(lacks)), "hands", None, "higher"),
        Figure(f"{PART}.complete", complete, "% at strokeStart", LEAST_COMPLETE, "higher", late),
        Figure(f"{PART}.clearance", clearance, "mm", 10.0, "higher"),
        Figure(f"{PART}.dropped", float(len(dropped)), "gestures", 0.0, "lower", ", ".join(dropped)),
    ]


def judge_fingers(form: GestureForm, known: Setup) -> FingerResult:
    """Plans one gesture and looks at its fingers."""
    planned = plan_gesture(form, known)
    dropped = planned.keyframes.outcomes[BEHAVIOUR].kind == "dropped"
    return FingerResult(form.id, dropped, () if dropped else _lacks(form, planned), _clearance(planned))


def _lacks(form: GestureForm, planned: Plan) -> tuple[float, ...]:
    """(k,) [rad] of each hand with a shape in the first key of its stroke."""
    starts = [sync.planned for sync in planned.syncs if sync.sync == "strokeStart"]
    if not starts or not form.keys:
        return ()
    robot, moment = planned.setup.robot, np.array([planned.trajectory.zero + starts[0]])
    angles: Floats = planned.trajectory.sample(moment)[0][0]
    return tuple(
        float(np.abs(angles[list(finger_joints(robot, side))] - shape_angles(shape, robot, side)).max())
        for side, pose in form.keys[0].hands.items()
        if (shape := find_shape(pose.shape or "")) is not None
    )


def _clearance(planned: Plan) -> float:
    """[m] of the moments of the plan in which fingers are what comes nearest; infinite where they never are."""
    rows = zip(planned.clearance.distances, planned.clearance.pairs, strict=True)
    return min((float(gap) for gap, pair in rows if any(part.endswith("_fingers") for part in pair)), default=np.inf)
