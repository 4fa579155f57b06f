"""When a part of the body arrives where a sync point wants it, by one rule for plan and twin."""

from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from functools import cache

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot
from kinesic.controller.plan import Plan
from kinesic.controller.syncs import SyncTime
from kinesic.expressivity.keyframes import PartName

HANDS: tuple[PartName, PartName] = ("l_hand", "r_hand")
WINDOW = 0.3  # [s] before and after the planned time
LEAST_BALL = 0.005  # [m]
LEAST_CONE = np.radians(0.5)  # [rad] the ball's like for head and torso
SHARE = 0.05  # of the path


def paths(angles: Floats, robot: Robot, hands: Mapping[str, Floats] | None = None) -> Mapping[PartName, Floats]:
    """Where each part is along a motion: hands (m, 3) [m] in the world, head and torso (m, 3) [rad].

    Args:
        angles: (m, n) [rad].
        robot: the robot.
        hands: "l", "r" -> (m, 3) [m], when they are known already.
    """
    known = hands or _hands(angles, robot)
    return {
        "l_hand": known["l"],
        "r_hand": known["r"],
        "head": angles[:, list(robot.joints("neck"))],
        "torso": angles[:, list(robot.joints("torso"))],
    }


def _hands(angles: Floats, robot: Robot) -> dict[str, Floats]:
    origins = robot.skeleton.frames(angles).origins
    return {side: origins[:, robot.skeleton.segment(robot.chains[f"{side}_arm"][-1])] for side in SIDES}


def lags(
    plan: Plan, times: Floats, reference: Mapping[PartName, Floats], performed: Mapping[PartName, Floats]
) -> dict[SyncTime, float | None]:
    """How much later than planned the body arrives at each sync point [s].

    Arrival is the first time, within a window about the planned time, that the part enters a ball of 5 mm or 5 % of
    the path of its behaviour around the planned position. Planned and performed motion are judged by the same rule
    and compared, so that the ball's own size does not count as being early.

    Args:
        plan: what was planned.
        times: (m,) [s] performance time of the samples.
        reference: paths of the plan.
        performed: paths as performed.

    Returns:
        Seconds per sync point of a moving behaviour; None where the part never arrives.
    """
    found: dict[SyncTime, float | None] = {}
    spans, zero = _spans(plan.syncs), plan.trajectory.zero
    ways = {part: _way(path) for part, path in reference.items()}
    instants: list[float] = times.tolist()  # plain numbers are looked up faster

    @cache
    def lag(part: PartName, at: float, radius: float) -> float | None:  # many sync points are at the same time
        return _lag(at, instants, reference[part], performed[part], radius)

    for sync in plan.syncs:
        begin, end = times.searchsorted([zero + time for time in spans[sync.behaviour]])
        late = []
        for part in sorted(plan.keyframes.uses.get(sync.behaviour, frozenset())):
            length = float(ways[part][min(end, len(times) - 1)] - ways[part][begin])
            if length > 0.0:
                radius = max(LEAST_BALL if part in HANDS else LEAST_CONE, SHARE * length)
                late.append(lag(part, zero + sync.planned, radius))
        if late:
            known = [lag for lag in late if lag is not None]
            found[sync] = max(known, key=abs) if len(known) == len(late) else None
    return found


def _spans(syncs: tuple[SyncTime, ...]) -> dict[str, tuple[float, float]]:
    """First and last planned time of each behaviour."""
    spans: dict[str, tuple[float, float]] = {}
    for sync in syncs:
        low, high = spans.get(sync.behaviour, (sync.planned, sync.planned))
        spans[sync.behaviour] = (min(low, sync.planned), max(high, sync.planned))
    return spans


def _lag(at: float, times: Sequence[float], reference: Floats, performed: Floats, radius: float) -> float | None:
    """How much later a path enters the ball around the planned position at a time [s]."""
    centre = _place(at, times, reference)
    planned = _entry(at, times, reference, centre, radius)
    arrived = _entry(at, times, performed, centre, radius)
    return None if planned is None or arrived is None else arrived - planned


def _place(at: float, times: Sequence[float], path: Floats) -> Floats:
    """(d,) where a path is at a time, between samples by linear interpolation."""
    after = min(bisect_right(times, at), len(times) - 1)
    before = max(after - 1, 0)
    span = times[after] - times[before]
    share = min(max((at - times[before]) / span, 0.0), 1.0) if span > 0.0 else 0.0
    place: Floats = path[before] + share * (path[after] - path[before])
    return place


def _entry(at: float, times: Sequence[float], path: Floats, centre: Floats, radius: float) -> float | None:
    """First time [s] within the window that a path is inside a ball, between samples by linear interpolation."""
    begin = bisect_left(times, at - WINDOW)
    apart = path[begin : bisect_left(times, at + WINDOW)] - centre
    distance = np.sqrt(np.vecdot(apart, apart))
    inside = distance <= radius
    if not inside.any():
        return None
    first = int(inside.argmax())
    if first == 0:
        return times[begin]
    outer, inner = distance[first - 1 : first + 1].tolist()
    before, after = times[begin + first - 1], times[begin + first]
    return float(before + (outer - radius) / (outer - inner) * (after - before))


def _way(path: Floats) -> Floats:
    """(m,) how far a path has come."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
