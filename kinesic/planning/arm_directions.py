"""Conversion between arm postures and the directions of the arm's links."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot, Side

LINK_NAMES = ("upper_arm", "forearm", "hand")  # links of an arm, from the shoulder outward
# Two angles [deg] of each link: from straight down towards the front, and outward from the sagittal plane.
ARM_FEATURES = tuple(f"{link}_{direction}" for link in LINK_NAMES for direction in ("forward", "outward"))
SOLVER_STEPS = 8  # largest number of Gauss-Newton iterations for an arm's posture
STEP_TOLERANCE = 1e-5  # [rad] largest hinge change per iteration below which the solver stops
HINGE_WEIGHT = 0.06  # [1/rad] weight of a hinge's deviation from its start angle, relative to direction errors
DIFFERENCE_STEP = 1e-4  # [rad] angle step of numeric derivatives
MIN_SHOULDER_DISTANCE = 1e-6  # [m] smallest assumed distance between the shoulders, which avoids division by zero


def measure_arm(robot: Robot, side: Side, angles: Floats) -> Floats:
    """Compute link angles (..., 6) [deg] of an arm from postures [rad].

    The columns are `ARM_FEATURES`.
    """
    directions = _link_directions(robot, side, angles)
    outward = directions[..., 1] * (1.0 if side == "l" else -1.0)
    forward_angle = np.arctan2(directions[..., 0], -directions[..., 2])
    pairs = np.stack([forward_angle, np.arcsin(np.clip(outward, -1.0, 1.0))], axis=-1)
    return np.asarray(np.degrees(pairs.reshape(*pairs.shape[:-2], -1)))


def set_arm(robot: Robot, side: Side, features: Floats, angles: Floats) -> Floats:
    """Return a posture (n,) [rad] whose arm has given link angles.

    Link directions are compared as unit vectors. Hinges that lift the shoulder keep their angles. An arm that the robot
    lacks is ignored.

    Args:
        robot: with the arm.
        side: of the arm.
        features: (6,) [deg] in the order of `ARM_FEATURES`.
        angles: (n,) [rad] start, with the trunk at its final angles; the arm stays close to it.
    """
    skeleton, arm, solved = robot.skeleton, robot.arm(side), np.array(angles)
    joints = [joint for joint in arm.joints if joint not in arm.shoulder_lift_joints]
    if not joints:
        return solved
    targets, start = _to_directions(side, features), np.array(angles[joints])
    lower, upper = (np.asarray(bound)[joints] for bound in (skeleton.lower, skeleton.upper))
    for _ in range(SOLVER_STEPS):
        nudged = np.repeat(solved[None], len(joints) + 1, axis=0)
        nudged[np.arange(len(joints)), joints] += DIFFERENCE_STEP
        directions = _link_directions(robot, side, nudged).reshape(len(nudged), -1)
        slopes = (directions[:-1] - directions[-1]).T / DIFFERENCE_STEP
        error = targets.ravel() - directions[-1]
        matrix = np.vstack([slopes, HINGE_WEIGHT * np.eye(len(joints))])
        right = np.concatenate([error, HINGE_WEIGHT * (start - solved[joints])])
        before = solved[joints]
        solved[joints] = np.clip(before + np.linalg.lstsq(matrix, right, rcond=None)[0], lower, upper)
        if np.abs(solved[joints] - before).max() < STEP_TOLERANCE:
            break
    return solved


def _to_directions(side: Side, features: Floats) -> Floats:
    """Convert `ARM_FEATURES` (6,) [deg] to link directions (3, 3) in shoulder axes."""
    forward, outward = np.radians(np.asarray(features).reshape(-1, 2)).T
    across = np.sin(outward) * (1.0 if side == "l" else -1.0)
    return np.stack([np.cos(outward) * np.sin(forward), across, -np.cos(outward) * np.cos(forward)], axis=-1)


def _link_directions(robot: Robot, side: Side, angles: Floats) -> Floats:
    """Return an arm's link directions (..., 3, 3) in shoulder axes.

    These axes are forward, left and up: the line of the shoulders is level, also where the trunk leans. The hand points
    along the forearm where all hinges are at zero.
    """
    skeleton, arm = robot.skeleton, robot.arm(side)
    needed = frozenset({arm.wrist, *(robot.arm(which).shoulder for which in SIDES)})
    frames = skeleton.frames(angles, without=skeleton.segments_off_path(needed))
    points = [frames.origins[..., joint, :] for joint in (arm.shoulder, arm.elbow, arm.wrist)]
    straight = skeleton.zero_frames.rotations[arm.wrist].T @ (
        skeleton.zero_frames.origins[arm.wrist] - skeleton.zero_frames.origins[arm.elbow]
    )
    links = np.stack(
        [points[1] - points[0], points[2] - points[1], frames.rotations[..., arm.wrist, :, :] @ straight], axis=-2
    )
    links /= np.linalg.norm(links, axis=-1, keepdims=True)
    left, right = (frames.origins[..., robot.arm(which).shoulder, :] for which in SIDES)
    across = (left - right) * [1.0, 1.0, 0.0]
    across /= np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), MIN_SHOULDER_DISTANCE)
    up = np.array([0.0, 0.0, 1.0])
    axes = np.stack([np.cross(across, up), across, np.broadcast_to(up, across.shape)], axis=-2)
    return np.asarray(links @ np.swapaxes(axes, -1, -2))
