"""Arrival times of hands, head and torso at sync points."""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from kinesic._kernel import metrics as kernel
from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, PartName, Robot
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SyncTime, find_planned_spans
from kinesic.sim.kinematics import body_frames

HAND_PARTS: tuple[PartName, PartName] = ("l_hand", "r_hand")  # body parts whose arrival is measured by position
ENTRY_WINDOW = 0.3  # [s] time before and after the planned arrival in which the measured arrival is searched
MIN_ARRIVAL_RADIUS = 0.005  # [m] smallest radius of a hand's target ball
MIN_ARRIVAL_ANGLE = np.radians(0.5)  # [rad] smallest radius of the target region of head and torso
ARRIVAL_PATH_FRACTION = 0.05  # radius of the target ball, relative to the path length of the behaviour
POSTURES_PER_WINDOW = 1024  # postures evaluated at once; more need more memory


def compute_part_paths(
    angles: Floats, robot: Robot, hands: Mapping[str, Floats] | None = None
) -> Mapping[PartName, Floats]:
    """Return wrist positions and head and torso joint angles along a motion.

    Args:
        angles: (m, n) [rad].
        robot: the robot.
        hands: hand paths "l", "r" -> (m, 3) [m], if they are available.

    Returns:
        Hands (m, 3) [m] in the world, head and torso (m, 3) [rad].
    """
    hand_paths = hands or _hands(angles, robot)
    return {
        "l_hand": hand_paths["l"],
        "r_hand": hand_paths["r"],
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
    """Target region and planned arrival time of a body part."""

    part: PartName
    at: float  # [s] performance time
    place: Floats  # (d,) [m] of a hand, [rad] of head and torso
    radius: float  # [m] or [rad] around the place
    planned: float | None  # [s] planned arrival; None: never


def find_arrivals(
    plan: Plan, times: Floats, reference: Mapping[PartName, Floats]
) -> Mapping[SyncTime, tuple[Arrival, ...]]:
    """Find body parts' target regions and planned arrivals at each sync point.

    A part arrives when it first enters a ball around the planned position, within a window around the planned time. The
    radius is 5 mm (0.5 deg for head and torso) or 5 % of the path of the behaviour, whichever is larger.

    Args:
        plan: with the sync points.
        times: (m,) [s] performance time of the samples.
        reference: planned paths of the parts.
    """
    spans = find_planned_spans((sync.behaviour, sync.planned) for sync in plan.syncs)
    zero = plan.trajectory.zero
    lengths = {part: _compute_travel(path) for part, path in reference.items()}
    time_list: list[float] = times.tolist()  # bisection in a list of floats is faster

    @cache
    def arrival(part: PartName, at: float, radius: float) -> Arrival:  # many sync points share a time
        place = _interpolate(at, time_list, reference[part])
        return Arrival(part, at, place, radius, _find_first_entry(at, times, reference[part], place, radius))

    arrivals_by_sync: dict[SyncTime, tuple[Arrival, ...]] = {}
    edges = times.searchsorted(np.reshape([spans[sync.behaviour] for sync in plan.syncs], (-1, 2)) + zero)
    for sync, (begin, end) in zip(plan.syncs, np.minimum(edges, len(times) - 1).tolist(), strict=True):
        arrivals = []
        for part in sorted(plan.keyframes.uses.get(sync.behaviour, frozenset())):
            length = float(lengths[part][end] - lengths[part][begin])
            if length > 0.0:
                min_radius = MIN_ARRIVAL_RADIUS if part in HAND_PARTS else MIN_ARRIVAL_ANGLE
                radius = max(min_radius, ARRIVAL_PATH_FRACTION * length)
                arrivals.append(arrival(part, zero + sync.planned, radius))
        if arrivals:
            arrivals_by_sync[sync] = tuple(arrivals)
    return arrivals_by_sync


def measure_arrival_lags(
    targets: Mapping[SyncTime, tuple[Arrival, ...]], times: Floats, performed: Mapping[PartName, Floats]
) -> dict[SyncTime, float | None]:
    """Measure the body parts' largest arrival delay at each sync point [s].

    Planned and performed motion are compared by the same rule, so that the size of the ball does not count as early.

    Args:
        targets: of the sync points.
        times: (m,) [s] performance time of the samples.
        performed: performed paths of the parts.

    Returns:
        Lag per sync point of a moving behaviour; None if a part never arrives.
    """

    @cache
    def lag(arrival: Arrival) -> float | None:
        entered = _find_first_entry(arrival.at, times, performed[arrival.part], arrival.place, arrival.radius)
        return None if entered is None or arrival.planned is None else entered - arrival.planned

    lags_by_sync: dict[SyncTime, float | None] = {}
    for sync, arrivals in targets.items():
        lags = [lag(arrival) for arrival in arrivals]
        measured_lags = [seconds for seconds in lags if seconds is not None]
        lags_by_sync[sync] = max(measured_lags, key=abs) if len(measured_lags) == len(lags) else None
    return lags_by_sync


def _interpolate(at: float, times: Sequence[float], path: Floats) -> Floats:
    """Interpolate a path (m, d) at one time [s]."""
    after = min(bisect_right(times, at), len(times) - 1)
    before = max(after - 1, 0)
    span = times[after] - times[before]
    fraction = min(max((at - times[before]) / span, 0.0), 1.0) if span > 0.0 else 0.0
    place: Floats = path[before] + fraction * (path[after] - path[before])
    return place


def _find_first_entry(at: float, times: Floats, path: Floats, centre: Floats, radius: float) -> float | None:
    """Return a path's first entry time [s] into a ball, or None.

    Only times within `ENTRY_WINDOW` of `at` are searched.
    """
    return kernel.first_entry(times, np.ascontiguousarray(path), at, ENTRY_WINDOW, centre, radius)


def find_entry(times: Sequence[float], distances: Floats, radius: float, *, last: bool = False) -> float | None:
    """Find when a path first or last enters a ball.

    The distance is interpolated linearly between samples.

    Args:
        times: (m,) [s].
        distances: (m,) from the centre of the ball.
        radius: of the ball, in the unit of the distances.
        last: return the last entry instead of the first.

    Returns:
        [s]; the first sample's time if the path begins inside; None if it never enters.
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


def _compute_travel(path: Floats) -> Floats:
    """Compute the path length travelled until each sample, (m,)."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])


def measure_stretch(times: Floats, path: Floats, begin: float, end: float) -> tuple[float, float]:
    """Measure the peak speed and the length of a path section.

    The path is linearly interpolated between samples.

    Args:
        times: (m,) [s] of the samples.
        path: (m, d).
        begin: [s].
        end: [s].
    """
    return kernel.measure_stretch(times, np.ascontiguousarray(path), begin, end)
