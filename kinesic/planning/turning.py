"""Rotations of trunk and head as angles of their hinges, and back: each hinge is named after the axis it serves."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.expressivity.turns import AXES

LEAST_ROOM = 1e-9  # [rad]


def turn_of(robot: Robot, chain: str, angles: Floats) -> Floats:
    """(3,) [rad] torsion, tilt and roll of a chain; several hinges of one axis add up.

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
    """Writes the angles of a chain that make a rotation, held in their ranges.

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
    """Those of a chain that serve an axis, and how far they go to either side, each alone and all of its axis."""

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
