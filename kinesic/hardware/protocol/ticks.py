"""Converts radians to ticks and back; nothing else does."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.body.servo import TICKS_PER_RADIAN

Ticks = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Scale:
    """Ticks against angles, a straight line per hinge, in joint order."""

    zeros: Floats  # (n,) [ticks] where the hinge's angle is 0
    turns: Floats  # (n,) signed servo turns per hinge turn; negative where the servo is mounted the other way round

    def ticks(self, angles: Floats) -> Ticks:
        """Converts angles to the nearest ticks, whatever the servo's range allows.

        Args:
            angles: (..., n) [rad].

        Returns:
            (..., n) ticks.

        Raises:
            ValueError: an angle is not finite.
        """
        return self.nearest(angles).astype(np.int64)

    def nearest(self, angles: Floats) -> Floats:
        """Converts like `ticks`, to whole numbers of floating point."""
        if not np.isfinite(angles).all():
            raise ValueError(f"angles are {angles}, must be finite")
        nearest: Floats = np.rint(self.zeros + self._per_radian * angles)
        return nearest

    def angles(self, ticks: Ticks | Floats) -> Floats:
        """Converts (..., n) ticks to (..., n) [rad]."""
        return (ticks - self.zeros) / self._per_radian

    @cached_property
    def _per_radian(self) -> Floats:
        """(n,) [ticks/rad] of the hinge."""
        return self.turns * TICKS_PER_RADIAN
