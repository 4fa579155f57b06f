"""Self-collision avoidance for sampled arm motions."""

import numpy as np
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from kinesic.body.arrays import Flags, Floats, Indices, find_runs, sealed
from kinesic.body.robot import SIDES
from kinesic.capture.robot_motion import SAMPLE_RATE
from kinesic.planning.setup import Setup

MAX_ROUNDS = 16  # largest number of correction rounds of a path
GRADIENT_STEP = 1e-3  # [rad] rotation for the finite difference of the clearance
MIN_GRADIENT = 0.02  # [m/rad] damping of corrections where clearance hardly depends on the hinges
MAX_CORRECTION = 0.08  # [rad] largest rotation of a hinge in one round
CORRECTION_MARGIN = 0.002  # [m] clearance beyond the required one that a correction aims at
CORRECTION_WINDOW = 0.10  # [s] window of the maximum filter that holds a correction at full size
CORRECTION_SMOOTHING = 0.06  # [s] standard deviation of the Gaussian filter on corrections
FADE_TIME = 0.15  # [s] time over which corrections fade to zero at both ends of the motion
SAMPLES_PER_GRADIENT = 5  # number of samples per gradient, less than `CORRECTION_WINDOW` holds


def clear_path(angles: Floats, setup: Setup, *, min_clearance: float) -> Floats:
    """Rotate arms away from the robot's body where clearance is too small.

    The hinges of each arm follow the gradient of its smallest distance; the corrections are smooth over time, and zero
    at both ends. The result may still be too near where no direction leads away.

    Args:
        angles: (m, n) [rad] at `SAMPLE_RATE`.
        setup: robot and distances.
        min_clearance: [m] required distance.

    Returns:
        (m, n) [rad] within the joint ranges.
    """
    robot, cleared = setup.robot, angles.copy()
    fade = _fade(len(angles))[:, None]
    is_near = setup.distances.clearance(cleared).distances < min_clearance
    for _ in range(MAX_ROUNDS):
        if not is_near.any():
            break
        rows = np.flatnonzero(is_near)
        gaps = setup.distances.gaps(cleared[rows])
        for side in SIDES:
            bodies, hinges = robot.arm(side).bodies, list(robot.arm(side).joints)
            is_own = np.array([bool(bodies & set(pair)) for pair in robot.counted_pairs], dtype=np.bool_)
            distances = np.full(len(angles), np.inf)
            distances[rows] = gaps[:, is_own].min(axis=1, initial=np.inf)
            chosen = _choose_samples(distances, min_clearance)
            steps = _find_steps(cleared[chosen], distances[chosen], (hinges, is_own), setup, min_clearance)
            corrections = np.zeros((len(angles), len(hinges)))
            corrections[chosen] = steps
            lower, upper = robot.skeleton.lower[hinges], robot.skeleton.upper[hinges]
            cleared[:, hinges] = np.clip(cleared[:, hinges] + fade * _smooth(corrections), lower, upper)
        is_near = setup.distances.clearance(cleared).distances < min_clearance
    return sealed(cleared)


def _fade(count: int) -> Floats:
    """Return correction factors (m,), 0 at both ends and 1 in between."""
    samples = np.arange(count) / (FADE_TIME * SAMPLE_RATE)
    factors: Floats = np.minimum(1.0, np.minimum(samples, samples[::-1]))
    return factors**2 * (3.0 - 2.0 * factors)


def _choose_samples(distances: Floats, min_clearance: float) -> Indices:
    """Return the indices of close samples at which gradients are computed.

    Of each run: every `SAMPLES_PER_GRADIENT`-th sample, and the closest one.
    """
    chosen: list[int] = []
    for begin, end in find_runs(distances < min_clearance):
        chosen += range(begin, end, SAMPLES_PER_GRADIENT)
        chosen.append(begin + int(distances[begin:end].argmin()))
    return np.unique(np.array(chosen, dtype=np.intp))


def _find_steps(
    angles: Floats, distances: Floats, arm: tuple[list[int], Flags], setup: Setup, min_clearance: float
) -> Floats:
    """Return hinge rotations (m, h) [rad] that increase an arm's clearance.

    Args:
        angles: (m, n) [rad].
        distances: (m,) [m] smallest distance of the arm.
        arm: indices of its hinges, and flags of its pairs of segments.
        setup: robot and distances.
        min_clearance: [m] required distance.
    """
    hinges, is_own = arm
    moved = np.repeat(angles[:, None], len(hinges), axis=1)
    moved[:, np.arange(len(hinges)), hinges] += GRADIENT_STEP
    gaps = setup.distances.gaps(moved.reshape(-1, angles.shape[1]))[:, is_own]
    changed = gaps.min(axis=1, initial=np.inf).reshape(len(angles), len(hinges))
    gradients = (changed - distances[:, None]) / GRADIENT_STEP
    deficits = (min_clearance + CORRECTION_MARGIN - distances)[:, None]
    steps: Floats = gradients * deficits / (np.sum(gradients**2, axis=1, keepdims=True) + MIN_GRADIENT**2)
    return np.clip(steps, -MAX_CORRECTION, MAX_CORRECTION)


def _smooth(corrections: Floats) -> Floats:
    """Spread corrections (m, h) over neighbouring samples, each sign separately."""
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
