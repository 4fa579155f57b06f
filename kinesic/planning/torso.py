"""Rotations of trunk, head, shoulder line and gesture volume.

Each hinge of trunk and head is named after its axis. The gesture volume follows the torso's own key (thesis 8.7) in
orientation. Its size is the distance from the first moving vertebra to the shoulder girdle, relative to upright: 1 for
a rigid trunk, less for a bent spine of several hinges. The lean for reaching moves no target.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.reach import Reach
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.body.rotation import shortest_rotation
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.turns import TURN_AXES, UPRIGHT_TURN, turn_angles

COLLAR_STEP = 0.05  # [rad] collar bone rotation for the finite difference of the shoulder line's rise
MIN_RANGE = 1e-9  # [rad] smallest assumed hinge range, which avoids division by zero


def compute_torso_turn(robot: Robot, chain: str, angles: Floats) -> Floats:
    """Sum hinge angles to torsion, tilt and roll (..., 3) [rad].

    Several hinges may have the same axis.

    Args:
        robot: the robot.
        chain: `torso` or `neck`.
        angles: (..., n) [rad] of all hinges.
    """
    turn, hinges = np.zeros((*angles.shape[:-1], len(TURN_AXES))), _hinges(robot, chain)
    for joint, axis in zip(hinges.joints, hinges.axes, strict=True):
        turn[..., axis] += angles[..., joint]
    return turn


def set_turn(robot: Robot, chain: str, turn: Floats, angles: Floats) -> None:
    """Divide a rotation among the hinges of torso or neck.

    Hinges of one axis divide it in proportion to their ranges. An axis without a hinge is left out.

    Args:
        robot: the robot.
        chain: `torso` or `neck`.
        turn: (..., 3) [rad] torsion, tilt and roll.
        angles: (..., n) [rad] of all hinges; those of the chain are overwritten.
    """
    hinges = _hinges(robot, chain)
    requested = np.asarray(turn)[..., hinges.axes]
    positive = requested > 0
    ranges = np.where(positive, hinges.above, hinges.below)
    parts = requested * ranges / np.where(positive, hinges.all_above, hinges.all_below)
    angles[..., hinges.joints] = np.minimum(np.maximum(parts, hinges.lower), hinges.upper)


def raise_shoulder(robot: Robot, rise: float, angles: Floats) -> None:
    """Tilt the shoulder line by rotating the collar bones, in place.

    Args:
        robot: robot; one without hinges that raise the shoulders keeps its posture.
        rise: [rad], + left shoulder up.
        angles: (n,) [rad] of all hinges.
    """
    left, right = (list(robot.arm(side).shoulder_lift_joints) for side in SIDES)
    if left and right:
        tried = np.zeros((2, len(angles)))
        tried[1, left], tried[1, right] = COLLAR_STEP, -COLLAR_STEP
        ends = [robot.skeleton.frames(tried).origins[:, robot.arm(side).shoulder] for side in SIDES]
        line = ends[0] - ends[1]
        elevations = np.arctan2(line[:, 2], line[:, 1])
        lift = rise * COLLAR_STEP / float(elevations[1] - elevations[0])
        angles[left] += lift
        angles[right] -= lift


@dataclass(frozen=True, eq=False)
class _Hinges:
    """Hinges of torso or neck, with their ranges."""

    joints: list[int]  # in joint order
    axes: list[int]  # indices in `TURN_AXES`
    lower: Floats  # (k,) [rad] lower joint limit
    upper: Floats  # (k,) [rad] upper joint limit
    below: Floats  # (k,) [rad] range below zero
    above: Floats  # (k,) [rad] range above zero
    all_below: Floats  # (k,) [rad] range below zero of all hinges of the axis
    all_above: Floats  # (k,) [rad] range above zero of all hinges of the axis


@lru_cache(maxsize=16)
def _hinges(robot: Robot, chain: str) -> _Hinges:
    names = robot.skeleton.names
    served = [(j, axis) for j in robot.joints(chain) for axis, name in enumerate(TURN_AXES) if names[j].endswith(name)]
    joints, axes = [joint for joint, _ in served], [axis for _, axis in served]
    lower, upper = robot.skeleton.lower[joints], robot.skeleton.upper[joints]
    below, above = np.maximum(-lower, MIN_RANGE), np.maximum(upper, MIN_RANGE)
    all_below, all_above = (np.bincount(axes, ranges, minlength=len(TURN_AXES))[axes] for ranges in (below, above))
    return _Hinges(joints, axes, *map(sealed, (lower, upper, below, above, all_below, all_above)))


@dataclass(frozen=True, eq=False)
class GestureVolume:
    """Gesture space of a rotated torso, relative to the upright one."""

    pivot: Floats  # (3,) [m] first joint of the torso in the world
    rotation: Floats  # (3, 3) rotation of the torso from upright
    scale: float  # torso length relative to upright

    def placed(self, reach: Reach) -> Reach:
        """Move a hand target from the upright to the turned gesture volume."""
        return turn_reach(reach, self.rotation, self.pivot, self.pivot, self.scale)


@lru_cache(maxsize=64)
def find_gesture_volume(robot: Robot, turn: Turn) -> GestureVolume | None:
    """Return the gesture volume of a torso rotation, or None.

    None for an upright torso or a robot without torso hinges.
    """
    if turn == UPRIGHT_TURN or not robot.joints("torso"):
        return None
    angles = np.array(robot.skeleton.rest)
    set_turn(robot, "torso", np.array(turn_angles(turn)), angles)
    names = robot.chains["torso"]
    first, last = robot.skeleton.segment(names[0]), robot.skeleton.segment(names[-1])
    girdle = robot.skeleton.segment(robot.arms["l"].base)
    moved, upright = robot.body_frames(angles), robot.skeleton.rest_frames
    now, before = (float(np.linalg.norm(f.origins[girdle] - f.origins[first])) for f in (moved, upright))
    scale = now / before if before > 0.0 else 1.0  # arms may begin at the origin of the torso
    return GestureVolume(moved.origins[first], moved.rotations[last], scale)


def turn_reach(reach: Reach, rotation: Floats, pivot: Floats, moved: Floats, scale: float = 1.0) -> Reach:
    """Rotate, scale and translate a hand target with its pivot.

    Args:
        reach: before.
        rotation: (3, 3).
        pivot: (3,) [m] before.
        moved: (3,) [m] pivot after.
        scale: of distances from the pivot.
    """
    return Reach(
        sealed(moved + scale * (rotation @ (reach.position - pivot))),
        None if reach.pointing is None else sealed(rotation @ reach.pointing),
        None if reach.palm is None else sealed(rotation @ reach.palm),
        reach.swivel,
    )


def aim_from_shoulder(reach: Reach, aim: Floats, side: Side, shoulder: Floats, robot: Robot) -> Reach:
    """Re-aim a pointing hand's reach from the resting to the actual shoulder.

    Args:
        reach: for the resting shoulder, in the world.
        aim: (3,) [m] in the world.
        side: of the hand.
        shoulder: (3,) [m] in the world.
        robot: with the hand.
    """
    resting = robot.skeleton.rest_frames.origins[robot.arm(side).shoulder]
    return turn_reach(reach, shortest_rotation(aim - resting, aim - shoulder), resting, shoulder)
