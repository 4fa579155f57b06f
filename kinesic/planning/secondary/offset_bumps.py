"""Smooth temporary angle offsets added to a motion.

An offset starts and ends at zero position, velocity and acceleration. The sum passes every key outside of it unchanged,
at the same time.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.motion.easing import minimum_jerk

CONTROL_LEAD = 1  # knots from a control point to the knot it affects most


class MotionChange(Protocol):
    """Interface of a temporary angle offset of some hinges."""

    @property
    def begin(self) -> float:
        """Start time [s] of the angle offset."""

    @property
    def end(self) -> float:
        """End time [s] of the angle offset."""

    @property
    def hinges(self) -> Sequence[int]:
        """Indices of the moved hinges, in joint order."""

    def added(self, times: Floats) -> Floats:
        """Return the offsets (m, h) [rad] at knot times (m,) [s]."""


@dataclass(frozen=True, eq=False)
class OffsetBump:
    """Smooth angle offset that rises to a peak and returns to zero.

    Times [s] are those of the motion.
    """

    begin: float
    peak: float
    end: float
    away: Floats  # (n,) [rad] offset of all hinges of the robot at the peak
    stays: float = 0.0  # [s] duration of the peak

    def later(self, seconds: float) -> "OffsetBump":
        """Return the bump delayed by some seconds."""
        return replace(self, begin=self.begin + seconds, peak=self.peak + seconds, end=self.end + seconds)

    @cached_property
    def hinges(self) -> Sequence[int]:
        """Indices of the moved hinges, in joint order."""
        return tuple(np.flatnonzero(self.away).tolist())

    def added(self, times: Floats) -> Floats:
        """Return the offsets (m, h) [rad] at times (m,) [s]."""
        return np.asarray(self.fractions_at(times)[:, None] * self.away[list(self.hinges)])

    def fractions_at(self, times: Floats) -> Floats:
        """Return the fraction (m,) of the peak offset at (m,) times [s]."""
        rising = minimum_jerk((times - self.begin) / (self.peak - self.begin))
        left = self.peak + self.stays
        return np.asarray(rising - minimum_jerk((times - left) / (self.end - left)))
