"""Conversion between hinge angles [rad] and servo positions [ticks]."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.body.servo import TICKS_PER_RADIAN

Ticks = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Scale:
    """Linear conversion between ticks and angles per hinge, in joint order."""

    zeros: Floats  # (n,) [ticks] position at hinge angle 0
    turns: Floats  # (n,) signed servo revolutions per hinge revolution; negative for inverted servos

    def ticks(self, angles: Floats) -> Ticks:
        """Convert angles to the nearest ticks, without range limits.

        Args:
            angles: (..., n) [rad].

        Returns:
            (..., n) ticks.

        Raises:
            ValueError: an angle is not finite.
        """
        return self.nearest(angles).astype(np.int64)

    def nearest(self, angles: Floats) -> Floats:
        """Convert angles to the nearest ticks as floats."""
        if not np.isfinite(angles).all():
            raise ValueError(f"angles are {angles}, must be finite")
        nearest: Floats = np.rint(self.zeros + self._per_radian * angles)
        return nearest

    def angles(self, ticks: Ticks | Floats) -> Floats:
        """Convert ticks (..., n) to angles (..., n) [rad]."""
        return (ticks - self.zeros) / self._per_radian

    @cached_property
    def _per_radian(self) -> Floats:
        """Signed ticks per radian of each hinge (n,)."""
        return self.turns * TICKS_PER_RADIAN
