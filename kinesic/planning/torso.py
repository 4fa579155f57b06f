"""Sets trunk and head by their hinges, and turns the gesture box along with the torso's own key.

Each hinge of trunk and head is named after the axis it serves. The box of sectors goes along with the torso's own
key (thesis 8.7): its orientation is that of the torso, its size goes with the distance from the first vertebra that
moves to the shoulders' girdle: 1 on a rigid trunk, less on a spine of several hinges that bends. The lean that
reaching adds moves no target.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy

from kinesic.body.arrays import Floats, sealed
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.turns import AXES, UPRIGHT, turn_angles

LEAST_ROOM = 1e-9  # [rad]


def torso_turn(robot: Robot, chain: str, angles: Floats) -> Floats:
    """Adds up torsion, tilt and roll (3,) [rad] of a chain, which may have several hinges for one axis.

    Args:
        robot: the robot.
        chain: `torso` or `neck`.
        angles: (n,) [rad] of all hinges.
    """
    turn, hinges = np.zeros(len(AXES)), _hinges(robot, chain)
    for joint, axis in zip(hinges.joints, hinges.axes, strict=True):
        turn[axis] += angles[joint]
    return turn


def set_turn(robot: Robot, chain: str, turn: Floats, angles: Floats) -> None:
    """Writes the angles of a chain that make a rotation, clipped to their ranges.

    Hinges of one axis share it in proportion to how far they go; an axis without hinge is left out.

    Args:
        robot: the robot.
        chain: `torso` or `neck`.
        turn: (3,) [rad] torsion, tilt and roll.
        angles: (n,) [rad] of all hinges; those of the chain are overwritten.
    """
    hinges = _hinges(robot, chain)
    asked = np.asarray(turn)[hinges.axes]
    positive = asked > 0
    room = np.where(positive, hinges.above, hinges.below)
    share = asked * room / np.where(positive, hinges.all_above, hinges.all_below)
    angles[hinges.joints] = np.minimum(np.maximum(share, hinges.lower), hinges.upper)


@dataclass(frozen=True, eq=False)
class _Hinges:
    """The hinges of a chain that serve an axis, with their ranges to either side, alone and summed over each axis."""

    joints: list[int]  # in joint order
    axes: list[int]  # in `AXES`
    lower: Floats  # (k,) [rad]
    upper: Floats  # (k,) [rad]
    below: Floats  # (k,) [rad] from zero
    above: Floats  # (k,) [rad] from zero
    all_below: Floats  # (k,) [rad]
    all_above: Floats  # (k,) [rad]


@lru_cache(maxsize=16)
def _hinges(robot: Robot, chain: str) -> _Hinges:
    names = robot.skeleton.names
    served = [(j, axis) for j in robot.joints(chain) for axis, name in enumerate(AXES) if names[j].endswith(name)]
    joints, axes = [joint for joint, _ in served], [axis for _, axis in served]
    lower, upper = robot.skeleton.lower[joints], robot.skeleton.upper[joints]
    below, above = np.maximum(-lower, LEAST_ROOM), np.maximum(upper, LEAST_ROOM)
    all_below, all_above = (np.bincount(axes, room, minlength=len(AXES))[axes] for room in (below, above))
    return _Hinges(joints, axes, *map(sealed, (lower, upper, below, above, all_below, all_above)))


@dataclass(frozen=True, eq=False)
class GestureVolume:
    """The box of gesture sectors, relative to that of the upright torso."""

    pivot: Floats  # (3,) [m] in the world: the torso's first joint
    rotation: Floats  # (3, 3)
    scale: float  # length of the torso over its length upright

    def placed(self, reach: Reach) -> Reach:
        """Places a reach that was written for the upright torso in the world."""
        return turn_reach(reach, self.rotation, self.pivot, self.pivot, self.scale)


@lru_cache(maxsize=64)
def volume(robot: Robot, turn: Turn) -> GestureVolume | None:
    """Returns the gesture volume of a torso's key, cached; None for an upright torso or a robot without one."""
    if turn == UPRIGHT or not robot.joints("torso"):
        return None
    angles = np.array(robot.skeleton.rest)
    set_turn(robot, "torso", np.array(turn_angles(turn)), angles)
    names = robot.chains["torso"]
    first, last = robot.skeleton.segment(names[0]), robot.skeleton.segment(names[-1])
    girdle = robot.skeleton.segment(robot.arms["l"].base)
    moved, upright = robot.body_frames(angles), robot.skeleton.resting
    now, before = (float(np.linalg.norm(f.origins[girdle] - f.origins[first])) for f in (moved, upright))
    return GestureVolume(moved.origins[first], moved.rotations[last], now / before)


def turn_reach(reach: Reach, rotation: Floats, pivot: Floats, moved: Floats, scale: float = 1.0) -> Reach:
    """Turns and scales a reach about a pivot, which itself moves."""
    return Reach(
        sealed(moved + scale * (rotation @ (reach.position - pivot))),
        None if reach.pointing is None else sealed(rotation @ reach.pointing),
        None if reach.palm is None else sealed(rotation @ reach.palm),
        reach.swivel,
    )


def aim_from_shoulder(reach: Reach, aim: Floats, side: Side, shoulder: Floats, robot: Robot) -> Reach:
    """Turns a reach so that it points at its aim from where the shoulder has come to.

    Args:
        reach: from where the shoulder rests, in the world.
        aim: (3,) [m] in the world.
        side: of the hand.
        shoulder: (3,) [m] in the world.
        robot: whose hand it is.
    """
    resting = robot.skeleton.resting.origins[robot.arm(side).shoulder]
    turn = scipy.spatial.transform.Rotation.align_vectors((aim - shoulder)[None], (aim - resting)[None])[0]
    return turn_reach(reach, turn.as_matrix(), resting, shoulder)
