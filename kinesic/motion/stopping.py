"""Stops a running motion in the least time, under the same limits.

The control points that are in force at the cut are kept, so that angles, speeds and accelerations go on without a step
and every limit holds across the cut as it does elsewhere. See `merge` for the ways over into another motion.
"""

from collections.abc import Callable

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.double_s import least_stop
from kinesic.motion.segments import SplineSegment
from kinesic.motion.spline_program import nearest_motion
from kinesic.motion.trajectory import EARLY, STEP, Trajectory
from kinesic.motion.transition import FEWEST_PIECES, roomy


def cut_knot(running: Trajectory, time: float) -> int:
    """Finds the knot at which a motion can be left: the first not before a time [s]."""
    return int(np.clip(np.ceil((time - running.start) / STEP - EARLY), 0, len(running.controls) - 3))


def stop(running: Trajectory, time: float, limits: Limits) -> Trajectory:
    """Stops a motion in the least time, each hinge wherever it comes to rest.

    Args:
        running: the motion, within the limits.
        time: [s] from which it may be left, at the next knot.
        limits: of all hinges.

    Returns:
        The same until the cut, then to rest.
    """
    knot, room = cut_knot(running, time), roomy(limits)
    _, speeds, accelerations = running.sample(np.array([running.start + knot * STEP]))
    least = least_stop(speeds[0], accelerations[0], room.acceleration, room.jerk) / STEP
    ways = enumerate(zip(running.controls[knot:].T, least, strict=True))
    tails = [_halt(hinge, own, int(pieces), room) for hinge, (own, pieces) in ways]
    length = max(4 - knot, *(len(tail) for tail in tails))  # one piece at least
    whole = np.stack([np.append(tail, np.full(length - len(tail), tail[-1])) for tail in tails], axis=1)
    return Trajectory(sealed(np.vstack([running.controls[:knot], whole])), running.zero, running.start)


def _halt(hinge: int, own: Floats, least: int, limits: Limits) -> Floats:
    """Control points of the shortest way to rest in at least so many pieces; at worst its own way (k + 3,)."""
    if np.ptp(own[:3]) == 0.0:
        return own[:3]

    def way(more: int) -> Floats | None:
        pieces = max(FEWEST_PIECES, least) + more
        halt = SplineSegment.between(hinge, pieces, own[:3])
        return nearest_motion(halt, np.full(pieces + 1, float(own[1])), limits)

    found = _first(way, len(own) - 3 - max(FEWEST_PIECES, least))
    return own if found is None else found[1]


def _first(way: Callable[[int], Floats | None], most: int) -> tuple[int, Floats] | None:
    """Least number of further pieces with which there is a way: doubled until there is one, then halved back."""
    low, high, found = -1, 0, way(0)
    while found is None:
        low, high = high, 2 * high + 1
        if high > most:
            return None
        found = way(high)
    while high - low > 1:
        middle = (low + high) // 2
        shorter = way(middle)
        if shorter is None:
            low = middle
        else:
            high, found = middle, shorter
    return high, found
