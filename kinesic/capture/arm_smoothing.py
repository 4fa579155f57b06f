"""Smoothing of arm motions that follow a captured path.

Inverse kinematics follows a path exactly, with fast rotations where the upper arm passes the axis of a shoulder hinge.
Here small errors of wrist and elbow are traded for lower accelerations, by Gauss-Newton steps over the whole path.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solveh_banded

from kinesic.body.arrays import Floats
from kinesic.body.robot import Side
from kinesic.capture.clip import ArmPath
from kinesic.capture.robot_motion import SAMPLE_RATE, arm_path, arm_paths
from kinesic.planning.setup import Setup

MAX_ITERATIONS = 6  # largest number of Gauss-Newton steps, including rejected steps
DIFFERENCE_STEP = 1e-4  # [rad] rotation for finite differences of positions
WRIST_TOLERANCE = 0.02  # [arm lengths] wrist error that adds 1 to the cost of a sample
ELBOW_TOLERANCE = 0.10  # [arm lengths] elbow error that adds 1 to the cost of a sample
ACCELERATION_WEIGHT = 1.0  # cost of a sample with one hinge at its acceleration limit
FIRST_DAMPING = 10.0  # [1/rad^2] initial damping of the steps (Levenberg-Marquardt)
DAMPING_FACTOR = 10.0  # factor on the damping after a rejected step, and divisor after an accepted step
MIN_DECREASE = 0.01  # relative decrease of the cost below which the search ends


@dataclass
class _Arm:
    """State of the smoothing search for one arm."""

    hinges: list[int]  # indices of the arm's hinges
    path: ArmPath  # desired path of elbow and wrist
    weights: Floats  # (k,) cost weights of squared second differences of the angles
    lower: Floats  # (k,) [rad] lower ends of the joint ranges
    upper: Floats  # (k,) [rad] upper ends of the joint ranges
    angles: Floats  # (m, k) [rad] arm angles of the current step
    damping: float = FIRST_DAMPING
    is_finished: bool = False

    def cost(self, angles: Floats, errors: Floats) -> float:
        """Return the summed cost of path errors (m, 6) and hinge accelerations."""
        return float(np.sum(errors**2) + np.sum(self.weights * np.diff(angles, 2, axis=0) ** 2))


def smooth_arms(angles: Floats, arms: Mapping[Side, ArmPath], setup: Setup) -> Floats:
    """Lower the accelerations of arm postures near their desired paths.

    Args:
        angles: (m, n) [rad] at `SAMPLE_RATE`; only the hinges of the given arms change.
        arms: (m, 3) desired paths [arm lengths].
        setup: robot and limits.
    """
    robot, limits, smoothed = setup.robot, setup.limits, angles.copy()
    searches = {}
    for side, path in arms.items():
        own = list(robot.arms[side].indices)
        weights = ACCELERATION_WEIGHT * (SAMPLE_RATE**2 / limits.acceleration[own]) ** 2
        searches[side] = _Arm(own, path, weights, limits.lower[own], limits.upper[own], smoothed[:, own])
    paths = arm_paths(robot, smoothed)
    for _ in range(MAX_ITERATIONS):
        active = {side: arm for side, arm in searches.items() if not arm.is_finished}
        if not active:
            break
        errors = {side: _errors(paths[side], arm.path) for side, arm in active.items()}
        jacobians = _find_jacobians(smoothed, active, errors, setup)
        tried = smoothed.copy()
        for side, arm in active.items():
            step = _solve_step(arm, errors[side], jacobians[side])
            tried[:, arm.hinges] = np.clip(arm.angles + step, arm.lower, arm.upper)
        reached = arm_paths(robot, tried)
        for side, arm in active.items():
            before = arm.cost(arm.angles, errors[side])
            after = arm.cost(tried[:, arm.hinges], _errors(reached[side], arm.path))
            if after >= before:
                arm.damping *= DAMPING_FACTOR
                continue
            arm.is_finished = before - after < MIN_DECREASE * before
            arm.damping /= DAMPING_FACTOR
            arm.angles = tried[:, arm.hinges]
            smoothed[:, arm.hinges] = arm.angles
        paths = arm_paths(robot, smoothed)
    return smoothed


def _find_jacobians(
    angles: Floats, active: Mapping[Side, _Arm], errors: Mapping[Side, Floats], setup: Setup
) -> Mapping[Side, Floats]:
    """Return each arm's error Jacobian (m, 6, k) by finite differences."""
    jacobians = {}
    for side, arm in active.items():
        jacobians[side] = np.empty((*errors[side].shape, len(arm.hinges)))
        for k, hinge in enumerate(arm.hinges):
            moved = angles.copy()
            moved[:, hinge] += DIFFERENCE_STEP
            changed = _errors(arm_path(setup.robot, side, moved), arm.path)
            jacobians[side][:, :, k] = (changed - errors[side]) / DIFFERENCE_STEP
    return jacobians


def _errors(reached: ArmPath, desired: ArmPath) -> Floats:
    """Return wrist and elbow errors (m, 6) in multiples of their tolerances.

    The desired elbow lies in the path's direction, at the robot's own shoulder-elbow distance.
    """
    lengths = np.linalg.norm(reached.elbow, axis=1, keepdims=True)
    directions = desired.elbow / np.maximum(np.linalg.norm(desired.elbow, axis=1, keepdims=True), 1e-9)
    wrist = (reached.wrist - desired.wrist) / WRIST_TOLERANCE
    return np.concatenate([wrist, (reached.elbow - lengths * directions) / ELBOW_TOLERANCE], axis=1)


def _solve_step(arm: _Arm, errors: Floats, jacobians: Floats) -> Floats:
    """Return the damped Gauss-Newton step (m, k) [rad] of one arm.

    Args:
        arm: with its angles and weights.
        errors: (m, 6) in tolerances.
        jacobians: (m, 6, k) of the errors.
    """
    count, hinges = arm.angles.shape
    normal = np.einsum("tia,tib->tab", jacobians, jacobians)
    normal[:, np.arange(hinges), np.arange(hinges)] += arm.damping
    gradient = np.einsum("tia,ti->ta", jacobians, errors)
    curvature = arm.weights * np.diff(arm.angles, 2, axis=0)
    for offset, factor in ((0, 1.0), (1, -2.0), (2, 1.0)):
        gradient[offset : offset + len(curvature)] += factor * curvature
    bands = np.zeros((2 * hinges + 1, count * hinges))
    for distance in range(hinges):
        for first in range(hinges - distance):
            bands[2 * hinges - distance, first + distance :: hinges] = normal[:, first, first + distance]
    for offset, values in enumerate(_second_difference_bands(count)):
        bands[(2 - offset) * hinges, offset * hinges :] += (values[:, None] * arm.weights).ravel()
    step: Floats = solveh_banded(bands, -gradient.ravel()).reshape(count, hinges)
    return step


def _second_difference_bands(count: int) -> tuple[Floats, Floats, Floats]:
    """Return the diagonals of D^T D for a second-difference matrix D.

    These are the main diagonal and both upper ones, for a number of samples.
    """
    main, first, second = np.zeros(count), np.zeros(count - 1), np.zeros(count - 2)
    main[:-2] += 1.0
    main[1:-1] += 4.0
    main[2:] += 1.0
    first[:-1] -= 2.0
    first[1:] -= 2.0
    second += 1.0
    return main, first, second
