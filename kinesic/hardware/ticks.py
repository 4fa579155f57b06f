"""The one place where radians become ticks, and ticks radians."""

from dataclasses import dataclass

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
        """The nearest ticks; what the servo's range allows is not its business.

        Args:
            angles: (..., n) [rad].

        Returns:
            (..., n) ticks.

        Raises:
            ValueError: an angle is not finite.
        """
        if not np.isfinite(angles).all():
            raise ValueError(f"angles are {angles}, must be finite")
        return np.rint(self.zeros + self.turns * TICKS_PER_RADIAN * angles).astype(np.int64)

    def angles(self, ticks: Ticks | Floats) -> Floats:
        """(..., n) [rad] of (..., n) ticks."""
        return (ticks - self.zeros) / (self.turns * TICKS_PER_RADIAN)
