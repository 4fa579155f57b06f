"""Finds key times at which every hinge can pass its keys, as near to the asked ones as possible.

A linear program moves key times as little as needed, strokes least of all. The least time of a hinge from one key to
the next is that of its full speed; the time with a rest at both is always enough. Times that are too short for some
hinge are cut off by a plane, its shortage linearised, and the program is solved again (Kelley, The cutting-plane
method, 1960). What a hinge lacks is nearly convex in the logarithm of its time, so that a few planes suffice; where
they do not, the hinge rests at each of its keys, which is always possible.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import scipy

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.motion.double_s import least_rest_times
from kinesic.motion.infeasibility import Infeasibility, Quantity, guess_share, measure_shortage
from kinesic.motion.keys import SAME, Keys, Pair
from kinesic.motion.segments import SplineSegment, segments
from kinesic.motion.trajectory import STEP

Gaps = Mapping[tuple[int, Pair], float]  # hinge, two of its keys -> [s]

LATENESS = 3.0  # weight of being late over being early
BROKEN = 50.0  # weight of a bond that cannot be kept, per second
UNMOVED = 1e-7  # [s]
RESERVE = 1.02  # on durations from rest to rest
GRID = 0.04  # [s] that the grid may cost
PLANES = 40  # of a hinge before it rests at its keys
MARGIN = 0.002  # of the time, kept so that a motion is found quickly
LONGER = 1.1  # on rests that do not suffice after all
LONGEST = 100.0  # times as long as a rest should suffice, before nothing does
ROUGH = 1.3  # share of a limit on a smooth way that makes a segment suspect
FLAT = 0.1  # [1/s] slopes that lead nowhere
NEAR = 0.02  # share of the time within which a segment is looked at again


@dataclass(frozen=True, eq=False)
class CuttingPlane:
    """Times t with slopes @ t > bound are too short for some hinge."""

    slopes: Floats  # (m,) [1/s]
    bound: float


def relax_key_times(
    keys: Keys, gaps: Mapping[Pair, float], lead_in: float, cuts: Sequence[CuttingPlane] = ()
) -> Floats:
    """Finds the key times that are nearest to the asked ones under gaps, cuts and bonds.

    Variables are t (m,), lateness e+ and earliness e- (m,) with t - asked = e+ - e-, and what each bond lacks.

    Args:
        keys: what was asked, with its bonds.
        gaps: least time [s] from one key to another.
        lead_in: [s] by which the first key may come earlier.
        cuts: that exclude other times; gaps alone can always be kept.

    Returns:
        (m,) [s] block time.

    Raises:
        ArithmeticError: the cuts leave no times.
    """
    count, ties = len(keys.asked), len(keys.bonds)
    pairs = [*gaps, *keys.bonds]
    rows = np.zeros((len(pairs) + len(cuts), 3 * count + ties))
    for row, (i, j) in enumerate(pairs):
        rows[row, i], rows[row, j] = 1.0, -1.0
    for row, cut in enumerate(cuts, len(pairs)):
        rows[row, :count] = cut.slopes
    rows[len(gaps) : len(pairs), 3 * count :] = -np.eye(ties)
    least = np.array([*gaps.values(), *keys.bonds.values()])
    one = np.eye(count)
    result = scipy.optimize.linprog(
        np.concatenate([np.zeros(count), LATENESS * keys.weights, keys.weights, np.full(ties, BROKEN)]),
        A_ub=rows,
        b_ub=np.append(-least, [cut.bound for cut in cuts]),
        A_eq=np.hstack([one, -one, one, np.zeros((count, ties))]),
        b_eq=keys.asked,
        bounds=[(keys.asked[0] - lead_in, None)] * count + [(0.0, None)] * (2 * count + ties),
        method="highs",
    )
    if result.x is None:
        raise ArithmeticError(f"no key times: {result.message}")
    times = np.array(result.x[:count])
    return keys.spread(np.where(np.abs(times - keys.asked) < UNMOVED, keys.asked, times))


def strain(keys: Keys, times: Floats) -> float:
    """Computes what moving the keys to times (m,) [s] costs: the sum that `relax_key_times` makes least."""
    late = times - keys.asked
    lacking = sum(max(least - float(times[j] - times[i]), 0.0) for (i, j), least in keys.bonds.items())
    return float(keys.weights @ np.where(late > 0.0, LATENESS * late, -late)) + BROKEN * lacking


def rest_to_rest(keys: Keys, limits: Limits) -> Gaps:
    """Computes the time in which each hinge can stop at each of its keys: always enough."""
    ways, turns = _turns(keys)
    every = RESERVE * least_rest_times(turns, limits) + GRID
    return {way: float(times[way[0]]) for way, times in zip(ways, every, strict=True)}


def full_speed(keys: Keys, limits: Limits) -> Gaps:
    """Computes the time that each hinge needs from key to key at full speed: less is never enough."""
    ways, turns = _turns(keys)
    every = np.abs(turns) / np.minimum(limits.speed, limits.duty / limits.viscous)
    return {way: float(times[way[0]]) for way, times in zip(ways, every, strict=True)}


def _turns(keys: Keys) -> tuple[list[tuple[int, Pair]], np.ndarray[tuple[int, int], np.dtype[np.float64]]]:
    """Hinges with two keys that follow one another, and (p, n) [rad] from the one to the other."""
    ways = [(hinge, pair) for hinge, own in enumerate(keys.own) for pair in pairwise(own)]
    before, after = (keys.angles[[pair[end] for _, pair in ways]] for end in (0, 1))
    return ways, after - before


@dataclass(frozen=True)
class Bottleneck:
    """The hinge and limit that a motion meets first."""

    hinge: int
    quantity: Quantity
    ratio: float  # by which the time is too short


class Search:
    """A search for feasible key times, which goes on with each segment that turns out to be infeasible."""

    def __init__(self, keys: Keys, limits: Limits, lead_in: float) -> None:
        """Begins with the asked times, or the nearest with which full speeds would do.

        Args:
            keys: what was asked.
            limits: of all hinges.
            lead_in: [s] by which the first key may come earlier.
        """
        self._keys, self._limits, self._lead_in = keys, limits, lead_in
        self.met: dict[Pair, Bottleneck] = {}  # what was too fast as asked, between which keys
        self._gaps = dict(keys.gaps)
        self._cuts: dict[int, list[CuttingPlane]] = {}  # of each hinge
        self._rests: dict[int, float] = {}  # hinge -> by which its rests are longer
        self._shortages: dict[tuple[object, ...], Infeasibility | None] = {}  # that were looked at
        self._lengthen_to_full_speed()
        spaced = all(keys.asked[j] - keys.asked[i] >= gap - SAME for (i, j), gap in self._gaps.items())
        self.times = keys.asked if spaced else relax_key_times(keys, self._gaps, lead_in)

    def avoid(self, lost: SplineSegment) -> None:
        """Moves the times until every segment that is known to lack time has a motion again.

        Raises:
            ArithmeticError: a hinge cannot even move from rest to rest.
        """
        first = not self._cuts and not self._rests
        pending = [segment for segment in self._segments() if first and self._suspect(segment, lost)]
        lacking = [(lost, self._shortage(lost)), *self._lacking(pending)]
        while lacking:
            for segment, found in lacking:
                if found is None or segment.hinge in self._rests or len(self._cuts.get(segment.hinge, ())) >= PLANES:
                    self._rest(segment.hinge)
                else:
                    self._cut_off(segment, found)
            self._relax({segment.hinge for segment, _ in lacking})
            lacking = self._lacking([segment for segment in self._segments() if self._near(segment)])

    def _lacking(self, pending: list[SplineSegment]) -> list[tuple[SplineSegment, Infeasibility | None]]:
        found = [(segment, self._shortage(segment)) for segment in pending]
        return [(segment, lack) for segment, lack in found if lack is None or lack.amount > -MARGIN / 4]

    def _shortage(self, segment: SplineSegment) -> Infeasibility | None:
        """Remembered by keys and places, which determine it: many a segment stays the same when others move."""
        known = (segment.hinge, segment.marks, segment.grid.pieces, segment.places.tobytes())
        if known not in self._shortages:
            self._shortages[known] = measure_shortage(segment, self._limits)
        return self._shortages[known]

    def _segments(self) -> Iterator[SplineSegment]:
        return segments(self.times, self._keys, STEP)

    def _suspect(self, segment: SplineSegment, lost: SplineSegment) -> bool:
        return (segment.hinge, segment.first) != (lost.hinge, lost.first) and guess_share(segment, self._limits) > ROUGH

    def _near(self, segment: SplineSegment) -> bool:
        return any(cut.slopes @ self.times > cut.bound - NEAR for cut in self._cuts.get(segment.hinge, ()))

    def _cut_off(self, segment: SplineSegment, found: Infeasibility) -> None:
        """Puts up a plane before times that are too short for a segment, and notes the limit that is met."""
        cuts, amount = self._cuts.setdefault(segment.hinge, []), max(found.amount, 0.0) + MARGIN
        if np.abs(found.slopes).max() > FLAT:
            slopes = self._spread(segment, found.slopes)
            cuts.append(CuttingPlane(slopes, float(slopes @ self.times) - amount))
        else:  # at a kink, where there is no direction: the gaps themselves grow
            for k, quantity in enumerate(found.binding):
                slopes = self._spread(segment, np.eye(len(segment.marks))[k] - np.eye(len(segment.marks))[k + 1])
                if quantity is not None:
                    cuts.append(CuttingPlane(slopes, float(slopes @ self.times) * float(np.exp(amount))))
        ratio = float(np.exp(found.amount))
        for pair, quantity in zip(segment.pairs, found.binding, strict=True):
            if quantity is not None and pair[0] != pair[1]:
                self._meet(pair, Bottleneck(segment.hinge, quantity, ratio))

    def _spread(self, segment: SplineSegment, slopes: Floats) -> Floats:
        """(m,) over all key times, from (m + 2,) over start, keys and end of a segment."""
        spread = np.zeros(len(self.times))
        for marks, slope in zip(segment.marks, slopes, strict=True):
            spread[list(marks)] += slope / len(marks)
        return spread

    def _meet(self, pair: Pair, found: Bottleneck) -> None:
        if pair not in self.met or found.ratio > self.met[pair].ratio:
            self.met[pair] = found

    def _rest(self, hinge: int) -> None:
        """Lets a hinge rest at each of its keys; for longer, where it already does."""
        self._rests[hinge] = longer = LONGER * self._rests[hinge] if hinge in self._rests else 1.0
        if longer > LONGEST:
            raise ArithmeticError(f"hinge {hinge} cannot move within its limits, however slowly")
        for (other, pair), rest in self._all_rests.items():
            if other == hinge:
                self._gaps[pair] = max(self._gaps[pair], longer * rest)
        self._cuts.pop(hinge, None)

    def _relax(self, lacking: set[int]) -> None:
        """Solves the linear program; hinges whose planes leave no times, or worse ones than rests, rest instead."""
        for resting in (set(), lacking, set(self._cuts)):
            for hinge in resting:
                self._rest(hinge)
            cuts = [cut for own in self._cuts.values() for cut in own]
            try:
                self.times = relax_key_times(self._keys, self._gaps, self._lead_in, cuts)
            except ArithmeticError:
                continue
            if not cuts or strain(self._keys, self.times) <= self._enough:
                break

    @cached_property
    def _enough(self) -> float:
        """Strain when all hinges rest at all keys."""
        gaps = dict(self._keys.gaps)
        for (_, pair), rest in self._all_rests.items():
            gaps[pair] = max(gaps[pair], LONGER * rest)
        return strain(self._keys, relax_key_times(self._keys, gaps, self._lead_in))

    @cached_property
    def _all_rests(self) -> Gaps:
        return rest_to_rest(self._keys, self._limits)

    def _lengthen_to_full_speed(self) -> None:
        keys, limits = self._keys, self._limits
        for (hinge, pair), gap in full_speed(keys, limits).items():
            self._gaps[pair] = max(self._gaps[pair], gap)
            asked = float(keys.asked[pair[1]] - keys.asked[pair[0]])
            if gap > max(asked, keys.gaps[pair]) + SAME:
                rated = limits.speed[hinge] <= limits.duty[hinge] / limits.viscous[hinge]
                self._meet(pair, Bottleneck(hinge, "speed" if rated else "duty", gap / max(asked, keys.gaps[pair])))
