"""Finds when a part of the body arrives where a sync point wants it, by one rule for plan, twin and sensors."""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, PartName, Robot
from kinesic.kernels import Kernel, find_kernel
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SyncTime, planned_spans
from kinesic.sim.kinematics import body_frames

KERNEL: Kernel = find_kernel("kinesic.controller._kernel")  # which implementation runs

if KERNEL == "compiled":
    from kinesic.controller import _kernel

HANDS: tuple[PartName, PartName] = ("l_hand", "r_hand")
ENTRY_WINDOW = 0.3  # [s] before and after the planned time
LEAST_BALL = 0.005  # [m]
LEAST_CONE = np.radians(0.5)  # [rad] the ball's like for head and torso
SHARE = 0.05  # of the path
SHORTEST = 1e-3  # [s] of a step that has a speed
POSTURES_PER_WINDOW = 1024  # postures whose frames are looked at together


def part_paths(angles: Floats, robot: Robot, hands: Mapping[str, Floats] | None = None) -> Mapping[PartName, Floats]:
    """Follows each part along a motion: hands (m, 3) [m] in the world, head and torso (m, 3) [rad].

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
    hands, wrists = np.empty((len(SIDES), len(angles), 3)), [robot.arm(side).wrist for side in SIDES]
    for begin in range(0, len(angles), POSTURES_PER_WINDOW):
        rows = slice(begin, begin + POSTURES_PER_WINDOW)
        hands[:, rows] = body_frames(robot, angles[rows]).origins[wrists].transpose(0, 2, 1)
    return dict(zip(SIDES, hands, strict=True))


@dataclass(frozen=True, eq=False)
class Arrival:
    """Place of a part at a sync point, and when the plan itself comes near enough."""

    part: PartName
    at: float  # [s] performance time
    place: Floats  # (d,) [m] of a hand, [rad] of head and torso
    radius: float  # [m] or [rad] about the place
    planned: float | None  # [s] when the plan enters


def arrivals(plan: Plan, times: Floats, reference: Mapping[PartName, Floats]) -> Mapping[SyncTime, tuple[Arrival, ...]]:
    """Works out where the sync points of moving behaviours want their parts.

    A part arrives when it first enters, within a window about the planned time, a ball of 5 mm or 5 % of the path of
    its behaviour around the planned position.

    Args:
        plan: what was planned.
        times: (m,) [s] performance time of the samples.
        reference: paths of the plan.
    """
    spans = planned_spans((sync.behaviour, sync.planned) for sync in plan.syncs)
    zero = plan.trajectory.zero
    ways = {part: _way(path) for part, path in reference.items()}
    instants: list[float] = times.tolist()  # plain numbers are looked up faster

    @cache
    def arrival(part: PartName, at: float, radius: float) -> Arrival:  # many sync points are at the same time
        place = _place(at, instants, reference[part])
        return Arrival(part, at, place, radius, _first_entry(at, times, reference[part], place, radius))

    found: dict[SyncTime, tuple[Arrival, ...]] = {}
    edges = times.searchsorted(np.reshape([spans[sync.behaviour] for sync in plan.syncs], (-1, 2)) + zero)
    for sync, (begin, end) in zip(plan.syncs, np.minimum(edges, len(times) - 1).tolist(), strict=True):
        parts = []
        for part in sorted(plan.keyframes.uses.get(sync.behaviour, frozenset())):
            length = float(ways[part][end] - ways[part][begin])
            if length > 0.0:
                radius = max(LEAST_BALL if part in HANDS else LEAST_CONE, SHARE * length)
                parts.append(arrival(part, zero + sync.planned, radius))
        if parts:
            found[sync] = tuple(parts)
    return found


def lags(
    wanted: Mapping[SyncTime, tuple[Arrival, ...]], times: Floats, performed: Mapping[PartName, Floats]
) -> dict[SyncTime, float | None]:
    """Computes how much later than planned [s] the body arrives at each sync point.

    Planned and performed motion are judged by the same rule and compared, so that the ball's own size does not count
    as being early.

    Args:
        wanted: by the plan.
        times: (m,) [s] performance time of the samples.
        performed: paths as performed.

    Returns:
        Seconds per sync point of a moving behaviour; None where the part never arrives.
    """

    @cache
    def lag(arrival: Arrival) -> float | None:
        entered = _first_entry(arrival.at, times, performed[arrival.part], arrival.place, arrival.radius)
        return None if entered is None or arrival.planned is None else entered - arrival.planned

    found: dict[SyncTime, float | None] = {}
    for sync, parts in wanted.items():
        late = [lag(arrival) for arrival in parts]
        known = [seconds for seconds in late if seconds is not None]
        found[sync] = max(known, key=abs) if len(known) == len(late) else None
    return found


def _place(at: float, times: Sequence[float], path: Floats) -> Floats:
    """(d,) where a path is at a time, between samples by linear interpolation."""
    after = min(bisect_right(times, at), len(times) - 1)
    before = max(after - 1, 0)
    span = times[after] - times[before]
    share = min(max((at - times[before]) / span, 0.0), 1.0) if span > 0.0 else 0.0
    place: Floats = path[before] + share * (path[after] - path[before])
    return place


def _first_entry(at: float, times: Floats, path: Floats, centre: Floats, radius: float) -> float | None:
    """First time [s] within the window at which a path is inside a ball."""
    if KERNEL == "compiled":
        return _kernel.first_entry(times, np.ascontiguousarray(path), at, ENTRY_WINDOW, centre, radius)
    window = slice(*times.searchsorted([at - ENTRY_WINDOW, at + ENTRY_WINDOW]))
    apart = path[window] - centre
    return entry(times[window].tolist(), np.sqrt(np.vecdot(apart, apart)), radius)


def entry(times: Sequence[float], distances: Floats, radius: float, *, last: bool = False) -> float | None:
    """Finds when a path enters a ball, between samples by linear interpolation.

    Args:
        times: (m,) [s].
        distances: (m,) from the ball's centre.
        radius: of the ball, in the same unit.
        last: the last time at which it enters, not the first.

    Returns:
        [s]; the first sample's time where the path is inside from the beginning, None where it is never.
    """
    inside = np.flatnonzero(distances <= radius)
    if not len(inside):
        return None
    after = int(inside[0])
    if last:
        outside = np.flatnonzero(distances[: inside[-1]] > radius)
        after = int(outside[-1]) + 1 if len(outside) else 0
    if after == 0:
        return times[0]
    outer, inner = distances[after - 1 : after + 1].tolist()
    return float(times[after - 1] + (outer - radius) / (outer - inner) * (times[after] - times[after - 1]))


def _way(path: Floats) -> Floats:
    """(m,) how far a path has come."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])


def measure_stretch(times: Floats, path: Floats, begin: float, end: float) -> tuple[float, float]:
    """Measures the largest speed on a part of a path, and the part's length; between samples it is straight.

    Args:
        times: (m,) [s] of the samples.
        path: (m, d).
        begin: [s].
        end: [s].
    """
    if KERNEL == "compiled":
        return _kernel.measure_stretch(times, np.ascontiguousarray(path), begin, end)
    first, last = times.searchsorted(begin, side="right"), times.searchsorted(end)
    places = np.stack([[np.interp(moment, times, column) for column in path.T] for moment in (begin, end)])
    steps = np.diff(np.concatenate([[begin], times[first:last], [end]]))
    ways = np.diff(np.concatenate([places[:1], path[first:last], places[1:]]), axis=0)
    distances = np.sqrt(np.vecdot(ways, ways))
    speeds = np.divide(distances, steps, out=np.zeros_like(steps), where=steps > SHORTEST)
    return float(speeds.max(initial=0.0)), float(distances.sum())
