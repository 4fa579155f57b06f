"""How an expression comes and goes: from nothing to its peak, a while there, and back, without a jerk."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.expressivity.easing import eased

QUICKEST = 0.06  # [s] in which a muscle of the face can do anything


@dataclass(frozen=True)
class Envelope:
    """Four times; an expression that stays never relaxes."""

    start: float  # [s]
    peak: float  # [s]
    relax: float = np.inf  # [s]
    end: float = np.inf  # [s]

    @classmethod
    def of(cls, times: Mapping[str, float], *, stays: bool = False) -> "Envelope":
        """The envelope of a face's sync points; ways that they leave no time for take `QUICKEST`.

        Args:
            times: start, attackPeak, relax and end, or of one that stays start and end [s].
            stays: whether it never goes back.
        """
        start = times["start"]
        if stays:
            return cls(start, max(times["end"], start + QUICKEST))
        peak = max(times["attackPeak"], start + QUICKEST)
        relax = max(times["relax"], peak)
        return cls(start, peak, relax, max(times["end"], relax + QUICKEST))

    def at(self, times: Floats) -> Floats:
        """(m,) shares of the peak, 0..1, at (m,) times."""
        risen = eased("minimum_jerk", (times - self.start) / (self.peak - self.start))
        if np.isinf(self.end):
            return risen
        return np.minimum(risen, 1.0 - eased("minimum_jerk", (times - self.relax) / (self.end - self.relax)))
