"""Checks a block that was laid over a running motion: the body may come too near to itself, or a drive be overloaded.

Each of both motions is clear of the body by itself, so that only what is neither of them is measured; inertia and
gravity couple the hinges, so that the load of a drive is known only from both together.
"""

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.robot import SIDES
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.motion.transition import FEWEST_PIECES, SAME_ANGLE, lengthen
from kinesic.planning.certify import duties
from kinesic.planning.clearance import LEAST_RESERVE, scan_clearance
from kinesic.planning.setup import Setup
from kinesic.realizer.occupancy import MergeFailure, Occupancy, Overlay
from kinesic.realizer.release import from_knot

FULL_DUTY = 1.0  # of a drive's duty


def find_conflict(work: Overlay, found: Floats, setup: Setup) -> MergeFailure | None:
    """Names the behaviour of a block that brings the body too near to itself or overloads a drive; None: there is none.

    Args:
        work: the block and the running motion.
        found: (k + 3, n) [rad] control points of both together.
        setup: distances and dynamics.
    """
    apart = [np.abs(found - lengthen(each, len(found))).max(axis=1) > SAME_ANGLE for each in (work.base, work.coming)]
    rows = np.flatnonzero(apart[0] & apart[1])
    if not len(rows) or rows[-1] < work.cut + FEWEST_PIECES:
        return None
    coming = from_knot(found[: rows[-1] + FEWEST_PIECES], work.cut)
    return _too_near(coming, work, setup) or _too_heavy(coming, work, setup)


def _too_near(coming: Trajectory, work: Overlay, setup: Setup) -> MergeFailure | None:
    times, clearance = scan_clearance(coming, setup.distances)
    worst, robot = clearance.worst, setup.robot
    distance = float(clearance.distances[worst])
    if distance >= robot.least_clearance + LEAST_RESERVE:
        return None
    pair, at = clearance.pairs[worst], float(times[worst]) + work.cut * STEP
    hinges = np.zeros(len(robot.skeleton.hinges), dtype=np.bool_)
    for side in SIDES:
        if set(pair) & robot.arm(side).bodies:
            hinges[list(robot.arm(side).moving)] = True
    name = _nearest(work, hinges, at)
    return MergeFailure(name, f"brings {pair[0]} within {1000 * distance:.0f} mm of {pair[1]} beside what runs")


def _too_heavy(coming: Trajectory, work: Overlay, setup: Setup) -> MergeFailure | None:
    peaks = duties(coming, setup)
    if peaks.max() <= FULL_DUTY:
        return None
    before = duties(from_knot(work.base[: work.cut + len(coming.controls)], work.cut), setup)
    over = (peaks > FULL_DUTY) & (peaks > before)
    if not over.any():
        return None
    worst = int(np.where(over, peaks, 0.0).argmax())
    joint = setup.robot.skeleton.names[worst]
    name = _nearest(work, np.arange(len(peaks)) == worst, work.cut * STEP)
    return MergeFailure(name, f"asks {100 * peaks[worst]:.0f} % of the duty of {joint} beside what runs")


def _nearest(work: Overlay, hinges: Flags, at: float) -> str:
    """Names the behaviour that moves some hinges (n,) nearest to a time [s]; empty where the block performs none."""

    def away(each: Occupancy) -> tuple[bool, float]:
        return not (each.hinges & hinges).any(), max(each.begin - at, at - each.end, 0.0)

    return min(work.performed, key=away).behaviour if work.performed else ""
