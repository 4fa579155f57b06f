"""Planning of a single gesture, in a document without other behaviours."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from xml.sax.saxutils import quoteattr

import numpy as np

from kinesic.bml.block import BmlError, HandMode
from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Side
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.motion.keys import KeyPosture
from kinesic.planning.face_track import compute_faces
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.session.plan import plan

STROKE_TIME = 2.0  # [s] requested stroke time of a single gesture, late enough for every preparation
BEHAVIOUR_ID = "gesture"  # id of the only behaviour in a gesture's document
_PATH_POINTS = 80  # number of samples of a hand path
BLINK_UNIT = "45"  # action unit of the blink
_BML_MODES: dict[HandMode, str] = {"left": "LEFT_HAND", "right": "RIGHT_HAND", "both": "BOTH_HANDS", "unspecified": ""}


@dataclass(frozen=True, eq=False)
class Show:
    """Key postures and palm paths of a gesture's stroke, for pictures."""

    form: GestureForm
    postures: tuple[Floats, ...]  # joint angles (n,) [rad] in order of time
    stroke: int  # index of the posture at the sync point `stroke`
    paths: dict[Side, Floats]  # (m, 3) [m] in the world, for the hands that take part
    faces: tuple[Mapping[str, float], ...]  # action units -> 0..1 for each posture, with open eyes


def write_isolated_gesture(lexeme: str, mode: HandMode = "unspecified", *, stroke: float = STROKE_TIME) -> str:
    """Return BML with one gesture and its stroke time [s]."""
    hands = f" mode={quoteattr(_BML_MODES[mode])}" if _BML_MODES[mode] else ""
    gesture = (
        f"<gesture id={quoteattr(BEHAVIOUR_ID)} lexeme={quoteattr(lexeme)}{hands} stroke={quoteattr(f'{stroke:g}')}/>"
    )
    return f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="alone">{gesture}</bml>'


def plan_gesture(
    form: GestureForm, setup: Setup, mode: HandMode = "unspecified", *, stroke: float = STROKE_TIME
) -> Plan:
    """Plan one gesture alone, from rest to rest.

    It is never substituted, even if the hand cannot make its shapes.
    """
    alone = replace(setup, lexicon=setup.lexicon.as_written)
    return plan(write_isolated_gesture(f"{form.category}={form.id}", mode, stroke=stroke), alone)


def stroke_error(planned: Plan) -> float:
    """Return a stroke's planned minus its requested time [s].

    Of several strokes the one farthest from its time counts; without a stroke the result is NaN.
    """
    strokes = [sync.planned - sync.requested for sync in planned.syncs if sync.sync == "stroke"]
    return max(strokes, key=abs, default=float("nan"))


def key_postures(form: GestureForm, planned: Plan, max_count: int) -> Show:
    """Return key postures and palm paths of an isolated gesture.

    Args:
        form: form of the gesture.
        planned: plan from `plan_gesture`.
        max_count: at least 2; the stroke and, if possible, the first and last posture are included.

    Raises:
        BmlError: the gesture could not be planned.
    """
    outcome = planned.keyframes.outcomes[BEHAVIOUR_ID]
    if outcome.kind == "dropped":
        raise BmlError(f"{form.id} cannot be drawn, as {planned.setup.robot.name} cannot perform it: {outcome.why}")
    times = {sync.sync: sync for sync in planned.syncs if sync.behaviour == BEHAVIOUR_ID}
    first, stroke, last = (times[name] for name in ("strokeStart", "stroke", "strokeEnd"))
    stroke_keys = [
        posture for posture in _make_arm_postures(form, planned) if first.requested <= posture.time <= last.requested
    ]
    middle = int(np.argmin([abs(posture.time - stroke.requested) for posture in stroke_keys]))
    chosen = _choose_spread_indices(len(stroke_keys), middle, max_count)
    path_times = planned.trajectory.zero + np.linspace(first.planned, last.planned, _PATH_POINTS)
    frames = planned.setup.robot.skeleton.frames(planned.trajectory.sample(path_times)[0])
    paths = {side: _trace_palm(planned, side, frames.rotations, frames.origins) for side in SIDES if side in form.sides}
    keys = [stroke_keys[k] for k in chosen]
    key_times = planned.trajectory.zero + np.array([key.time for key in keys])
    sampled = planned.trajectory.sample(key_times)[0]
    postures = tuple(sealed(np.where(key.keyed, key.angles, row)) for key, row in zip(keys, sampled, strict=True))
    return Show(
        form, postures, chosen.index(middle), paths, tuple(map(_without_blink, compute_faces(planned, key_times)))
    )


def _make_arm_postures(form: GestureForm, planned: Plan) -> list[KeyPosture]:
    """Select the key postures in which the gesture places an arm.

    Other postures set only fingers, head or trunk.
    """
    robot = planned.setup.robot
    arms = [joint for side in form.sides for joint in robot.skeleton.joints_of(robot.arm(side).segments)]
    return [posture for posture in planned.postures.postures if any(posture.keyed[joint] for joint in arms)]


def _without_blink(units: Mapping[str, float]) -> dict[str, float]:
    """Return action units without the blink, which occurs at random times."""
    return {unit: value for unit, value in units.items() if unit.lstrip("LR") != BLINK_UNIT}


def _choose_spread_indices(count: int, middle: int, max_count: int) -> list[int]:
    """Return evenly spread indices that include first, middle and last."""
    if count <= max_count:
        return list(range(count))
    indices = np.round(np.linspace(0, count - 1, max_count)).astype(int)
    inner = 1 + int(np.argmin(np.abs(indices[1:-1] - middle))) if max_count > 2 else max_count - 1
    if middle not in (0, count - 1):
        indices[inner] = middle
    return sorted({int(k) for k in indices} | {middle})


def _trace_palm(planned: Plan, side: Side, rotations: Floats, origins: Floats) -> Floats:
    """Return the path of one palm (m, 3) [m]."""
    robot = planned.setup.robot
    palm = robot.arm(side).palm
    k = robot.skeleton.segment(palm.segment)
    return sealed(origins[:, k] + rotations[:, k] @ palm.position)
