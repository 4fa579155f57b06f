"""Minimum-time stop of a running motion within its limits.

The control points that are active at the cut are kept, so that angles, velocities and accelerations stay continuous
and every limit also holds across the cut. See `realizer.merge` for transitions into another motion.
"""

from collections.abc import Callable

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.double_s import least_stop
from kinesic.motion.segments import SplineSegment
from kinesic.motion.spline_program import nearest_motion
from kinesic.motion.trajectory import KNOT_INTERVAL, KNOT_TOLERANCE, Trajectory
from kinesic.motion.transition import MIN_TRANSITION, widen_limits


def cut_knot(running: Trajectory, time: float) -> int:
    """Return the motion's first knot at or after a time [s].

    It is the last knot for a later time.
    """
    return int(np.clip(np.ceil((time - running.start) / KNOT_INTERVAL - KNOT_TOLERANCE), 0, len(running.controls) - 3))


def stop(running: Trajectory, time: float, limits: Limits) -> Trajectory:
    """Stop a motion in minimum time, hinge by hinge.

    Args:
        running: the motion, within the limits.
        time: [s] from which it may be left, at the next knot.
        limits: of all hinges.

    Returns:
        The same motion until the cut, then the stop.
    """
    knot, widened = cut_knot(running, time), widen_limits(limits)
    _, speeds, accelerations = running.sample(np.array([running.start + knot * KNOT_INTERVAL]))
    min_intervals = least_stop(speeds[0], accelerations[0], widened.acceleration, widened.jerk) / KNOT_INTERVAL
    columns = enumerate(zip(running.controls[knot:].T, min_intervals, strict=True))
    tails = [_stop_hinge(hinge, controls, int(count), widened) for hinge, (controls, count) in columns]
    length = max(4 - knot, *(len(tail) for tail in tails))  # at least one knot interval
    whole = np.stack([np.append(tail, np.full(length - len(tail), tail[-1])) for tail in tails], axis=1)
    return Trajectory(sealed(np.vstack([running.controls[:knot], whole])), running.zero, running.start)


def _stop_hinge(hinge: int, controls: Floats, min_intervals: int, limits: Limits) -> Floats:
    """Return control points [rad] of a hinge's shortest stop.

    They are unchanged if no shorter stop is possible.
    """
    if np.ptp(controls[:3]) == 0.0:
        return controls[:3]

    def solve(extra: int) -> Floats | None:
        pieces = max(MIN_TRANSITION, min_intervals) + extra
        segment = SplineSegment.between(hinge, pieces, controls[:3])
        return nearest_motion(segment, np.full(pieces + 1, float(controls[1])), limits)

    shortest = _find_shortest(solve, len(controls) - 3 - max(MIN_TRANSITION, min_intervals))
    return controls if shortest is None else shortest[1]


def _find_shortest(solve: Callable[[int], Floats | None], max_extra: int) -> tuple[int, Floats] | None:
    """Return the fewest extra knot intervals that permit a stop, with solution.

    The number is doubled until there is one, then bisected. None if it would exceed `max_extra`.
    """
    low, high, solution = -1, 0, solve(0)
    while solution is None:
        low, high = high, 2 * high + 1
        if high > max_extra:
            return None
        solution = solve(high)
    while high - low > 1:
        middle = (low + high) // 2
        shorter = solve(middle)
        if shorter is None:
            low = middle
        else:
            high, solution = middle, shorter
    return high, solution
