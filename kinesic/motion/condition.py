"""Conditioning: fit of motions through key postures to the servos' limits.

The result keeps position, velocity, acceleration, jerk and duty at every instant, and passes every exact key at its
planned time. The first step shifts these keys as little as possible, until every hinge can pass them. The second step
finds the path nearest to the desired one. Keys on a path of a hand only shape the desired motion; paths that are too
fast become smaller.
"""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Floats, seal_in_place, sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import grid
from kinesic.motion.budget import UNLIMITED_BUDGET, Budget
from kinesic.motion.desired import DesiredMotion, join_keys
from kinesic.motion.infeasibility import Bottleneck
from kinesic.motion.key_times import KeyTimeSearch
from kinesic.motion.keys import Bond, KeyPosture, Keys, Pair
from kinesic.motion.plane_memory import PlaneMemory
from kinesic.motion.segments import SplineSegment, pieces
from kinesic.motion.spline_program import can_pass, find_free_motion, nearest_within_limits
from kinesic.motion.trajectory import KNOT_INTERVAL, SAMPLES_PER_WINDOW, Trajectory

LEAD_IN = 0.6  # [s] longest time by which a motion may start before its block


MakeDesired = Callable[[Floats, Keys], DesiredMotion]  # function of times (m,) [s] and the keys at these times


@dataclass(frozen=True, eq=False)
class Conditioned:
    """Motion within the limits, with shifted key times."""

    trajectory: Trajectory
    requested_times: Floats  # (m,) [s] requested block times of the keys
    planned: Floats  # (m,) [s] planned block times of the keys
    bottlenecks: Mapping[Pair, Bottleneck]  # most violated limit at the requested times, by pair of keys
    rms_distances: Floats  # (n,) [rad] root mean square distance from the desired motion at the planned times

    def bottleneck_near(self, time: float, hinges: Collection[int]) -> Bottleneck | None:
        """Return the bottleneck nearest to a requested time [s], or None.

        Of equally near ones, one of the given hinges is preferred.
        """
        bottlenecks, (begins, ends) = self._bottleneck_times
        if not bottlenecks:
            return None
        distances = np.maximum(np.maximum(begins - time, time - ends), 0.0)
        nearest = [bottlenecks[k] for k in np.flatnonzero(distances == distances.min())]
        return next((bottleneck for bottleneck in nearest if bottleneck.hinge in hinges), nearest[0])

    @cached_property
    def _bottleneck_times(self) -> tuple[list[Bottleneck], Floats]:
        """Bottlenecks, and the requested times (2, k) [s] of their key pairs."""
        pairs = np.array([*self.bottlenecks], dtype=np.intp).reshape(-1, 2)
        return [*self.bottlenecks.values()], self.requested_times[pairs.T]


def condition(
    postures: tuple[KeyPosture, ...],
    limits: Limits,
    *,
    bonds: tuple[Bond, ...] = (),
    lead_in: float = LEAD_IN,
    limit_scale: float = 1.0,
    make_desired: MakeDesired = join_keys,
    budget: Budget = UNLIMITED_BUDGET,
    memory: PlaneMemory | None = None,
) -> Conditioned:
    """Shift key times minimally, then approximate the desired motion within limits.

    Args:
        postures: at least two, the first and the last keyed in all hinges.
        limits: of position, velocity, acceleration, jerk and duty.
        bonds: between sync points of different behaviours.
        lead_in: [s] by which the first key may come earlier.
        limit_scale: fraction of the limits used for key times; below 1 the motion has time to stay nearer to the
            desired one.
        make_desired: function that returns the desired motion, of which only the angles are used.
        budget: for the search of key times; once spent, hinges stop at the keys of infeasible segments.
        memory: cutting planes of earlier searches for the same hinges, updated by this one.

    Raises:
        ArithmeticError: a hinge cannot move within its limits, however slowly.
    """
    keys = Keys.of(postures, limits, bonds)
    reduced_limits = limits.scaled(limit_scale)
    search, finder = (
        KeyTimeSearch(keys, reduced_limits, lead_in, budget, memory),
        NearestFinder(keys, limits, make_desired),
    )
    reduced_finder = NearestFinder(keys, reduced_limits, make_desired) if limit_scale < 1.0 else None

    def find() -> tuple[Floats, Floats] | SplineSegment:
        """Return desired and nearest motion at current times, or an infeasible segment.

        A motion within the reduced limits must exist at these times.
        """
        infeasible = reduced_finder.find_infeasible(search.times) if reduced_finder else None
        return finder.find(search.times) if infeasible is None else infeasible

    while isinstance(result := find(), SplineSegment):
        search.resolve(result)  # ends, as a hinge stops at its keys after some tries
    search.store_planes()
    desired, controls = result
    motion = Trajectory(seal_in_place(controls), -float(search.times[0]))
    return Conditioned(
        motion, keys.requested_times, sealed(search.times), search.bottlenecks, _distance(motion, desired)
    )


def _distance(motion: Trajectory, desired: Floats) -> Floats:
    """Return the RMS distance of each hinge to a desired motion.

    Of shape (n,) [rad], for desired angles (k + 1, n) [rad] at the knots.
    """
    knots, sums = grid(len(desired) - 1, KNOT_INTERVAL).knots, np.zeros((1, desired.shape[1]))
    for begin in range(0, len(desired), SAMPLES_PER_WINDOW):
        rows = slice(begin, begin + SAMPLES_PER_WINDOW)
        errors = motion.sample(knots[rows])[0] - desired[rows]
        sums = np.concatenate([sums, errors**2]).sum(axis=0, keepdims=True)  # row by row, as if it were one block
    return sealed(np.sqrt(sums[0] / len(desired)))


class NearestFinder:
    """Solver for the motion nearest to a desired one within limits.

    It caches segments, most of which stay the same when key times move.
    """

    def __init__(self, keys: Keys, limits: Limits, make_desired: MakeDesired) -> None:
        """Create the solver with an empty cache.

        Args:
            keys: of the motion.
            limits: of all hinges.
            make_desired: function that returns the desired motion at key times.
        """
        self._keys, self._limits, self._make_desired = keys, limits, make_desired
        self._solved: dict[tuple[object, ...], Floats] = {}  # control points by segment and desired motion
        self._feasible: set[tuple[object, ...]] = set()  # the same keys, with motions not yet computed

    def find(self, times: Floats) -> tuple[Floats, Floats] | SplineSegment:
        """Return desired angles and nearest control points, or an infeasible segment.

        The desired motion has shape (k + 1, n) [rad] at the knots, the control points (k + 3, n) [rad]. Segments
        farther beyond the limits are solved first.
        """
        desired, controls, exceeding = self._solve_without_limits(times)
        for segment, segment_desired in exceeding:
            limited = self._solve_within_limits(segment, segment_desired)
            if limited is None:
                return segment
            controls[segment.controls, segment.hinge] = limited
        return desired, controls

    def find_infeasible(self, times: Floats) -> SplineSegment | None:
        """Return an infeasible segment or None, without computing the motion."""
        _, _, exceeding = self._solve_without_limits(times)
        return next((segment for segment, desired in exceeding if not self._can_pass(segment, desired)), None)

    def _solve_without_limits(self, times: Floats) -> tuple[Floats, Floats, list[tuple[SplineSegment, Floats]]]:
        """Return the desired motion, its spline without limits, and segments beyond limits."""
        desired = self._make_desired(times, self._keys).angles(grid(pieces(times, KNOT_INTERVAL), KNOT_INTERVAL).knots)
        controls, exceeding = find_free_motion(times, self._keys, self._limits, desired)
        ordered = [segment for _, segment in sorted(exceeding, key=lambda pair: -pair[0])]
        return desired, controls, [(segment, desired[segment.knots, segment.hinge]) for segment in ordered]

    def _solve_within_limits(self, segment: SplineSegment, desired: Floats) -> Floats | None:
        cache_key = _make_cache_key(segment, desired)
        if cache_key not in self._solved:
            controls = nearest_within_limits(segment, desired, self._limits)
            if controls is None:
                return None
            self._solved[cache_key] = controls
        return self._solved[cache_key]

    def _can_pass(self, segment: SplineSegment, desired: Floats) -> bool:
        cache_key = _make_cache_key(segment, desired)
        if cache_key not in self._feasible and can_pass(segment, desired, self._limits):
            self._feasible.add(cache_key)
        return cache_key in self._feasible


def _make_cache_key(segment: SplineSegment, desired: Floats) -> tuple[object, ...]:
    """Return the cache key of a segment with its desired motion."""
    return segment.hinge, segment.marks, segment.grid.pieces, segment.places.tobytes(), desired.tobytes()
