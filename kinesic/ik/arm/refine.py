"""Correction of an arm solution for the robot's true hinge axes.

The hinges of a foreign robot need not meet in one point, and its twists need not lie along the bones. The ideal
arm's angles are the start; Levenberg-Marquardt on the true axes brings the hand to its place, first with the
directions it should have, then without.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot, Side
from kinesic.body.rotation import rotation_about
from kinesic.body.skeleton import Frames
from kinesic.ik.box_lm import Box, ErrorFunction, descend

DIRECTION_WEIGHT = 0.05  # weight of a direction error [rad] relative to a position error in arm lengths
ELBOW_WEIGHT = 0.02  # weight of the elbow's position error relative to the hand's, if a swivel is requested
ARRIVAL_TOLERANCE = 1e-5  # [arm lengths] norm of the weighted errors at which the solver stops
RETRY_DISTANCE = 2e-3  # [arm lengths] hand error that adds `MISS_PENALTY` and calls for other start postures
TRAVEL_WEIGHT = 0.03  # [1/rad] cost of joint travel, added to the norm of the weighted errors
MISS_PENALTY = 1e3  # smallest cost added if the hand error exceeds `RETRY_DISTANCE`


@dataclass(frozen=True, eq=False)
class TrueArm:
    """True hinge axes of an arm, as lines in its base frame."""

    joints: tuple[int, ...]  # in the skeleton's order
    anchors: Floats  # (k, 3) [m]
    axes: Floats  # (k, 3) unit
    elbow: int  # number of hinges that may move the elbow, its own included
    places: Floats  # (2, 3) [m] elbow and hand
    directions: Floats  # (2, 3) unit, in the last segment: along the hand, and out of the palm
    exact: bool  # whether the ideal arm has the same hinges

    def posture(self, angles: Floats) -> tuple[Floats, Floats, Floats]:
        """Compute elbow and hand positions and hand directions with their Jacobians.

        Elbow and hand have shape (2, 3) [m], the directions (2, 3), and the Jacobians of all four (4, 3, k).
        """
        rotation, shift = np.eye(3), np.zeros(3)
        poles, axes = np.empty_like(self.anchors), np.empty_like(self.axes)
        elbow = self.places[0]
        for k, (anchor, axis, angle) in enumerate(zip(self.anchors, self.axes, angles, strict=True)):
            poles[k], axes[k] = rotation @ anchor + shift, rotation @ axis
            turn = rotation_about(axis, angle)
            shift = shift + rotation @ (anchor - turn @ anchor)
            rotation = rotation @ turn
            if k + 1 == self.elbow:
                elbow = rotation @ self.places[0] + shift
        points = np.array([elbow, rotation @ self.places[1] + shift])
        directions = self.directions @ rotation.T
        moves = np.concatenate(
            [np.cross(axes, points[:, None] - poles), np.cross(axes[None], directions[:, None])]
        ).transpose(0, 2, 1)
        moves[0, :, self.elbow :] = 0.0
        return points, directions, moves


@lru_cache(maxsize=8)
def true_arm(robot: Robot, side: Side) -> TrueArm:
    """Return the true hinge axes of an arm in the zero posture."""
    skeleton, chain, arm = robot.skeleton, robot.arms[side], robot.arm(side)
    origins = skeleton.zero_frames.origins
    base = origins[skeleton.segment(chain.base)]
    hinges = [skeleton.hinges[k] for k in arm.joints]
    places = np.array([origins[arm.elbow] - base, origins[arm.wrist] - base])
    solved = [hinge for joint in chain.joints for hinge in joint.hinges]
    return TrueArm(
        joints=arm.joints,
        anchors=sealed([origins[skeleton.segment(h.segment)] + h.at - base for h in hinges]),
        axes=sealed([h.axis for h in hinges]),
        elbow=sum(h.segment != arm.segments[-1] for h in hinges),
        places=sealed(places),
        directions=sealed([arm.palm.position / np.linalg.norm(arm.palm.position), arm.palm.facing]),
        exact=len(solved) == len(hinges)
        and all(a is b and not a.at.any() for a, b in zip(solved, hinges, strict=True)),
    )


def refine_posture(robot: Robot, side: Side, reach: Reach, angles: Floats, *, near: Floats) -> Floats:
    """Correct a solved posture to bring the true arm's hand on target.

    Args:
        robot: robot of the arm.
        side: side of the arm.
        reach: target of its hand, in the world.
        angles: (n,) [rad] of the whole robot; those of this arm solved for the ideal one.
        near: (n,) [rad] posture to stay close to.

    Returns:
        (n,) [rad] inside the ranges; the same array where the ideal arm is the true one. Of the postures found from
        the ideal arm's and from `near`, the one that serves the directions with less travel.
    """
    arm = true_arm(robot, side)
    if arm.exact:
        return angles
    desired = _in_base(reach, robot.body_frames(angles), robot.skeleton.segment(robot.arms[side].base))
    joints = list(arm.joints)
    lower, upper, rest = (getattr(robot.skeleton, name)[joints] for name in ("lower", "upper", "rest"))
    guess = np.clip(angles[joints], lower, upper)
    elbow = arm.posture(guess)[0][0] if reach.swivel is not None else None
    present = np.clip(near[joints], lower, upper)
    size = robot.arm_length
    led, there = _errors(arm, desired, elbow, size), _errors(arm, Reach(desired.position), None, size)
    best, least = guess, np.inf
    for k, start in enumerate((guess, present, rest, (lower + upper) / 2)):
        if k > 1 and least < MISS_PENALTY:
            break
        box = Box(lower, upper, sealed(start), np.ones(len(joints)))
        turned = descend(led, start, box, tolerance=ARRIVAL_TOLERANCE).angles
        descent = descend(there, turned, replace(box, home=turned), tolerance=ARRIVAL_TOLERANCE)
        price = float(np.linalg.norm(led(descent.angles)[0])) + TRAVEL_WEIGHT * float(
            np.linalg.norm(descent.angles - present)
        )
        price += MISS_PENALTY * (descent.miss > RETRY_DISTANCE) * (1.0 + descent.miss)
        if price < least:
            best, least = descent.angles, price
    settled = np.array(angles)
    settled[joints] = best
    return settled


def _in_base(reach: Reach, frames: Frames, base: int) -> Reach:
    rotation, origin = frames.rotations[base], frames.origins[base]
    pointing, palm = (None if d is None else sealed(rotation.T @ d) for d in (reach.pointing, reach.palm))
    return Reach(sealed(rotation.T @ (reach.position - origin)), pointing, palm, reach.swivel)


def _errors(arm: TrueArm, reach: Reach, elbow: Floats | None, size: float) -> ErrorFunction:
    """Return the function that computes errors of hand position, directions and elbow."""
    given = [reach.pointing, reach.palm]
    rows_of = [k for k in range(2) if given[k] is not None]
    aims = np.array([direction for direction in given if direction is not None]).reshape(-1, 3)
    aims = aims / np.linalg.norm(aims, axis=1, keepdims=True) if len(aims) else aims

    def errors(angles: Floats) -> tuple[Floats, Floats]:
        points, directions, moves = arm.posture(angles)
        rows = [(reach.position - points[1]) / size, *(DIRECTION_WEIGHT * (aims - directions[rows_of]))]
        columns = [moves[1] / size, *(DIRECTION_WEIGHT * moves[2:][rows_of])]
        if elbow is not None:
            rows.append(ELBOW_WEIGHT * (elbow - points[0]) / size)
            columns.append(ELBOW_WEIGHT * moves[0] / size)
        return np.concatenate(rows), np.concatenate(columns)

    return errors
