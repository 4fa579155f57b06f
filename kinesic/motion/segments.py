"""Cuts the motion of each hinge where it rests; what lies between two rests is a problem of its own."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import Grid, Indices, grid
from kinesic.motion.keys import HOLD, Keys, Pair
from kinesic.motion.trajectory import STEP, spline_weights

SWING = 0.1  # of a way, beyond which a hinge may not swing
LEAST_SWING = 0.05  # [rad] that it may swing in any case
NEAR = 2  # steps about a key in which both its gaps count
LEAST_HOLD = 40  # steps of a hold in whose middle the hinge rests: in shorter ones it may swing back for what follows
LONG_HOLD = 100  # steps at either end of a longer hold in which a hinge may swing; in between nothing moves
LEAST = 4  # pieces of a motion
ROOMY = 2.5  # times as long as a way takes from rest to rest, from which on it may be judged by halves
SAME = 0.02  # steps: a hinge that comes to rest moves by less than 1e-7 rad in them
NOWHERE = sealed([])
STARTS, ENDS = np.eye(3, 4), np.eye(3, 4, 1)  # shares of the first and of the last three control points


class Cut(NamedTuple):
    """Where a hinge rests."""

    knot: int
    before: int  # the last of its own keys before; -1: none
    angle: float  # [rad]


@dataclass(frozen=True, eq=False)
class Fixed:
    """What is fixed of the control points x of a segment: shares @ x[first : first + 4] = value in each row."""

    first: Indices  # (m,)
    shares: Floats  # (m, 4)
    values: Floats  # (m,) [rad]
    size: int  # n, number of control points

    @property
    def matrix(self) -> "scipy.sparse.csr_array":
        """(m, n) sparse, with as many entries as shares are not 0."""
        columns = self.first[:, None] + np.arange(4)
        kept = self.shares != 0.0
        starts = np.concatenate([[0], np.cumsum(kept.sum(axis=1))])
        return scipy.sparse.csr_array((self.shares[kept], columns[kept], starts), shape=(len(self.first), self.size))


@dataclass(frozen=True, eq=False)
class SplineSegment:
    """The motion of one hinge through its keys, begun and ended at rest or in another motion."""

    hinge: int
    first: int  # knot at which it begins to move
    grid: Grid
    start: float  # [rad]
    end: float  # [rad] at rest; only about, if it `halts`
    places: Floats  # (m,) of its keys, in steps from its first knot
    angles: Floats  # (m,) [rad] of its keys
    marks: tuple[tuple[int, ...], ...] = ()  # (m + 2,) keys in whose middle start, keys and end are
    entry: tuple[float, ...] | None = None  # [rad] first three control points, where it does not begin at rest
    exit: tuple[float, ...] | None = None  # [rad] last three control points, where it does not end at rest
    halts: bool = False  # whether it may come to rest anywhere
    led: bool = False  # whether a path leads it from one key to the next

    @classmethod
    def through(cls, keys: Keys, hinge: int, places: Floats, begin: Cut, end: Cut, step: float) -> "SplineSegment":
        """Takes the keys of a hinge between two cuts: from rest to rest.

        Args:
            keys: of the whole motion.
            hinge: whose segment it is.
            places: (k,) of the hinge's own keys, in steps from the first knot of the motion.
            begin: where it rests before.
            end: where it rests after.
            step: [s] of the grid.
        """
        own, angles, led = keys.own[hinge], keys.angles[keys.own[hinge], hinge], keys.led(hinge)
        (first, before, _), (last, after, _) = begin, end
        inner = [k for k in range(before + 1, after + 1) if first + SAME < places[k] < last - SAME]
        start = max(before, 0)
        return cls(
            hinge,
            first,
            grid(last - first, step),
            begin.angle,
            end.angle,
            places[inner] - first,
            angles[inner],
            (tuple(own[start : before + 2]), *((own[k],) for k in inner), tuple(own[after : after + 2])),
            led=bool(led[start:after].any()),
        )

    @classmethod
    def between(
        cls,
        hinge: int,
        pieces: int,
        entry: Floats,
        exit: Floats | None = None,
        *,
        places: Floats = NOWHERE,
        angles: Floats = NOWHERE,
    ) -> "SplineSegment":
        """Leads from a running motion into another one, or to rest wherever it can.

        Args:
            hinge: whose segment it is.
            pieces: of the segment.
            entry: (3,) [rad] control points of the motion that is left.
            exit: (3,) [rad] control points of the motion that is entered; None: rest.
            places: (m,) of keys in between, in steps from the first knot.
            angles: (m,) [rad] of these keys.
        """
        ends = (tuple(map(float, entry)), None if exit is None else tuple(map(float, exit)))
        start, end = float(entry[1]), float(entry[1] if exit is None else exit[1])
        return cls(hinge, 0, grid(pieces, STEP), start, end, places, angles, (), *ends, halts=exit is None)

    @property
    def pairs(self) -> tuple[Pair, ...]:
        """(m + 1,) the keys about each gap: start, keys, end."""
        return tuple(pairwise([*(mark[0] for mark in self.marks[:-1]), self.marks[-1][-1]]))

    @cached_property
    def ways(self) -> tuple[tuple[int, Pair], ...]:
        """The hinge, with each of these pairs of two different keys."""
        return tuple((self.hinge, pair) for pair in self.pairs if pair[0] != pair[1])

    @property
    def still(self) -> bool:
        """Whether nothing moves."""
        return (
            not self.led
            and self.entry is None
            and self.exit is None
            and bool(np.all(np.abs(np.append(self.angles, self.end) - self.start) < HOLD))
        )

    @property
    def turns(self) -> int:
        """Number of keys at which the hinge turns back."""
        ways = np.diff([self.start, *self.angles, self.end])
        moving = ways[np.abs(ways) > HOLD]
        return int(np.sum(moving[1:] * moving[:-1] < 0.0))

    @property
    def rests_early(self) -> bool:
        """Whether the last key lies in the last piece, from where on the hinge rests."""
        return self.exit is None and len(self.places) > 0 and bool(self.places[-1] > self.grid.pieces - 1)

    def within(self, other: "SplineSegment") -> bool:
        """Whether it is the motion of the same hinge during a part of another segment, or all of it."""
        last, end = self.first + self.grid.pieces, other.first + other.grid.pieces
        return self.hinge == other.hinge and other.first <= self.first and last <= end

    @property
    def knots(self) -> slice:
        """Slice of the knots of the whole motion."""
        return slice(self.first, self.first + self.grid.pieces + 1)

    @property
    def controls(self) -> slice:
        """Slice of the control points of the whole motion."""
        return slice(self.first, self.first + self.grid.size)

    def corridor(self, limits: Limits, desired: Floats | None = None) -> tuple[Floats, Floats]:
        """Bounds the control points: near the keys on both sides, or near a desired motion.

        Without it a hinge that has little time would run up from behind its keys, and swing out after them.

        Args:
            limits: whose ranges are kept in any case.
            desired: (k + 1,) [rad] at the knots.

        Returns:
            (k + 3,) [rad] lowest and highest.
        """
        lowest, highest = limits.lower[self.hinge], limits.upper[self.hinge]
        if self.entry or self.exit:  # what is under way swings out as far as it must
            return np.full(self.grid.size, lowest), np.full(self.grid.size, highest)
        ends = np.array([self.start, *self.angles, self.end])
        low, high = np.minimum(ends[:-1], ends[1:]), np.maximum(ends[:-1], ends[1:])
        swing = np.maximum(SWING * (high - low), LEAST_SWING)
        middles = np.arange(self.grid.size) - 1  # where a control point counts most
        first = np.searchsorted(self.places, middles - NEAR)
        last = np.searchsorted(self.places, middles + NEAR)
        lower, upper = (
            np.minimum((low - swing)[first], (low - swing)[last]),
            np.maximum((high + swing)[first], (high + swing)[last]),
        )
        if desired is not None:
            padded = np.concatenate([desired[:1], desired, desired[-1:]])
            lower, upper = np.minimum(lower, padded - LEAST_SWING), np.maximum(upper, padded + LEAST_SWING)
        return np.maximum(lower, lowest), np.minimum(upper, highest)

    @cached_property
    def fixed(self) -> Fixed:
        """What entry, keys and exit fix of the control points.

        A key in the last piece is the rest itself: the control point before the rest is as the rest is.
        """
        first, shares = spline_weights(self.places, self.grid.pieces)
        if self.rests_early:
            shares[-1] = [1.0, 0.0, 0.0, 0.0]
        last = self.grid.size - 4
        ends, end = np.vstack([STARTS, ENDS]), [*(self.exit or [self.end] * 3)]
        kept = np.full(6, True)
        if self.halts:  # the last two are as the one before them
            ends[4:, 1], end, kept[3] = -1.0, [self.end, 0.0, 0.0], False
        return Fixed(
            np.concatenate([first, np.array([0, 0, 0, last, last, last])[kept]]).astype(np.int32),
            np.vstack([shares, ends[kept]]),
            np.array([*self.angles, *np.array([*(self.entry or [self.start] * 3), *end])[kept]]),
            self.grid.size,
        )


def segments(times: Floats, keys: Keys, step: float) -> Iterator[SplineSegment]:
    """Cuts the motion of all hinges into segments, in order.

    Args:
        times: (m,) [s] of the keys.
        keys: of the motion.
        step: [s] of the grid, which begins at the first key.
    """
    places, last = (times - times[0]) / step, pieces(times, step)
    for hinge, own in enumerate(keys.own):
        angles, led = keys.angles[own, hinge], keys.led(hinge)
        for begin, end in pairwise(_from_rest_to_rest(angles, last, _cuts(places[own], angles, led))):
            yield SplineSegment.through(keys, hinge, places[own], begin, end, step)


def tight_segments(
    times: Floats, keys: Keys, step: float, rests: Sequence[Floats], hinges: Iterable[int]
) -> Iterator[SplineSegment]:
    """Cuts the motion of some hinges into segments as short as can be, and leaves out those that have time in any case.

    Where a way has far more time than a hinge needs, it is cut in its middle, too: the two halves are harder to pass
    than the whole, but by next to nothing. A segment has time where the hinge could rest at each of its keys.

    Args:
        times: (m,) [s] of the keys.
        keys: of the motion.
        step: [s] of the grid, which begins at the first key.
        rests: (g,) [s] of each hinge, in which it gets from rest to rest from one of its keys to the next.
        hinges: whose motion it is.
    """
    places, last = (times - times[0]) / step, pieces(times, step)
    for hinge in hinges:
        own = keys.own[hinge]
        slow = np.diff(places[own]) >= rests[hinge] / step
        if slow.all():
            continue
        angles, led = keys.angles[own, hinge], keys.led(hinge)
        cuts = [*_cuts(places[own], angles, led), *_roomy_cuts(places[own], angles, led, rests[hinge] / step)]
        for begin, end in pairwise(_from_rest_to_rest(angles, last, sorted(cuts))):
            if not slow[begin.before + 1 : end.before].all():
                yield SplineSegment.through(keys, hinge, places[own], begin, end, step)


def _from_rest_to_rest(angles: Floats, last: int, cuts: Iterable[Cut]) -> list[Cut]:
    """Adds the two ends of the motion to the cuts."""
    return [Cut(0, -1, float(angles[0])), *cuts, Cut(last, len(angles) - 1, float(angles[-1]))]


def pieces(times: Floats, step: float) -> int:
    """Counts the pieces of a grid that spans the keys at (m,) times [s]."""
    return max(LEAST, int(np.ceil((times[-1] - times[0]) / step - SAME)))


def _cuts(places: Floats, angles: Floats, led: Flags) -> Iterator[Cut]:
    """One in the middle of each hold; two in a long one, so that stillness costs nothing."""
    for k in np.flatnonzero((np.abs(np.diff(angles)) < HOLD) & ~led):
        begin, end, angle = places[k], places[k + 1], float(angles[k])
        if end - begin > 2 * LONG_HOLD + LEAST_HOLD:
            yield Cut(round(begin) + LONG_HOLD, int(k), angle)
            yield Cut(round(end) - LONG_HOLD, int(k), angle)
        elif end - begin >= LEAST_HOLD:
            yield Cut(round((begin + end) / 2), int(k), angle)


def _roomy_cuts(places: Floats, angles: Floats, led: Flags, rests: Floats) -> Iterator[Cut]:
    """One in the middle of each way with far more time than it takes from rest to rest."""
    roomy = np.diff(places) >= np.maximum(ROOMY * rests, LEAST_HOLD)
    for k in np.flatnonzero(roomy & (np.abs(np.diff(angles)) >= HOLD) & ~led):
        yield Cut(round((places[k] + places[k + 1]) / 2), int(k), float(angles[k] + angles[k + 1]) / 2)
