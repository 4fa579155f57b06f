"""When a part of the body arrives where a sync point wants it, by one rule for plan and twin."""

from collections.abc import Mapping

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.robot import SIDES, Robot
from kinesic.controller.plan import Plan
from kinesic.controller.syncs import SyncTime
from kinesic.expressivity.keyframes import PartName

WINDOW = 0.3  # [s] before and after the planned time
LEAST_BALL = 0.005  # [m]
LEAST_CONE = np.radians(0.5)  # [rad] the ball's like for head and torso
SHARE = 0.05  # of the path


def paths(angles: Floats, robot: Robot) -> Mapping[PartName, Floats]:
    """Where each part is along a motion: hands (m, 3) [m] in the world, head and torso (m, 3) [rad]."""
    origins = robot.skeleton.frames(angles).origins
    wrists = {side: robot.skeleton.segment(robot.chains[f"{side}_arm"][-1]) for side in SIDES}
    return {
        "l_hand": origins[:, wrists["l"]],
        "r_hand": origins[:, wrists["r"]],
        "head": angles[:, list(robot.joints("neck"))],
        "torso": angles[:, list(robot.joints("torso"))],
    }


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
    spans = _spans(plan.syncs)
    for sync in plan.syncs:
        parts = plan.keyframes.uses.get(sync.behaviour, frozenset())
        begin, end = (plan.trajectory.zero + time for time in spans[sync.behaviour])
        inside = (times >= begin) & (times <= end)
        moving = [part for part in sorted(parts) if _length(reference[part][inside]) > 0.0]
        if not moving:
            continue
        late = [_lag(part, plan.trajectory.zero + sync.planned, times, inside, reference, performed) for part in moving]
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


def _lag(
    part: PartName,
    at: float,
    times: Floats,
    inside: Flags,
    reference: Mapping[PartName, Floats],
    performed: Mapping[PartName, Floats],
) -> float | None:
    least = LEAST_BALL if part in ("l_hand", "r_hand") else LEAST_CONE
    radius = max(least, SHARE * _length(reference[part][inside]))
    centre = np.array([np.interp(at, times, column) for column in reference[part].T])
    planned = _entry(at, times, reference[part], centre, radius)
    arrived = _entry(at, times, performed[part], centre, radius)
    return None if planned is None or arrived is None else arrived - planned


def _entry(at: float, times: Floats, path: Floats, centre: Floats, radius: float) -> float | None:
    """First time [s] within the window that a path is inside a ball, between samples by linear interpolation."""
    near = np.flatnonzero((times >= at - WINDOW) & (times <= at + WINDOW))
    distance = np.linalg.norm(path[near] - centre, axis=1)
    inside = np.flatnonzero(distance <= radius)
    if not len(inside):
        return None
    first = int(inside[0])
    if first == 0:
        return float(times[near[0]])
    share = (distance[first - 1] - radius) / (distance[first - 1] - distance[first])
    return float(times[near[first - 1]] + share * (times[near[first]] - times[near[first - 1]]))


def _length(path: Floats) -> float:
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
