"""Gaze and head direction: where eyes and head look, for a while or for good, and when the trunk turns along."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from math import atan2, copysign, hypot, radians, sqrt
from typing import Literal

import numpy as np

from kinesic.bml.block import Block, Gaze, HeadDirectionShift
from kinesic.body.action_units import ASIDE, DOWNWARD, UPWARD
from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.head import direction
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.lexicon.movement_words import read_head_name
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.turns import (
    UPRIGHT,
    Hold,
    add_turns,
    clip_turn,
    excess,
    hold_turn,
    room,
    scale_turn,
    turn_angles,
)

AUDIENCE = "audience"  # who is looked at when the one that was meant is unknown
EYES = (Turn(-ASIDE, -UPWARD), Turn(ASIDE, DOWNWARD))  # how far they turn in the head
TRUNK_LAG = 0.12  # [s] that the trunk sets out after the head
HEAD_ALONE = radians(45)  # torsion beyond which the trunk turns along
SHARE = 50.0  # [deg] of a whole offset in Greta's documents, which write it as a share of 1
SHARED = ("draft", "none", "fml-apml")  # dialects in which they are

_LEAST_LOOK = 0.2  # [s]
_HEAD_SPEED, _TRUNK_SPEED = radians(20), radians(30)  # [rad/s] peak speeds of the smallest looks
_PEAK = 1.875  # peak over mean speed of minimum jerk

# of a turn the trunk takes at least so much when its part is named
_TRUNK_SHARES = {"SHOULDER": 0.25, "CHEST": 0.25, "TORSO": 0.25, "WAIST": 0.4, "WHOLE": 0.4}
_OFFSETS = {"UP": (0, -1), "DOWN": (0, 1), "LEFT": (1, 0), "RIGHT": (-1, 0)}  # torsion, tilt

Part = Literal["head", "torso"]
PARTS: tuple[Part, Part] = ("head", "torso")


@dataclass(frozen=True)
class Aim:
    """Rotations that look at something."""

    head: Turn  # away from upright, the torso's part included
    torso: Turn = UPRIGHT
    eyes: Turn = UPRIGHT  # in the head: what is left for them once it is there
    substitute: str = ""  # why it is not what was asked
    missing: str = ""  # what is wrong with the target
    clipped: str = ""  # what the ranges took away


STRAIGHT = Aim(UPRIGHT)


def aim(action: Gaze | HeadDirectionShift, context: BlockContext, base: Aim = STRAIGHT) -> Aim | None:
    """Finds the rotations of eyes, head and trunk that look at a target or in a direction.

    An unknown target is substituted by the audience. The head goes all the way, as far as its range allows, and eyes
    the rest; of a gaze that is asked of the eyes alone they do what they can, and the head the rest.

    Args:
        action: the behaviour.
        context: of its block, whose dialect says how offsets are written; its robot has a neck.
        base: what is looked at for good: an offset without a target starts from there, eyes alone leave head and trunk
            as they are there, and neck or head alone the trunk.

    Returns:
        None when neither the target nor an audience is known.
    """
    robot = context.robot
    influence = action.influence if isinstance(action, Gaze) else None
    offset = _offset(action, context.block) if isinstance(action, Gaze) else UPRIGHT
    if action.target is None:
        return _share_turn(add_turns(base.head, offset), influence=influence, robot=robot, base=base)
    place, missing = context.find_target(action.target), ""
    if place is None and isinstance(action, HeadDirectionShift):
        name = read_head_name(action.target)
        if name is not None and name.kind == "direction":
            return _share_turn(scale_turn(direction(name.words), 0.5), influence=None, robot=robot, base=base)
    if place is None:
        place, missing = context.targets.get(AUDIENCE), context.unknown_target(action.target)
    if place is None:
        return None
    turn = add_turns(towards(place, robot), offset)
    return _share_turn(turn, influence=influence, robot=robot, base=base, missing=missing)


def hold_gaze(look: Aim, times: Mapping[str, float], *, part: Part, stays: bool, pace: Pace) -> Hold:
    """Times a part of a look: it goes there and, unless it stays, back; the trunk sets out after the head."""
    natural = look_time(look, pace)
    if part == "head":
        return hold_turn(look.head, times, natural=natural, stays=stays)
    arrive = times.get("ready", times["end"])
    spare = arrive - times["start"] - pace.turn_time("torso", look.torso)
    late = min(max(spare, 0.0), TRUNK_LAG)
    return hold_turn(look.torso, {**times, "start": times["start"] + late}, natural=natural, stays=stays)


def look_time(look: Aim, pace: Pace, temporal: float = 0.0) -> float:
    """Finds the natural time of a look [s]: that of people, or the servos' ease where it is longer."""
    neck = add_turns(look.head, scale_turn(look.torso, -1.0))
    head = pace.turn_time("neck", neck, temporal, usual=_usual_time(neck, _HEAD_SPEED))
    trunk = pace.turn_time("torso", look.torso, temporal, usual=_usual_time(look.torso, _TRUNK_SPEED))
    return max(_LEAST_LOOK, head, trunk)


def towards(place: Floats, robot: Robot) -> Turn:
    """Finds the rotation of a gaze from upright to a place (3,) [m] in the world."""
    x, y, z = from_eyes(place, robot)
    return Turn(torsion=atan2(y, x), tilt=atan2(-z, hypot(x, y)))


def from_eyes(place: Floats, robot: Robot) -> Floats:
    """Finds the way (3,) [m] from the eyes of a robot upright to a place in the world."""
    return np.asarray(place - _eyes(robot))


@lru_cache(maxsize=16)
def _eyes(robot: Robot) -> Floats:
    """(3,) [m] in the world; of a robot without a neck: between its shoulders."""
    frames, neck = robot.skeleton.resting, robot.chains.get("neck")
    if not neck:
        return np.asarray(np.mean([frames.origins[robot.arm(side).shoulder] for side in SIDES], axis=0))
    k, eyes = robot.skeleton.segment(neck[-1]), robot.sites.get("eyes")
    inside = np.zeros(3) if eyes is None else eyes.position
    return np.asarray(frames.origins[k] + frames.rotations[k] @ inside)


def _usual_time(turn: Turn, speed: float) -> float:
    """What people take to look somewhere [s]: wide turns are faster, with Greta's peak speed of 4/3 a + `speed`."""
    angle = max(map(abs, turn_angles(turn)))
    return _PEAK * angle / (4 / 3 * angle + speed)


def _offset(gaze: Gaze, block: Block) -> Turn:
    """Of drafts and of Greta's dialect, an angle up to 1 is a share of `SHARE`."""
    angle = gaze.offset_angle
    if block.dialect in SHARED and abs(angle) <= 1:
        angle *= SHARE
    text = (gaze.offset_direction or "").upper()
    sides = np.array([_OFFSETS[word] for word in _OFFSETS if word in text])
    if not len(sides):
        return UPRIGHT
    torsion, tilt = sides.sum(axis=0) * radians(angle) / sqrt(len(sides))
    return Turn(torsion=float(torsion), tilt=float(tilt))


def _share_turn(turn: Turn, *, influence: str | None, robot: Robot, base: Aim, missing: str = "") -> Aim:
    """Shares a rotation between eyes, head and trunk, inside their ranges."""
    parts, seeing = (influence or "").upper(), EYES if "eyes" in robot.sites else (UPRIGHT, UPRIGHT)
    alone = clip_turn(add_turns(turn, scale_turn(base.head, -1.0)), seeing) if parts == "EYES" else UPRIGHT
    head = add_turns(turn, scale_turn(alone, -1.0))
    share = max((least for part, least in _TRUNK_SHARES.items() if part in parts), default=0.0)
    torso = base.torso
    if not parts or share:
        trunk = copysign(max(share * abs(head.torsion), abs(head.torsion) - HEAD_ALONE), head.torsion)
        torso = clip_turn(Turn(torsion=trunk), room(robot, "torso"))
    neck = add_turns(head, scale_turn(torso, -1.0))
    turned = add_turns(torso, clip_turn(neck, room(robot, "neck")))
    rest = add_turns(turn, scale_turn(turned, -1.0))
    lost, substitute = excess(rest, seeing), ""
    if missing:
        substitute = f"looks at the {AUDIENCE}: {missing}"
    elif parts == "EYES" and "eyes" not in robot.sites:
        substitute = "the head looks, as the robot has no eyes"
    return Aim(
        head=turned,
        torso=torso,
        eyes=clip_turn(rest, seeing),
        substitute=substitute,
        missing=missing,
        clipped=f"{lost:.0f} deg beyond the neck's range are left out" if lost > 0.5 else "",
    )
