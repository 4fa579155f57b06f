"""Detours of dense motions around the robot's own body."""

import numpy as np
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES
from kinesic.capture.robot_motion import SAMPLE_RATE
from kinesic.planning.setup import Setup

MAX_ROUNDS = 40  # largest number of corrections of a path
GRADIENT_STEP = 1e-3  # [rad] rotation for the finite difference of the distance
MIN_GRADIENT = 0.02  # [m/rad] damping of corrections where the distance hardly depends on the hinges
MAX_CORRECTION = 0.08  # [rad] largest rotation of a hinge in one round
CORRECTION_WINDOW = 0.10  # [s] time over which a correction has full size
CORRECTION_SMOOTHING = 0.06  # [s] standard deviation that smooths corrections


def clear_path(angles: Floats, setup: Setup, *, min_clearance: float) -> Floats:
    """Move arms away from the body where they are too near.

    The hinges of the arms follow the gradient of the smallest distance; the corrections are smooth over time. The
    result may still be too near where no direction leads away.

    Args:
        angles: (m, n) [rad] at `SAMPLE_RATE`.
        setup: robot and distances.
        min_clearance: [m] required distance.

    Returns:
        (m, n) [rad] within the joint ranges.
    """
    robot, cleared = setup.robot, angles.copy()
    hinges = [k for side in SIDES for k in robot.arm(side).joints]
    lower, upper = robot.skeleton.lower[hinges], robot.skeleton.upper[hinges]
    for _ in range(MAX_ROUNDS):
        distances = setup.distances.clearance(cleared).distances
        near = np.flatnonzero(distances < min_clearance)
        if not near.size:
            break
        gradients = _find_gradients(cleared[near], distances[near], hinges, setup)
        deficits = (min_clearance - distances[near])[:, None]
        steps = gradients * deficits / (np.sum(gradients**2, axis=1, keepdims=True) + MIN_GRADIENT**2)
        corrections = np.zeros((len(angles), len(hinges)))
        corrections[near] = np.clip(steps, -MAX_CORRECTION, MAX_CORRECTION)
        cleared[:, hinges] = np.clip(cleared[:, hinges] + _smooth(corrections), lower, upper)
    return sealed(cleared)


def _find_gradients(angles: Floats, distances: Floats, hinges: list[int], setup: Setup) -> Floats:
    """Return the gradient (m, h) [m/rad] of the smallest distance."""
    moved = np.repeat(angles[:, None], len(hinges), axis=1)
    moved[:, np.arange(len(hinges)), hinges] += GRADIENT_STEP
    changed = setup.distances.clearance(moved.reshape(-1, angles.shape[1])).distances
    gradients: Floats = (changed.reshape(len(angles), len(hinges)) - distances[:, None]) / GRADIENT_STEP
    return gradients


def _smooth(corrections: Floats) -> Floats:
    """Spread corrections (m, h) over neighbouring samples, of both signs apart."""
    window = max(1, round(CORRECTION_WINDOW * SAMPLE_RATE))
    up, down = (
        gaussian_filter1d(
            maximum_filter1d(np.maximum(sign * corrections, 0.0), window, axis=0),
            CORRECTION_SMOOTHING * SAMPLE_RATE,
            axis=0,
            mode="nearest",
        )
        for sign in (1.0, -1.0)
    )
    corrected: Floats = up - down
    return corrected
