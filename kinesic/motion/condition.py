"""Conditions a motion for the servos: first as asked, then with sync points moved as little as needed.

What is returned keeps position, speed, acceleration, jerk and duty at every instant, and passes every firm key at its
exact time. First the least shift of these keys with which every hinge has a way through them, whatever its path; then
the path that is nearest to the desired one. Keys on a path of a hand only shape what is desired: what is too fast
becomes smaller.
"""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Floats, seal_own, sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import grid
from kinesic.motion.budget import ENDLESS, Budget
from kinesic.motion.desired import DesiredMotion, join_keys
from kinesic.motion.infeasibility import Bottleneck
from kinesic.motion.key_times import Search
from kinesic.motion.keys import Bond, KeyPosture, Keys, Pair
from kinesic.motion.plane_memory import PlaneMemory
from kinesic.motion.segments import SplineSegment, pieces
from kinesic.motion.spline_program import can_pass, find_free_motion, nearest_within_limits
from kinesic.motion.trajectory import SAMPLES_PER_WINDOW, STEP, Trajectory

LEAD_IN = 0.6  # [s] by which the motion may begin before it is asked to


MakeDesired = Callable[[Floats, Keys], DesiredMotion]  # from times (m,) [s] and the keys that are passed at them


@dataclass(frozen=True, eq=False)
class Conditioned:
    """A motion within limits, and what had to give."""

    trajectory: Trajectory
    asked: Floats  # (m,) [s] block time of the keys as asked
    planned: Floats  # (m,) [s] block time of the keys as they will be
    bottlenecks: Mapping[Pair, Bottleneck]  # what was too fast as asked, between which keys
    lost: Floats  # (n,) [rad] root mean square distance from the desired motion at the planned times

    def bottleneck_near(self, time: float, hinges: Collection[int]) -> Bottleneck | None:
        """Finds the limit that was met nearest to an asked time [s], at best by one of some hinges."""
        found, (begins, ends) = self._met
        if not found:
            return None
        away = np.maximum(np.maximum(begins - time, time - ends), 0.0)
        nearest = [found[k] for k in np.flatnonzero(away == away.min())]
        return next((met for met in nearest if met.hinge in hinges), nearest[0])

    @cached_property
    def _met(self) -> tuple[list[Bottleneck], Floats]:
        """What was too fast, and (2, k) [s] between which asked times."""
        pairs = np.array([*self.bottlenecks], dtype=np.intp).reshape(-1, 2)
        return [*self.bottlenecks.values()], self.asked[pairs.T]


def condition(
    postures: tuple[KeyPosture, ...],
    limits: Limits,
    *,
    bonds: tuple[Bond, ...] = (),
    lead_in: float = LEAD_IN,
    ease: float = 1.0,
    make_desired: MakeDesired = join_keys,
    budget: Budget = ENDLESS,
    memory: PlaneMemory | None = None,
) -> Conditioned:
    """Conditions key postures into the nearest motion within the limits.

    Args:
        postures: at least two, the first and the last keyed in all hinges.
        limits: of position, speed, acceleration, jerk and duty.
        bonds: between sync points of different behaviours.
        lead_in: [s] by which the first key may come earlier.
        ease: share of the limits for key times; below 1 there is time to stay nearer to the desired motion.
        make_desired: the desired motion, of which only the angles are used.
        budget: for the search of key times; hinges rest at their keys where it is spent.
        memory: of what earlier searches found out about the same hinges; it is left what this one found.

    Raises:
        ArithmeticError: a hinge cannot move within its limits, however slowly.
    """
    keys = Keys.of(postures, limits, bonds)
    eased = limits.times(ease)
    search, finder = Search(keys, eased, lead_in, budget, memory), NearestFinder(keys, limits, make_desired)
    eased_finder = NearestFinder(keys, eased, make_desired) if ease < 1.0 else None

    def find() -> tuple[Floats, Floats] | SplineSegment:
        """The motion at the times so far, once they have room for one within the eased limits; else what has none."""
        lost = eased_finder.find_lost(search.times) if eased_finder else None
        return finder.find(search.times) if lost is None else lost

    while isinstance(found := find(), SplineSegment):
        search.avoid(found)  # ends: after some tries for a segment its hinge rests at its keys, in the end ever longer
    search.remember()
    desired, controls = found
    motion = Trajectory(seal_own(controls), -float(search.times[0]))
    return Conditioned(motion, keys.asked, sealed(search.times), search.met, _distance(motion, desired))


def _distance(motion: Trajectory, desired: Floats) -> Floats:
    """(n,) [rad] root mean square distance from a desired motion (k + 1, n) [rad] at the knots."""
    knots, sums = grid(len(desired) - 1, STEP).knots, np.zeros((1, desired.shape[1]))
    for begin in range(0, len(desired), SAMPLES_PER_WINDOW):
        rows = slice(begin, begin + SAMPLES_PER_WINDOW)
        away = motion.sample(knots[rows])[0] - desired[rows]
        sums = np.concatenate([sums, away**2]).sum(axis=0, keepdims=True)  # row by row, as if it were one block
    return sealed(np.sqrt(sums[0] / len(desired)))


class NearestFinder:
    """Finds the motions that are nearest to a desired one, and remembers those of segments that stay as they are."""

    def __init__(self, keys: Keys, limits: Limits, make_desired: MakeDesired) -> None:
        """Begins without any.

        Args:
            keys: of the motion.
            limits: of all hinges.
            make_desired: the desired motion at some times.
        """
        self._keys, self._limits, self._make_desired = keys, limits, make_desired
        self._known: dict[tuple[object, ...], Floats] = {}
        self._passed: set[tuple[object, ...]] = set()  # segments that have a motion, which nobody has computed

    def find(self, times: Floats) -> tuple[Floats, Floats] | SplineSegment:
        """The desired motion (k + 1, n) [rad] at the knots, and the nearest one's control points (k + 3, n) [rad].

        Or else the first segment that has none. The farther a segment is beyond the limits, the earlier its turn.
        """
        desired, controls, beyond = self._without_limits(times)
        for segment, own in beyond:
            found = self._within_limits(segment, own)
            if found is None:
                return segment
            controls[segment.controls, segment.hinge] = found
        return desired, controls

    def find_lost(self, times: Floats) -> SplineSegment | None:
        """Finds the first segment that has no motion within the limits, in less time than `find` takes."""
        _, _, beyond = self._without_limits(times)
        return next((segment for segment, own in beyond if not self._can_pass(segment, own)), None)

    def _without_limits(self, times: Floats) -> tuple[Floats, Floats, list[tuple[SplineSegment, Floats]]]:
        """The desired motion, the nearest one without limits, and what of it exceeds them, with its desired angles."""
        desired = self._make_desired(times, self._keys).angles(grid(pieces(times, STEP), STEP).knots)
        controls, beyond = find_free_motion(times, self._keys, self._limits, desired)
        every = [segment for _, segment in sorted(beyond, key=lambda pair: -pair[0])]
        return desired, controls, [(segment, desired[segment.knots, segment.hinge]) for segment in every]

    def _within_limits(self, segment: SplineSegment, desired: Floats) -> Floats | None:
        given = _cache_key(segment, desired)
        if given not in self._known:
            found = nearest_within_limits(segment, desired, self._limits)
            if found is None:
                return None
            self._known[given] = found
        return self._known[given]

    def _can_pass(self, segment: SplineSegment, desired: Floats) -> bool:
        given = _cache_key(segment, desired)
        if given not in self._passed and can_pass(segment, desired, self._limits):
            self._passed.add(given)
        return given in self._passed


def _cache_key(segment: SplineSegment, desired: Floats) -> tuple[object, ...]:
    """Makes a key of all that the motion of a segment depends on, beside the limits."""
    return segment.hinge, segment.marks, segment.grid.pieces, segment.places.tobytes(), desired.tobytes()
