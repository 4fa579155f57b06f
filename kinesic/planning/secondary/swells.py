"""Swells, which most changes of a motion are, and what all of them have in common.

In a swell some hinges go a little away from where a motion has them, and come back, beneath all that it does. It begins
and ends at nothing, smooth up to the acceleration, so that the sum with a motion passes every key outside of it as
before, and no key at another time.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.motion.easing import minimum_jerk

CONTROL_LEAD = 1  # knots by which a control point lies before the one where it counts most


class MotionChange(Protocol):
    """A change of what some hinges do for a while; times [s] are those of the motion."""

    @property
    def begin(self) -> float:
        """The time from which it moves hinges [s]."""

    @property
    def end(self) -> float:
        """The time from which it no longer moves hinges [s]."""

    @property
    def hinges(self) -> Sequence[int]:
        """Which ones it moves, in joint order."""

    def added(self, times: Floats) -> Floats:
        """(m, h) [rad] what it adds to the angles of its hinges at (m,) knots [s], from its begin to its end."""


def runs(flags: Flags) -> Iterator[tuple[int, int]]:
    """Finds the first and the last index of each run of true ones among (m,)."""
    inner = (np.flatnonzero(flags[1:] != flags[:-1]) + 1).tolist()
    edges = [*([0] if flags[:1].any() else []), *inner, *([len(flags)] if flags[-1:].any() else [])]
    yield from ((first, end - 1) for first, end in zip(edges[::2], edges[1::2], strict=True))


@dataclass(frozen=True, eq=False)
class Swell:
    """A change that rises to a peak and falls back; times [s] are those of the motion beneath it."""

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
