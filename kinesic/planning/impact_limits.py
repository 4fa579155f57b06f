"""Limits of contacts with people, kept by slower hinges or fewer behaviours.

The force of a contact grows with the velocity of the touched point. Where a motion exceeds the policy, the velocity
limits of the hinges that move the worst point are lowered, and the motion is planned again.
"""

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.impact_policy import ENERGY_ROW
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.motion.condition import Conditioned
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import find_planned_spans, list_keyed_syncs

MAX_IMPACT_RATIO = 0.995  # largest planned ratio of force to its limit at the knots; slightly higher between them
TARGET_RATIO = 0.97  # ratio of force to its limit that a slowed motion aims at
MIN_CONTRIBUTION = 0.05  # smallest contribution to contact speed / largest one, from which early rounds slow a hinge
LARGE_CONTRIBUTION = 0.3  # smallest contribution to contact speed / largest one, from which late rounds slow a hinge
EARLY_ROUNDS = 4  # number of rounds that scale the peak velocity of a hinge in the whole motion
MIN_VELOCITY_LIMIT = 0.02  # [rad/s] lowest velocity limit of a slowed hinge
IMPACT_SPAN = 2.0  # [s] excessive contacts up to this time from the worst one are attributed to the same behaviour


def compute_impact_ratios(trajectory: Trajectory, times: Floats, setup: Setup) -> Floats:
    """Compute the largest ratio (m,) of contact quantity to limit.

    The quantities are contact force and energy. Ratios up to `MAX_IMPACT_RATIO` are upper bounds. They are zero without
    a policy.
    """
    if setup.policy is None or setup.impacts is None or not len(times):
        return np.zeros(len(times))
    angles, velocities, _ = trajectory.sample(times)
    survey = setup.impacts.survey(angles, velocities, setup.policy.rows, gate=MAX_IMPACT_RATIO)
    return np.asarray(survey.values.max(axis=1))


def slow_hinges(trajectory: Trajectory, velocity_limits: Floats, setup: Setup, attempt: int) -> Floats | None:
    """Lower the velocity limits of hinges that cause excessive contact forces.

    Args:
        trajectory: planned motion.
        velocity_limits: (n,) [rad/s] limits of this motion.
        setup: policy and robot.
        attempt: number of earlier motions. Late rounds slow hinges to their velocity at the excess.

    Returns:
        (n,) [rad/s], or None if the motion keeps the policy.
    """
    if setup.policy is None or setup.impacts is None:
        return None
    times = knot_times(trajectory)
    angles, velocities, _ = trajectory.sample(times)
    survey = setup.impacts.survey(angles, velocities, setup.policy.rows, gate=MAX_IMPACT_RATIO)
    worst_rows = survey.values.argmax(axis=1)
    ratios = survey.values.max(axis=1)
    over = np.flatnonzero(ratios > MAX_IMPACT_RATIO)
    if not len(over):
        return None
    points = survey.points[over, worst_rows[over]]
    contributions = compute_contributions(angles[over], velocities[over], points, setup)
    factors = TARGET_RATIO / ratios[over, None]
    if attempt < EARLY_ROUNDS:
        peaks = np.abs(velocities).max(axis=0)
        slowed = np.where(contributions > MIN_CONTRIBUTION, factors * peaks, np.inf).min(axis=0)
    else:
        slowed = np.where(contributions > LARGE_CONTRIBUTION, factors * np.abs(velocities[over]), np.inf).min(axis=0)
    return sealed(np.minimum(velocity_limits, np.maximum(slowed, MIN_VELOCITY_LIMIT)))


def compute_contributions(angles: Floats, velocities: Floats, points: np.ndarray, setup: Setup) -> Floats:
    """Compute the contribution of each hinge to the velocity of a point.

    Args:
        angles: (m, n) [rad].
        velocities: (m, n) [rad/s].
        points: (m,) indices of points.
        setup: robot.

    Returns:
        (m, n) relative to the largest contribution at each time.
    """
    assert setup.impacts is not None
    jacobians = setup.impacts.jacobians(angles, points)
    directions = np.einsum("mdn,mn->md", jacobians, velocities)
    parts = np.abs(np.einsum("md,mdn->mn", directions, jacobians) * velocities)
    return np.asarray(parts / np.maximum(parts.max(axis=1, keepdims=True), np.finfo(float).tiny))


def knot_times(trajectory: Trajectory) -> Floats:
    """Return the performance times (m,) [s] of a motion's knots."""
    return np.asarray(trajectory.start + np.arange(0.0, trajectory.duration, KNOT_INTERVAL))


def find_excess_times(motion: Trajectory, changed: Trajectory, times: Floats, setup: Setup) -> Floats:
    """Return times [s] at which a changed motion newly exceeds the policy."""
    ratios = compute_impact_ratios(changed, times, setup)
    over = ratios > MAX_IMPACT_RATIO
    if not over.any():
        return np.zeros(0)
    before = compute_impact_ratios(motion, times[over], setup)
    return np.asarray(times[over][ratios[over] > np.maximum(MAX_IMPACT_RATIO, before)])


def find_worst_excess(motion: Trajectory, before: Trajectory, setup: Setup) -> tuple[float, float] | None:
    """Find the largest new excess over the contact limits.

    Returns its time [s] and its ratio to the limit, or None without a new excess.

    Args:
        motion: changed motion.
        before: motion before the change, whose own excesses do not count.
        setup: policy and robot.
    """
    if setup.policy is None:
        return None
    times = knot_times(motion)
    ratios = compute_impact_ratios(motion, times, setup)
    if not len(ratios) or ratios.max() <= 1.0:
        return None
    new = np.where(ratios > np.maximum(1.0, compute_impact_ratios(before, times, setup)), ratios, 0.0)
    worst = int(new.argmax())
    return (float(times[worst]), float(new[worst])) if new.any() else None


def find_excessive_behaviours(frames: KeyFrames, motion: Conditioned, setup: Setup) -> dict[str, str]:
    """Find the behaviours to drop because no slower motion keeps the policy.

    Returns reasons by behaviour.
    """
    if setup.policy is None or setup.impacts is None or not frames.frames:
        return {}
    trajectory, rows = motion.trajectory, setup.policy.rows
    times = knot_times(trajectory)
    angles, velocities, _ = trajectory.sample(times)
    survey = setup.impacts.survey(angles, velocities, rows, gate=1.0)
    ratios = survey.values.max(axis=1)
    over = np.flatnonzero(ratios > 1.0)
    over = over[np.argsort(-ratios[over], kind="stable")]
    spans_of = find_planned_spans((name, planned) for name, _, _, planned in list_keyed_syncs(frames, motion))
    reasons: dict[str, str] = {}
    while over.size and spans_of:
        worst = int(over[0])
        row, time = int(survey.values[worst].argmax()), float(times[worst] - trajectory.zero)
        owner = setup.impacts.owners[int(survey.points[worst, row])]
        away = {name: max(start - time, time - end, 0.0) for name, (start, end) in spans_of.items()}
        what = "energy" if rows.names[row] == ENERGY_ROW else f"force on a {rows.names[row].replace('_', ' ')}"
        why = f"exceeds the limit of {what} (near: {setup.policy.audience}) by {owner} at {time:.2f} s"
        reasons.setdefault(min(away, key=lambda name: (away[name], name)), why)
        over = over[np.abs(times[over] - times[worst]) > IMPACT_SPAN]
    return reasons
