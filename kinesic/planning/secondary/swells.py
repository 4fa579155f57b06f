"""Changes of a motion, several of which are laid on it together; swells, which most of them are.

In a swell some hinges go a little away from where a motion has them, and come back, beneath all that it does. It begins
and ends at nothing, smooth up to the acceleration, so that the sum with a motion passes every key outside of it as
before, and no key at another time.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil
from typing import Protocol

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import grid
from kinesic.motion.easing import minimum_jerk
from kinesic.motion.trajectory import EARLY, FEWEST, STEP, Trajectory

FULL = 1.0 + 1e-9  # share of a limit
AHEAD = 1  # knots by which a control point lies before the one where it counts most


class Change(Protocol):
    """What some hinges do otherwise for a while; times [s] are those of the motion."""

    @property
    def begin(self) -> float:
        """From here on."""

    @property
    def end(self) -> float:
        """Until here."""

    @property
    def hinges(self) -> Sequence[int]:
        """Which ones it moves, in joint order."""

    def added(self, times: Floats) -> Floats:
        """(m, h) [rad] what it adds to the angles of its hinges at (m,) times [s] between its begin and end."""


def runs(flags: Flags) -> Iterator[tuple[int, int]]:
    """Finds the first and the last index of each run of true ones among (m,)."""
    edges = np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8))
    yield from zip(np.flatnonzero(edges > 0).tolist(), (np.flatnonzero(edges < 0) - 1).tolist(), strict=True)


def spans(change: Change, times: Floats) -> Flags:
    """(m,) whether a change is under way at times (m,) [s]."""
    return np.asarray((times > change.begin) & (times < change.end))


@dataclass(frozen=True, eq=False)
class Swell:
    """What some hinges do for a while; times [s] are those of the motion beneath which it lies."""

    begin: float
    peak: float
    end: float
    away: Floats  # (n,) [rad] by which each hinge is away at the peak
    stays: float = 0.0  # [s] that it is away as far, from the peak on

    def later(self, seconds: float) -> "Swell":
        """Shifts all its times by some seconds."""
        return replace(self, begin=self.begin + seconds, peak=self.peak + seconds, end=self.end + seconds)

    @cached_property
    def hinges(self) -> Sequence[int]:
        """Which ones it moves, in joint order."""
        return tuple(np.flatnonzero(self.away).tolist())

    def added(self, times: Floats) -> Floats:
        """(m, h) [rad] how far its hinges are away at (m,) times [s]."""
        return np.asarray(self.share(times)[:, None] * self.away[list(self.hinges)])

    def share(self, times: Floats) -> Floats:
        """(m,) share of the way out at times (m,) [s]."""
        rising = minimum_jerk((times - self.begin) / (self.peak - self.begin))
        left = self.peak + self.stays
        return np.asarray(rising - minimum_jerk((times - left) / (self.end - left)))


@dataclass(frozen=True, eq=False)
class _Part:
    """What one change adds to control points."""

    rows: slice
    hinges: Sequence[int]
    added: Floats  # (r, h) [rad]


@dataclass(frozen=True, eq=False)
class Changes:
    """All changes of a motion, each worked out once, however often they are added to it with other amounts."""

    motion: Trajectory  # at rest before its start and after its end
    every: Sequence[Change]  # they begin no sooner than the motion

    @cached_property
    def _parts(self) -> Sequence[_Part]:
        return [self._part(change) for change in self.every]

    def _part(self, change: Change) -> _Part:
        start = self.motion.start
        first = max(FEWEST - 1, int((change.begin - start) / STEP))  # before it the motion is at rest
        last = min(ceil((change.end - start) / STEP) + AHEAD, self._size(change.end) - FEWEST + 1)
        times = np.asarray(start + (np.arange(first, last) - AHEAD) * STEP, dtype=np.float64)
        return _Part(slice(first, last), change.hinges, change.added(times))

    def _size(self, end: float) -> int:
        """How many control points there are where the last change is over at an end [s]."""
        return len(self.motion.controls) + max(0, ceil((end - self.motion.end) / STEP - EARLY))

    def added(self, amounts: Floats) -> Trajectory:
        """The motion with so much (c,) of each change; it goes on until the last of them is over."""
        ends = (each.end for each, amount in zip(self.every, amounts, strict=True) if amount)
        more = self._size(max(ends, default=self.motion.end)) - len(self.motion.controls)
        controls = np.vstack([self.motion.controls, np.repeat(self.motion.controls[-1:], more, axis=0)])
        for part, amount in zip(self._parts, amounts.tolist(), strict=True):
            if amount:
                controls[part.rows, part.hinges] += amount * part.added
        return Trajectory(sealed(controls), self.motion.zero, self.motion.start)


def exceeded(motion: Trajectory, laid: Trajectory, limits: Limits, hinges: Sequence[int] | None = None) -> Flags:
    """Finds at which knots (k,) of a changed motion which hinges (n,) break a limit that the motion alone keeps.

    Args:
        motion: alone.
        laid: with changes.
        limits: of all hinges.
        hinges: that are looked at; None: all.
    """
    own = grid(len(laid.controls) - FEWEST + 1, STEP)
    alone = np.vstack([motion.controls, np.repeat(motion.controls[-1:], own.size - len(motion.controls), axis=0)])
    beyond: Flags = np.zeros((own.pieces + 1, alone.shape[1]), dtype=np.bool_)
    for hinge in range(alone.shape[1]) if hinges is None else hinges:
        shares = own.shares(laid.controls[:, hinge], limits, hinge)
        if max(float(np.abs(share).max()) for share in shares) <= FULL:
            continue
        for share, before in zip(shares, own.shares(alone[:, hinge], limits, hinge), strict=True):
            over = np.flatnonzero(np.abs(share) > np.maximum(FULL, np.abs(before) + FULL - 1.0))
            beyond[np.minimum(over, own.pieces), hinge] = True
    return beyond
