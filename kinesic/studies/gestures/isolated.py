"""One gesture played alone, as a document that asks for nothing else."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from xml.sax.saxutils import quoteattr

import numpy as np

from kinesic.bml.block import BmlError, HandMode
from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Side
from kinesic.controller.perform import plan
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.motion.keys import KeyPosture
from kinesic.planning.face_track import faces
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup

STROKE = 2.0  # [s] time enough for every preparation
BEHAVIOUR = "gesture"
_PATH_POINTS = 80
BLINK = "45"
_MODES: dict[HandMode, str] = {"left": "LEFT_HAND", "right": "RIGHT_HAND", "both": "BOTH_HANDS", "unspecified": ""}


@dataclass(frozen=True, eq=False)
class Show:
    """The stroke of a gesture as key postures, and the ways of the palms through it."""

    form: GestureForm
    postures: tuple[Floats, ...]  # (n,) [rad] each, in order
    stroke: int  # which of them falls on the sync point `stroke`
    paths: dict[Side, Floats]  # (m, 3) [m] in the world, of the hands that take part
    faces: tuple[Mapping[str, float], ...]  # action units -> 0..1, one for each posture, with open eyes


def write_document(lexeme: str, mode: HandMode = "unspecified", *, stroke: float = STROKE) -> str:
    """Writes BML that asks for one gesture, its stroke at a time [s]."""
    hands = f" mode={quoteattr(_MODES[mode])}" if _MODES[mode] else ""
    gesture = (
        f"<gesture id={quoteattr(BEHAVIOUR)} lexeme={quoteattr(lexeme)}{hands} stroke={quoteattr(f'{stroke:g}')}/>"
    )
    return f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="alone">{gesture}</bml>'


def plan_gesture(form: GestureForm, setup: Setup, mode: HandMode = "unspecified", *, stroke: float = STROKE) -> Plan:
    """Plans one gesture from rest to rest: itself, also where its hand cannot make its shapes."""
    alone = replace(setup, lexicon=setup.lexicon.as_written)
    return plan(write_document(f"{form.category}={form.id}", mode, stroke=stroke), alone)


def stroke_error(planned: Plan) -> float:
    """Measures how much later than asked a gesture's stroke comes [s]; not a number without one."""
    strokes = [sync.planned - sync.asked for sync in planned.syncs if sync.sync == "stroke"]
    return max(strokes, key=abs, default=float("nan"))


def key_postures(form: GestureForm, planned: Plan, most: int) -> Show:
    """Picks key postures of a gesture that is played alone, at most so many, and the ways of its palms.

    Args:
        form: of the gesture.
        planned: as `plan_gesture` gives it.
        most: at least 2; stroke and, if there is room, first and last are among them.

    Raises:
        BmlError: it could not be planned.
    """
    outcome = planned.keyframes.outcomes[BEHAVIOUR]
    if outcome.kind == "dropped":
        raise BmlError(f"{form.id} cannot be drawn, {planned.setup.robot.name} cannot play it: {outcome.why}")
    times = {sync.sync: sync for sync in planned.syncs if sync.behaviour == BEHAVIOUR}
    first, stroke, last = (times[name] for name in ("strokeStart", "stroke", "strokeEnd"))
    inside = [posture for posture in _of_arms(form, planned) if first.asked <= posture.time <= last.asked]
    middle = int(np.argmin([abs(posture.time - stroke.asked) for posture in inside]))
    chosen = _thinned(len(inside), middle, most)
    spanned = planned.trajectory.zero + np.linspace(first.planned, last.planned, _PATH_POINTS)
    frames = planned.setup.robot.skeleton.frames(planned.trajectory.sample(spanned)[0])
    paths = {side: _palm(planned, side, frames.rotations, frames.origins) for side in SIDES if side in form.sides}
    keys = [inside[k] for k in chosen]
    moments = planned.trajectory.zero + np.array([key.time for key in keys])
    between = planned.trajectory.sample(moments)[0]
    postures = tuple(sealed(np.where(key.keyed, key.angles, row)) for key, row in zip(keys, between, strict=True))
    return Show(form, postures, chosen.index(middle), paths, tuple(map(_awake, faces(planned, moments))))


def _of_arms(form: GestureForm, planned: Plan) -> list[KeyPosture]:
    """Postures that say where an arm of the gesture is; others are of fingers, head or trunk alone."""
    robot = planned.setup.robot
    arms = [joint for side in form.sides for joint in robot.skeleton.joints_of(robot.arm(side).segments)]
    return [posture for posture in planned.postures.postures if any(posture.keyed[joint] for joint in arms)]


def _awake(units: Mapping[str, float]) -> dict[str, float]:
    """A face without a blink, which falls anywhere."""
    return {unit: value for unit, value in units.items() if unit.lstrip("LR") != BLINK}


def _thinned(count: int, middle: int, most: int) -> list[int]:
    """Indices, evenly spread, with the first, the middle one and the last."""
    if count <= most:
        return list(range(count))
    spread = np.round(np.linspace(0, count - 1, most)).astype(int)
    inner = 1 + int(np.argmin(np.abs(spread[1:-1] - middle))) if most > 2 else most - 1
    if middle not in (0, count - 1):
        spread[inner] = middle
    return sorted({int(k) for k in spread} | {middle})


def _palm(planned: Plan, side: Side, rotations: Floats, origins: Floats) -> Floats:
    """(m, 3) [m] of one palm."""
    robot = planned.setup.robot
    palm = robot.arm(side).palm
    k = robot.skeleton.segment(palm.segment)
    return sealed(origins[:, k] + rotations[:, k] @ palm.position)
