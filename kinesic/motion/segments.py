"""Segments: each hinge's motion between two successive rests."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.limits import Limits
from kinesic.body.linear_program import SparseMatrix
from kinesic.motion.bspline import Grid, Indices, grid
from kinesic.motion.keys import HOLD_TOLERANCE, Keys, Pair
from kinesic.motion.trajectory import KNOT_INTERVAL, spline_weights

SWING_FRACTION = 0.1  # overshoot allowed at keys, relative to the key interval's angle
MIN_SWING = 0.05  # [rad] overshoot beyond a key always allowed within the joint range
KEY_NEIGHBOURHOOD = 2  # [knot intervals] distance from a key within which the wider bounds of both intervals hold
MIN_HOLD = 40  # [knot intervals] shortest hold that contains a rest; shorter ones may overshoot
LONG_HOLD = 100  # [knot intervals] part of a long hold, at each end, in which the hinge may still move
MIN_KNOT_INTERVALS = 4  # smallest number of knot intervals of a motion
AMPLE_TIME_FACTOR = 2.5  # multiple of the rest-to-rest duration above which a key interval is split
PLACE_TOLERANCE = 0.02  # [knot intervals] a key closer to a segment's end coincides with it: error below 1e-7 rad
NO_KNOT_POSITIONS = sealed([])  # empty key positions of a segment without inner keys
START_WEIGHTS = np.eye(3, 4)  # rows that select the first three of four control points
END_WEIGHTS = np.eye(3, 4, 1)  # rows that select the last three of four control points


class RestPoint(NamedTuple):
    """Knot at which a hinge rests, so that its motion is split."""

    knot: int
    before: int  # index of the hinge's last exact key before the rest; -1: none
    angle: float  # [rad] angle of the hinge at rest


@dataclass(frozen=True, eq=False)
class Fixed:
    """Linear equations for fixed control points of a segment.

    Each row is weights @ x[first : first + 4] = value.
    """

    first: Indices  # (m,)
    weights: Floats  # (m, 4)
    values: Floats  # (m,) [rad]
    size: int  # n, number of control points

    @property
    def matrix(self) -> SparseMatrix:
        """Coefficients (m, n) of the equations."""
        row, weight = np.nonzero(self.weights)
        return SparseMatrix(row, self.first[row] + weight, self.weights[row, weight], (len(self.first), self.size))


@dataclass(frozen=True, eq=False)
class SplineSegment:
    """Motion of one hinge through its keys, usually between two rests."""

    hinge: int
    first: int  # knot at which the motion begins
    grid: Grid
    start: float  # [rad] angle at the start
    end: float  # [rad] angle at rest at the end; approximate if `stops_anywhere`
    places: Floats  # (m,) knot positions of the keys, in steps from the first knot
    angles: Floats  # (m,) [rad] of its keys
    marks: tuple[tuple[int, ...], ...] = ()  # (m + 2,) keys whose mean times are those of start, keys and end
    entry: tuple[float, ...] | None = None  # [rad] first three control points; None: at rest
    exit: tuple[float, ...] | None = None  # [rad] last three control points; None: at rest
    stops_anywhere: bool = False  # whether the final angle is free
    has_path: bool = False  # whether a path connects some of its keys

    @classmethod
    def through(
        cls, keys: Keys, hinge: int, places: Floats, begin: RestPoint, end: RestPoint, step: float
    ) -> "SplineSegment":
        """Make the segment of a hinge between two rest points.

        Args:
            keys: of the whole motion.
            hinge: index of the hinge.
            places: (k,) knot positions of the hinge's exact keys, in steps from the first knot of the motion.
            begin: rest point before.
            end: rest point after.
            step: [s] of the grid.
        """
        rows, has_path = keys.exact_rows[hinge], keys.has_path(hinge)
        angles = keys.angles[rows, hinge]
        (first, before, _), (last, after, _) = begin, end
        inner = [
            k for k in range(before + 1, after + 1) if first + PLACE_TOLERANCE < places[k] < last - PLACE_TOLERANCE
        ]
        start = max(before, 0)
        return cls(
            hinge,
            first,
            grid(last - first, step),
            begin.angle,
            end.angle,
            places[inner] - first,
            angles[inner],
            (tuple(rows[start : before + 2]), *((rows[k],) for k in inner), tuple(rows[after : after + 2])),
            has_path=bool(has_path[start:after].any()),
        )

    @classmethod
    def between(
        cls,
        hinge: int,
        pieces: int,
        entry: Floats,
        exit: Floats | None = None,
        *,
        places: Floats = NO_KNOT_POSITIONS,
        angles: Floats = NO_KNOT_POSITIONS,
    ) -> "SplineSegment":
        """Make a segment that joins running motion to another, or to rest.

        Args:
            hinge: index of the hinge.
            pieces: number of knot intervals.
            entry: (3,) [rad] control points of the motion that is left.
            exit: (3,) [rad] control points of the motion that is entered; None: rest.
            places: (m,) of keys in between, in steps from the first knot.
            angles: (m,) [rad] of these keys.
        """
        ends = (tuple(map(float, entry)), None if exit is None else tuple(map(float, exit)))
        start, end = float(entry[1]), float(entry[1] if exit is None else exit[1])
        return cls(
            hinge, 0, grid(pieces, KNOT_INTERVAL), start, end, places, angles, (), *ends, stops_anywhere=exit is None
        )

    @property
    def pairs(self) -> tuple[Pair, ...]:
        """Pairs of successive keys from the segment's start to its end."""
        return tuple(pairwise([*(mark[0] for mark in self.marks[:-1]), self.marks[-1][-1]]))

    @cached_property
    def key_intervals(self) -> tuple[tuple[int, Pair], ...]:
        """Key intervals of the segment, as (hinge, key pair)."""
        return tuple((self.hinge, pair) for pair in self.pairs if pair[0] != pair[1])

    @property
    def is_still(self) -> bool:
        """Whether the hinge does not move."""
        return (
            not self.has_path
            and self.entry is None
            and self.exit is None
            and bool(np.all(np.abs(np.append(self.angles, self.end) - self.start) < HOLD_TOLERANCE))
        )

    @property
    def reversals(self) -> int:
        """Number of keys at which the hinge reverses."""
        rotations = np.diff([self.start, *self.angles, self.end])
        moving = rotations[np.abs(rotations) > HOLD_TOLERANCE]
        return int(np.sum(moving[1:] * moving[:-1] < 0.0))

    @property
    def rests_early(self) -> bool:
        """Whether the last key lies in the final knot interval before rest."""
        return self.exit is None and len(self.places) > 0 and bool(self.places[-1] > self.grid.pieces - 1)

    def within(self, other: "SplineSegment") -> bool:
        """Return whether the segment lies within another of the same hinge."""
        last, end = self.first + self.grid.pieces, other.first + other.grid.pieces
        return self.hinge == other.hinge and other.first <= self.first and last <= end

    @property
    def knots(self) -> slice:
        """Knot indices of the segment within the whole motion."""
        return slice(self.first, self.first + self.grid.pieces + 1)

    @property
    def controls(self) -> slice:
        """Control point indices of the segment within the whole motion."""
        return slice(self.first, self.first + self.grid.size)

    def corridor(self, limits: Limits, desired: Floats | None = None) -> tuple[Floats, Floats]:
        """Return the permitted range of each control point (k + 3,) [rad].

        Without it a hinge with little time would start behind its keys, and overshoot after them.

        Args:
            limits: of all hinges; the rotation ranges always hold.
            desired: (k + 1,) [rad] at the knots.

        Returns:
            (k + 3,) [rad] lowest and highest.
        """
        lowest, highest = limits.lower[self.hinge], limits.upper[self.hinge]
        if self.entry or self.exit:  # a running motion may overshoot as far as necessary
            return np.full(self.grid.size, lowest), np.full(self.grid.size, highest)
        ends = np.array([self.start, *self.angles, self.end])
        low, high = np.minimum(ends[:-1], ends[1:]), np.maximum(ends[:-1], ends[1:])
        swing = np.maximum(SWING_FRACTION * (high - low), MIN_SWING)
        middles = np.arange(self.grid.size) - 1  # where a control point counts most
        first = np.searchsorted(self.places, middles - KEY_NEIGHBOURHOOD)
        last = np.searchsorted(self.places, middles + KEY_NEIGHBOURHOOD)
        lower, upper = (
            np.minimum((low - swing)[first], (low - swing)[last]),
            np.maximum((high + swing)[first], (high + swing)[last]),
        )
        if desired is not None:
            padded = np.concatenate([desired[:1], desired, desired[-1:]])
            lower, upper = np.minimum(lower, padded - MIN_SWING), np.maximum(upper, padded + MIN_SWING)
        return np.maximum(lower, lowest), np.minimum(upper, highest)

    @cached_property
    def fixed(self) -> Fixed:
        """Equations that fix control points at start, keys and end.

        A key in the last knot interval is the rest itself: the control point before the rest equals the rest angle.
        """
        first, weights = spline_weights(self.places, self.grid.pieces)
        if self.rests_early:
            weights[-1] = [1.0, 0.0, 0.0, 0.0]
        last = self.grid.size - 4
        ends, end = np.vstack([START_WEIGHTS, END_WEIGHTS]), [*(self.exit or [self.end] * 3)]
        is_used = np.full(6, True)
        if self.stops_anywhere:  # the last two control points equal the one before them
            ends[4:, 1], end, is_used[3] = -1.0, [self.end, 0.0, 0.0], False
        return Fixed(
            np.concatenate([first, np.array([0, 0, 0, last, last, last])[is_used]]).astype(np.int32),
            np.vstack([weights, ends[is_used]]),
            np.array([*self.angles, *np.array([*(self.entry or [self.start] * 3), *end])[is_used]]),
            self.grid.size,
        )


def segments(times: Floats, keys: Keys, step: float) -> Iterator[SplineSegment]:
    """Yield the motion segments of all hinges, hinge by hinge.

    Args:
        times: (m,) [s] of the keys.
        keys: of the motion.
        step: [s] of the grid, which begins at the first key.
    """
    places, last = (times - times[0]) / step, pieces(times, step)
    for hinge, rows in enumerate(keys.exact_rows):
        angles, has_path = keys.angles[rows, hinge], keys.has_path(hinge)
        for begin, end in pairwise(_add_ends(angles, last, _find_holds(places[rows], angles, has_path))):
            yield SplineSegment.through(keys, hinge, places[rows], begin, end, step)


def find_critical_segments(
    times: Floats, keys: Keys, step: float, rest_durations: Sequence[Floats], hinges: Iterable[int]
) -> Iterator[SplineSegment]:
    """Yield segments split at all rest points, omitting always feasible ones.

    A key interval with ample time is also split in its middle: the two halves are hardly harder to pass than the whole.
    A segment is always feasible if the hinge could rest at each of its keys.

    Args:
        times: (m,) [s] of the keys.
        keys: of the motion.
        step: [s] of the grid, which begins at the first key.
        rest_durations: (g,) [s] rest-to-rest durations of each hinge's key intervals.
        hinges: indices of the hinges.
    """
    places, last = (times - times[0]) / step, pieces(times, step)
    for hinge in hinges:
        rows, durations = keys.exact_rows[hinge], rest_durations[hinge] / step
        can_rest = np.diff(places[rows]) >= durations
        if can_rest.all():
            continue
        angles, has_path = keys.angles[rows, hinge], keys.has_path(hinge)
        holds = _find_holds(places[rows], angles, has_path)
        rest_points = sorted([*holds, *_split_ample_intervals(places[rows], angles, has_path, durations)])
        for begin, end in pairwise(_add_ends(angles, last, rest_points)):
            if not can_rest[begin.before + 1 : end.before].all():
                yield SplineSegment.through(keys, hinge, places[rows], begin, end, step)


def _add_ends(angles: Floats, last: int, rest_points: Iterable[RestPoint]) -> list[RestPoint]:
    """Add the start and end of the motion to the rest points."""
    return [RestPoint(0, -1, float(angles[0])), *rest_points, RestPoint(last, len(angles) - 1, float(angles[-1]))]


def pieces(times: Floats, step: float) -> int:
    """Return the number of knot intervals between first and last key time.

    It is at least `MIN_KNOT_INTERVALS`.
    """
    return max(MIN_KNOT_INTERVALS, int(np.ceil((times[-1] - times[0]) / step - PLACE_TOLERANCE)))


def _find_holds(places: Floats, angles: Floats, has_path: Flags) -> Iterator[RestPoint]:
    """Yield a rest point for each hold, two for a long hold."""
    for k in np.flatnonzero((np.abs(np.diff(angles)) < HOLD_TOLERANCE) & ~has_path):
        begin, end, angle = places[k], places[k + 1], float(angles[k])
        if end - begin > 2 * LONG_HOLD + MIN_HOLD:
            yield RestPoint(round(begin) + LONG_HOLD, int(k), angle)
            yield RestPoint(round(end) - LONG_HOLD, int(k), angle)
        elif end - begin >= MIN_HOLD:
            yield RestPoint(round((begin + end) / 2), int(k), angle)


def _split_ample_intervals(places: Floats, angles: Floats, has_path: Flags, durations: Floats) -> Iterator[RestPoint]:
    """Yield a rest point in the middle of intervals with ample time."""
    has_ample_time = np.diff(places) >= np.maximum(AMPLE_TIME_FACTOR * durations, MIN_HOLD)
    for k in np.flatnonzero(has_ample_time & (np.abs(np.diff(angles)) >= HOLD_TOLERANCE) & ~has_path):
        yield RestPoint(round((places[k] + places[k + 1]) / 2), int(k), float(angles[k] + angles[k + 1]) / 2)
