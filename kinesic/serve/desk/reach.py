"""Finds the posture for a hand that somebody drags, and what keeps it from going farther."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Distances
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot, Side
from kinesic.ik.arm.refine import refine_posture
from kinesic.ik.solve import REACHED, solve
from kinesic.planning.collision import Spacing, separate

AT_LIMIT = 1e-3  # [rad] from the end of its range, where a hinge is at its limit


@dataclass(frozen=True, eq=False)
class DraggedPosture:
    """A posture that brings a part of the body as near to a place as it can, and what stops it there."""

    angles: Floats  # (n,) [rad]
    residual: float  # [m] from the part to the place
    limits: tuple[str, ...]  # hinges at an end of their range, where the part does not arrive
    contact: tuple[str, str] | None  # segments that would come too near to each other, where that is the reason
    reached: bool  # whether the part arrives


def reach_posture(robot: Robot, distances: Distances, side: Side, target: Floats, start: Floats) -> DraggedPosture:
    """Finds the posture that brings a hand to a place; the torso and the other arm stay as they are.

    Args:
        robot: whose hand.
        distances: between its segments.
        side: of the hand.
        target: (3,) [m] of the wrist's centre, in the world.
        start: (n,) [rad] posture to stay close to.

    Returns:
        The posture; where the hand does not arrive, it is as near as it can be. The body keeps clear of itself:
        elbows swing aside, or the hand stays away.
    """
    chain, posture = robot.arms[side], np.array(robot.skeleton.clamp(start))
    frames, base = robot.skeleton.frames(posture), robot.skeleton.segment(chain.base)
    in_base = sealed(frames.rotations[base].T @ (target - frames.origins[base]))
    joints = list(chain.indices)
    near = posture.copy()
    posture[joints] = solve(chain, Reach(in_base), start=posture[joints]).angles
    posture = np.array(refine_posture(robot, side, Reach(sealed(target)), posture, near=near))
    clearance = distances.clearance(posture[None])
    contact = clearance.pairs[0] if clearance.distances[0] < robot.least_clearance else None
    if contact is not None:
        spacing = Spacing(robot.least_clearance)
        clear = separate(posture, robot.arm(side).joints, robot, distances, spacing)
        posture = near if clear is None else np.array(clear)
    hand = robot.skeleton.frames(posture).origins[robot.arm(side).wrist]
    residual = float(np.linalg.norm(hand - target))
    arrives = residual <= REACHED
    limits = () if arrives or contact is not None else tuple(at_limit(robot, posture, robot.arm(side).joints))
    return DraggedPosture(sealed(posture), residual, limits, None if arrives else contact, reached=arrives)


def at_limit(robot: Robot, posture: Floats, joints: Iterable[int]) -> Iterator[str]:
    """Names those joints that are at an end of their range."""
    skeleton = robot.skeleton
    for joint in joints:
        if min(posture[joint] - skeleton.lower[joint], skeleton.upper[joint] - posture[joint]) < AT_LIMIT:
            yield skeleton.names[joint]
