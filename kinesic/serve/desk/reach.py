"""Inverse kinematics for dragging a hand."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Distances
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot, Side
from kinesic.ik.arm.refine import refine_posture
from kinesic.ik.solve import REACHED_DISTANCE, solve
from kinesic.planning.collision import Spacing, separate

LIMIT_TOLERANCE = 1e-3  # [rad] distance from the end of a joint range that counts as its limit


@dataclass(frozen=True, eq=False)
class DraggedPosture:
    """Posture with a body part closest to a target, and its obstacles."""

    angles: Floats  # (n,) [rad] joint angles
    residual: float  # [m] distance from the part to the target
    limits: tuple[str, ...]  # hinges at an end of their range, if the target is not reached
    contact: tuple[str, str] | None  # colliding segments, if they prevent reaching the target
    reached: bool  # whether the part reaches the target


def reach_posture(robot: Robot, distances: Distances, side: Side, target: Floats, start: Floats) -> DraggedPosture:
    """Return the posture that brings a hand closest to a target.

    The torso and the other arm stay in place.

    Args:
        robot: robot to pose.
        distances: distances between the bodies of the robot.
        side: side of the hand.
        target: (3,) [m] position of the wrist's centre in the world.
        start: (n,) [rad] posture to stay close to.

    Returns:
        The posture closest to the target. To avoid collisions, the elbow swings aside or the hand stays away.
    """
    chain, posture = robot.arms[side], np.array(robot.skeleton.clamp(start))
    frames, base = robot.skeleton.frames(posture), robot.skeleton.segment(chain.base)
    in_base = sealed(frames.rotations[base].T @ (target - frames.origins[base]))
    joints = list(chain.indices)
    near = posture.copy()
    posture[joints] = solve(chain, Reach(in_base), start=posture[joints]).angles
    posture = np.array(refine_posture(robot, side, Reach(sealed(target)), posture, near=near))
    clearance = distances.clearance(posture[None])
    contact = clearance.pairs[0] if clearance.distances[0] < robot.min_clearance else None
    if contact is not None:
        spacing = Spacing(robot.min_clearance)
        separated = separate(posture, robot.arm(side).joints, robot, distances, spacing)
        posture = near if separated is None else np.array(separated)
    hand = robot.skeleton.frames(posture).origins[robot.arm(side).wrist]
    residual = float(np.linalg.norm(hand - target))
    is_reached = residual <= REACHED_DISTANCE
    limits = () if is_reached or contact is not None else tuple(at_limit(robot, posture, robot.arm(side).joints))
    return DraggedPosture(sealed(posture), residual, limits, None if is_reached else contact, reached=is_reached)


def at_limit(robot: Robot, posture: Floats, joints: Iterable[int]) -> Iterator[str]:
    """Yield the names of joints at an end of their range."""
    skeleton = robot.skeleton
    for joint in joints:
        if min(posture[joint] - skeleton.lower[joint], skeleton.upper[joint] - posture[joint]) < LIMIT_TOLERANCE:
            yield skeleton.names[joint]
