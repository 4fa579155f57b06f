"""Checks of merged motions for collisions, drive overload and contacts with people.

Both motions are free of collisions separately, so that only configurations from both together are checked. Inertia and
gravity couple the joints, so that drive loads depend on the sum of both motions.
"""

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.robot import SIDES
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.motion.transition import MIN_TRANSITION, SAME_ANGLE, extend_controls
from kinesic.planning.certify import compute_peak_duties
from kinesic.planning.clearance import MIN_LAG_RESERVE, scan_clearance
from kinesic.planning.impact_limits import find_worst_excess
from kinesic.planning.setup import Setup
from kinesic.realizer.occupancy import MergeFailure, Occupancy, Overlay
from kinesic.realizer.release import motion_from_knot

MAX_DUTY = 1.0  # largest accepted duty of a drive, as a fraction of full PWM
MOVING_FRACTION = 0.2  # smallest velocity of a hinge that causes a hard contact, relative to the fastest hinge


def find_conflict(work: Overlay, controls: Floats, setup: Setup) -> MergeFailure | None:
    """Return the collision, overload or excessive contact force of a merged motion.

    The failure names the block's behaviour closest to it in time. The result is None without a failure.

    Args:
        work: block and running motion.
        controls: (k + 3, n) [rad] control points of the merged motion.
        setup: distances and dynamics.
    """
    apart = [
        np.abs(controls - extend_controls(source, len(controls))).max(axis=1) > SAME_ANGLE
        for source in (work.base, work.coming)
    ]
    rows = np.flatnonzero(apart[0] & apart[1])
    if not len(rows) or rows[-1] < work.cut + MIN_TRANSITION:
        return None
    coming = motion_from_knot(controls[: rows[-1] + MIN_TRANSITION], work.cut)
    return (
        _find_collision(coming, work, setup) or _find_overload(coming, work, setup) or _find_excess(coming, work, setup)
    )


def _find_collision(coming: Trajectory, work: Overlay, setup: Setup) -> MergeFailure | None:
    times, clearance = scan_clearance(coming, setup.distances)
    worst, robot = clearance.worst, setup.robot
    distance = float(clearance.distances[worst])
    if distance >= robot.min_clearance + MIN_LAG_RESERVE:
        return None
    pair, at = clearance.pairs[worst], float(times[worst]) + work.cut * KNOT_INTERVAL
    hinges = np.zeros(len(robot.skeleton.hinges), dtype=np.bool_)
    for side in SIDES:
        if set(pair) & robot.arm(side).bodies:
            hinges[list(robot.arm(side).all_joints)] = True
    name = _nearest_behaviour(work, hinges, at)
    return MergeFailure(
        name, f"brings {pair[0]} within {1000 * distance:.0f} mm of {pair[1]} in combination with the running motion"
    )


def _find_overload(coming: Trajectory, work: Overlay, setup: Setup) -> MergeFailure | None:
    peaks = compute_peak_duties(coming, setup)
    if peaks.max() <= MAX_DUTY:
        return None
    before = compute_peak_duties(motion_from_knot(work.base[: work.cut + len(coming.controls)], work.cut), setup)
    over = (peaks > MAX_DUTY) & (peaks > before)
    if not over.any():
        return None
    worst = int(np.where(over, peaks, 0.0).argmax())
    joint = setup.robot.skeleton.names[worst]
    name = _nearest_behaviour(work, np.arange(len(peaks)) == worst, work.cut * KNOT_INTERVAL)
    return MergeFailure(
        name, f"needs {100 * peaks[worst]:.0f} % of the duty of {joint} in combination with the running motion"
    )


def _find_excess(coming: Trajectory, work: Overlay, setup: Setup) -> MergeFailure | None:
    before = motion_from_knot(work.base[: work.cut + len(coming.controls)], work.cut)
    excess = find_worst_excess(coming, before, setup)
    if excess is None or setup.policy is None:
        return None
    time, _ = excess
    moving = np.abs(coming.sample(np.array([time]))[1][0])
    name = _nearest_behaviour(work, moving > MOVING_FRACTION * moving.max(), time + work.cut * KNOT_INTERVAL)
    limit = f"the limit of contacts (near: {setup.policy.audience})"
    return MergeFailure(name, f"exceeds {limit} in combination with the running motion")


def _nearest_behaviour(work: Overlay, hinges: Flags, at: float) -> str:
    """Return the behaviour nearest in time, preferably one that moves given hinges.

    The result is empty if the block performs no behaviour.
    """

    def distance(entry: Occupancy) -> tuple[bool, float]:
        return not (entry.hinges & hinges).any(), max(entry.begin - at, at - entry.end, 0.0)

    return min(work.performed, key=distance).behaviour if work.performed else ""
