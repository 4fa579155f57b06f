"""Gaze and head direction: rotations of eyes, head and trunk over time."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from math import atan2, copysign, hypot, radians, sqrt
from typing import Literal

import numpy as np

from kinesic.bml.block import Block, Gaze, HeadDirectionShift
from kinesic.body.action_units import MAX_EYE_DEPRESSION, MAX_EYE_ELEVATION, MAX_EYE_YAW
from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.head import direction
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.lexicon.movement_words import read_head_name
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.turns import (
    UPRIGHT_TURN,
    Hold,
    add_turns,
    clip_turn,
    hold_turn,
    range_excess,
    rotation_range,
    scale_turn,
    turn_angles,
)

AUDIENCE_TARGET = "audience"  # substitute for an unknown gaze target
EYE_RANGE = (Turn(-MAX_EYE_YAW, -MAX_EYE_ELEVATION), Turn(MAX_EYE_YAW, MAX_EYE_DEPRESSION))  # [rad] range of the eyes
TRUNK_DELAY = 0.12  # [s] longest delay of the trunk after the head in a gaze shift
MAX_HEAD_TORSION = radians(45)  # [rad] head torsion above which the trunk performs the rest
OFFSET_UNIT = 50.0  # [deg] gaze angle that an offset of 1 stands for in Greta's documents
UNIT_DIALECTS = ("draft", "none", "fml-apml")  # dialects that write offsets as fractions of `OFFSET_UNIT`

_MIN_GAZE_TIME = 0.2  # [s] shortest duration of a gaze shift
_HEAD_VELOCITY = radians(20)  # [rad/s] peak velocity of the smallest head rotations
_TRUNK_VELOCITY = radians(30)  # [rad/s] peak velocity of the smallest trunk rotations
_PEAK_VELOCITY_RATIO = 1.875  # peak / mean velocity of a minimum-jerk motion

# Smallest fraction of a rotation that the trunk performs, by the body part that the gaze influences.
_TRUNK_FRACTIONS = {"SHOULDER": 0.25, "CHEST": 0.25, "TORSO": 0.25, "WAIST": 0.4, "WHOLE": 0.4}
_OFFSET_DIRECTIONS = {"UP": (0, -1), "DOWN": (0, 1), "LEFT": (1, 0), "RIGHT": (-1, 0)}  # signs of torsion, tilt

Part = Literal["head", "torso"]
GAZE_PARTS: tuple[Part, Part] = ("head", "torso")


@dataclass(frozen=True)
class Aim:
    """Rotations of head, torso and eyes that look at a target."""

    head: Turn  # rotation from upright, including the rotation of the torso
    torso: Turn = UPRIGHT_TURN
    eyes: Turn = UPRIGHT_TURN  # rotation relative to the head at the end of the head's rotation
    substitute: str = ""  # reason for a difference from the request
    missing: str = ""  # message about an unknown target; empty: known
    clipped: str = ""  # message about the rotation cut off by joint limits; empty: none


STRAIGHT_AIM = Aim(UPRIGHT_TURN)


def aim(action: Gaze | HeadDirectionShift, context: BlockContext, base: Aim = STRAIGHT_AIM) -> Aim | None:
    """Return eye, head and trunk rotations towards a gaze target.

    An unknown target is substituted by the audience. The head performs the whole rotation, as far as its range allows,
    and the eyes perform the rest. For a gaze of the eyes alone, the eyes perform as much as they can, and the head the
    rest.

    Args:
        action: the behaviour.
        context: of its block, whose dialect determines the unit of offsets; its robot has a neck.
        base: rotations that are currently held: an offset without a target starts from there, eyes alone leave head and
            trunk there, and neck or head alone the trunk.

    Returns:
        None when neither the target nor an audience is defined.
    """
    robot = context.robot
    influence = action.influence if isinstance(action, Gaze) else None
    offset = _offset(action, context.block) if isinstance(action, Gaze) else UPRIGHT_TURN
    if action.target is None:
        return _divide_turn(add_turns(base.head, offset), influence=influence, robot=robot, base=base)
    place, missing = context.find_target(action.target), ""
    if place is None and isinstance(action, HeadDirectionShift):
        name = read_head_name(action.target)
        if name is not None and name.kind == "direction":
            return _divide_turn(scale_turn(direction(name.words), 0.5), influence=None, robot=robot, base=base)
    if place is None:
        place, missing = context.targets.get(AUDIENCE_TARGET), context.unknown_target(action.target)
    if place is None:
        return None
    turn = add_turns(towards(place, robot), offset)
    return _divide_turn(turn, influence=influence, robot=robot, base=base, missing=missing)


def hold_gaze(look: Aim, times: Mapping[str, float], *, part: Part, stays: bool, pace: Pace) -> Hold:
    """Create the timed head or trunk rotation of a gaze.

    The trunk starts up to `TRUNK_DELAY` after the head. Unless it stays, the part returns from `relax` to `end`.
    """
    natural = look_time(look, pace)
    if part == "head":
        return hold_turn(look.head, times, natural=natural, stays=stays)
    arrive = times.get("ready", times["end"])
    spare_time = arrive - times["start"] - pace.turn_time("torso", look.torso)
    delay = min(max(spare_time, 0.0), TRUNK_DELAY)
    return hold_turn(look.torso, {**times, "start": times["start"] + delay}, natural=natural, stays=stays)


def look_time(look: Aim, pace: Pace, temporal: float = 0.0) -> float:
    """Return the natural duration of a gaze shift [s].

    It is the duration in human motion, or the servos' comfortable duration if that is longer.
    """
    neck = add_turns(look.head, scale_turn(look.torso, -1.0))
    head = pace.turn_time("neck", neck, temporal, usual=_usual_time(neck, _HEAD_VELOCITY))
    trunk = pace.turn_time("torso", look.torso, temporal, usual=_usual_time(look.torso, _TRUNK_VELOCITY))
    return max(_MIN_GAZE_TIME, head, trunk)


def towards(place: Floats, robot: Robot) -> Turn:
    """Return the rotation that turns a forward gaze towards a position.

    Args:
        place: (3,) [m] in the world.
        robot: that looks.
    """
    x, y, z = from_eyes(place, robot)
    return Turn(torsion=atan2(y, x), tilt=atan2(-z, hypot(x, y)))


def from_eyes(place: Floats, robot: Robot) -> Floats:
    """Return the vector from the robot's eyes to a position [m].

    Args:
        place: (3,) [m] in the world.
        robot: standing upright.
    """
    return np.asarray(place - eye_place(robot))


@lru_cache(maxsize=16)
def eye_place(robot: Robot) -> Floats:
    """Return the position of the eyes, (3,) [m] in the world.

    For a robot without a neck it is the point between its shoulders.
    """
    frames, neck = robot.skeleton.rest_frames, robot.chains.get("neck")
    if not neck:
        return np.asarray(np.mean([frames.origins[robot.arm(side).shoulder] for side in SIDES], axis=0))
    k, eyes = robot.skeleton.segment(neck[-1]), robot.sites.get("eyes")
    inside = np.zeros(3) if eyes is None else eyes.position
    return np.asarray(frames.origins[k] + frames.rotations[k] @ inside)


def _usual_time(turn: Turn, velocity: float) -> float:
    """Return the duration of a human gaze shift [s].

    Wide shifts are faster, with Greta's peak velocity of 4/3 a + `velocity` for an angle a.
    """
    angle = max(map(abs, turn_angles(turn)))
    return _PEAK_VELOCITY_RATIO * angle / (4 / 3 * angle + velocity)


def _offset(gaze: Gaze, block: Block) -> Turn:
    """Return the gaze rotation for an offset angle and direction.

    In drafts and in Greta's dialect, an angle up to 1 is a fraction of `OFFSET_UNIT`.
    """
    angle = gaze.offset_angle
    if block.dialect in UNIT_DIALECTS and abs(angle) <= 1:
        angle *= OFFSET_UNIT
    text = (gaze.offset_direction or "").upper()
    sides = np.array([_OFFSET_DIRECTIONS[word] for word in _OFFSET_DIRECTIONS if word in text])
    if not len(sides):
        return UPRIGHT_TURN
    torsion, tilt = sides.sum(axis=0) * radians(angle) / sqrt(len(sides))
    return Turn(torsion=float(torsion), tilt=float(tilt))


def _divide_turn(turn: Turn, *, influence: str | None, robot: Robot, base: Aim, missing: str = "") -> Aim:
    """Divide a rotation among eyes, head and trunk, inside their ranges."""
    influenced, eye_range = (
        (influence or "").upper(),
        EYE_RANGE if "eyes" in robot.sites else (UPRIGHT_TURN, UPRIGHT_TURN),
    )
    eyes_alone = (
        clip_turn(add_turns(turn, scale_turn(base.head, -1.0)), eye_range) if influenced == "EYES" else UPRIGHT_TURN
    )
    head = add_turns(turn, scale_turn(eyes_alone, -1.0))
    fraction = max((smallest for part, smallest in _TRUNK_FRACTIONS.items() if part in influenced), default=0.0)
    torso = base.torso
    if not influenced or fraction:
        trunk = copysign(max(fraction * abs(head.torsion), abs(head.torsion) - MAX_HEAD_TORSION), head.torsion)
        torso = clip_turn(Turn(torsion=trunk), rotation_range(robot, "torso"))
    neck = add_turns(head, scale_turn(torso, -1.0))
    head_turn = add_turns(torso, clip_turn(neck, rotation_range(robot, "neck")))
    eye_turn = add_turns(turn, scale_turn(head_turn, -1.0))
    lost_angle, substitute = range_excess(eye_turn, eye_range), ""
    if missing:
        substitute = f"looks at the {AUDIENCE_TARGET}: {missing}"
    elif influenced == "EYES" and "eyes" not in robot.sites:
        substitute = "the head turns, as the robot has no eyes"
    return Aim(
        head=head_turn,
        torso=torso,
        eyes=clip_turn(eye_turn, eye_range),
        substitute=substitute,
        missing=missing,
        clipped=f"{lost_angle:.0f} deg beyond the neck's range are left out" if lost_angle > 0.5 else "",
    )
