"""Self-collision avoidance for sampled arm motions."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from kinesic.body.arrays import Flags, Floats, Indices, find_runs, sealed
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.capture.arm_tracking import interpolate_runs
from kinesic.capture.robot_motion import SAMPLE_RATE, arm_path
from kinesic.planning.setup import Setup

MAX_ROUNDS = 16  # largest number of correction rounds of a path
GRADIENT_STEP = 1e-3  # [rad] rotation for the finite difference of the clearance
MIN_GRADIENT = 0.02  # [m/rad] damping of corrections where clearance hardly depends on the hinges
MIN_GAIN = 1e-12  # smallest divisor, for samples whose clearance depends on no hinge
COST_GROWTH = 1.3  # factor on the cost of hinge rotations after each round, so that later rounds move the wrists more
MAX_CORRECTION = 0.08  # [rad] largest rotation of a hinge in one round
CORRECTION_MARGIN = 0.002  # [m] clearance beyond the required clearance at which a correction aims
CORRECTION_WINDOW = 0.10  # [s] window of the maximum filter that holds a correction at full size
CORRECTION_SMOOTHING = 0.06  # [s] standard deviation of the Gaussian filter on corrections
FADE_TIME = 0.15  # [s] time over which corrections fade to zero at both ends of the motion
SAMPLES_PER_GRADIENT = 8  # number of samples per computed gradient; must be shorter than `CORRECTION_WINDOW`


@dataclass(frozen=True, eq=False)
class _Arm:
    """Hinges of one arm, and the segment pairs that include this arm."""

    side: Side
    hinges: list[int]  # indices of the arm's hinges
    is_own: Flags  # (p,) whether each pair of `Robot.counted_pairs` includes a segment of this arm

    @classmethod
    def of(cls, robot: Robot, side: Side) -> "_Arm":
        """Return one arm of a robot."""
        arm = robot.arm(side)
        is_own = np.array([bool(arm.bodies & set(pair)) for pair in robot.counted_pairs], dtype=np.bool_)
        return cls(side, list(arm.joints), is_own)


def clear_path(angles: Floats, setup: Setup, *, min_clearance: float, hinge_cost: float) -> Floats:
    """Rotate arms away from the robot's body where clearance is too small.

    The hinges of each arm follow the gradient of its smallest distance, in the way that displaces the wrist least. The
    corrections are smooth over time, and zero at both ends. The result may still be too near where no direction leads
    away.

    Args:
        angles: (m, n) [rad] at `SAMPLE_RATE`.
        setup: robot and distances.
        min_clearance: [m] required distance.
        hinge_cost: [arm lengths/rad] cost of rotating a hinge, relative to the wrist displacement that it causes.

    Returns:
        (m, n) [rad] within the joint ranges.
    """
    robot, cleared = setup.robot, angles.copy()
    fade = _fade(len(angles))[:, None]
    arms = [_Arm.of(robot, side) for side in SIDES]
    nearest = np.full((len(arms), len(angles)), np.inf)  # [m] smallest distance of each arm, where measured
    measured = np.flatnonzero(setup.distances.clearance(cleared).distances < min_clearance)
    for _ in range(MAX_ROUNDS):
        if not measured.size:
            break
        gaps = setup.distances.gaps(cleared[measured], exact_below=min_clearance + CORRECTION_MARGIN)
        is_moved = np.zeros(len(angles), dtype=np.bool_)
        for arm, distances in zip(arms, nearest, strict=True):
            distances[measured] = gaps[:, arm.is_own].min(axis=1, initial=np.inf)
            chosen = _choose_samples(distances, min_clearance)
            if not chosen.size:
                continue
            corrections = np.zeros((len(angles), len(arm.hinges)))
            corrections[chosen] = _find_steps(arm, cleared[chosen], distances[chosen], setup, min_clearance, hinge_cost)
            lower, upper = robot.skeleton.lower[arm.hinges], robot.skeleton.upper[arm.hinges]
            corrected = np.clip(cleared[:, arm.hinges] + fade * _smooth(corrections), lower, upper)
            is_moved |= (corrected != cleared[:, arm.hinges]).any(axis=1)
            cleared[:, arm.hinges] = corrected
        measured = np.flatnonzero(is_moved)
        hinge_cost *= COST_GROWTH
    return sealed(cleared)


def bridge_contacts(angles: Floats, setup: Setup, *, min_clearance: float, margin: float) -> Floats:
    """Replace motion parts that bring an arm too close to the body.

    The arm moves smoothly from the posture before each part to the posture after it.

    Args:
        angles: (m, n) [rad] at `SAMPLE_RATE`.
        setup: robot and distances.
        min_clearance: [m] required distance.
        margin: [s] time left out in addition before and after each part.

    Returns:
        (m, n) [rad] with the same first and last posture.
    """
    bridged, window = angles.copy(), 2 * round(margin * SAMPLE_RATE) + 1
    gaps = setup.distances.gaps(angles, exact_below=min_clearance)
    for side in SIDES:
        arm = _Arm.of(setup.robot, side)
        is_near = gaps[:, arm.is_own].min(axis=1, initial=np.inf) < min_clearance
        is_left_out = maximum_filter1d(is_near, window)
        is_left_out[[0, -1]] = False
        bridged[:, arm.hinges] = interpolate_runs(angles[:, arm.hinges], is_left_out)
    return sealed(bridged)


def _fade(count: int) -> Floats:
    """Return correction factors (m,), 0 at both ends and 1 in between."""
    samples = np.arange(count) / (FADE_TIME * SAMPLE_RATE)
    factors: Floats = np.minimum(1.0, np.minimum(samples, samples[::-1]))
    return factors**2 * (3.0 - 2.0 * factors)


def _choose_samples(distances: Floats, min_clearance: float) -> Indices:
    """Return the indices of samples with small clearance, for gradients.

    Of each run: every `SAMPLES_PER_GRADIENT`-th sample, and the closest one.
    """
    chosen: list[int] = []
    for begin, end in find_runs(distances < min_clearance):
        chosen += range(begin, end, SAMPLES_PER_GRADIENT)
        chosen.append(begin + int(distances[begin:end].argmin()))
    return np.unique(np.array(chosen, dtype=np.intp))


def _find_steps(
    arm: _Arm, angles: Floats, distances: Floats, setup: Setup, min_clearance: float, hinge_cost: float
) -> Floats:
    """Return hinge rotations (m, h) [rad] that increase an arm's clearance.

    They minimise the squared wrist displacement [arm lengths] plus the squared rotation x `hinge_cost`.

    Args:
        arm: the arm.
        angles: (m, n) [rad].
        distances: (m,) [m] smallest distance of the arm.
        setup: robot and distances.
        min_clearance: [m] required distance.
        hinge_cost: [arm lengths/rad] cost of rotating a hinge.
    """
    count, hinges = len(angles), len(arm.hinges)
    moved = np.repeat(angles[:, None], hinges, axis=1)
    moved[:, np.arange(hinges), arm.hinges] += GRADIENT_STEP
    moved = moved.reshape(count * hinges, -1)
    gaps = setup.distances.gaps(moved, exact_below=min_clearance + CORRECTION_MARGIN)
    changed = gaps[:, arm.is_own].min(axis=1, initial=np.inf).reshape(count, hinges)
    gradients = (changed - distances[:, None]) / GRADIENT_STEP
    before, after = (arm_path(setup.robot, arm.side, postures).wrist for postures in (angles, moved))
    jacobians = (after.reshape(count, hinges, 3) - before[:, None]) / GRADIENT_STEP
    costs = jacobians @ np.swapaxes(jacobians, 1, 2) + hinge_cost**2 * np.eye(hinges)
    directions = np.linalg.solve(costs, gradients[:, :, None])[:, :, 0]
    gains = np.sum(directions * gradients, axis=1, keepdims=True)
    damping = MIN_GRADIENT**2 * np.sum(directions**2, axis=1, keepdims=True)
    deficits = (min_clearance + CORRECTION_MARGIN - distances)[:, None]
    steps = directions * gains * deficits / np.maximum(gains**2 + damping, MIN_GAIN)
    largest = np.abs(steps).max(axis=1, keepdims=True, initial=0.0)
    limited: Floats = steps * (MAX_CORRECTION / np.maximum(largest, MAX_CORRECTION))
    return limited


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
