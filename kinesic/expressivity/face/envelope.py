"""How an expression comes and goes: from nothing to its peak, a while there, and back, in some manner."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.expressivity.style.style import NEUTRAL, Expressivity
from kinesic.motion.easing import ease

QUICKEST = 0.06  # [s] in which a muscle of the face can do anything
WIDEST = 0.5  # more intensity of a spatial extent of 1, and less of -1
OVERSHOOT = 0.25  # of the intensity, by which a power of 1 goes over what it then holds
SETTLING = 0.35  # [s] from there to what is held
FADING = 0.4  # of the intensity, that a power of -1 loses while it holds
LONGEST = 2.0  # [s] that this takes
BRIDGED = 1.0  # [s] between two expressions, over which a fluidity of 1 leads from one into the other


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

    def at(self, times: Floats, manner: Expressivity = NEUTRAL) -> Floats:
        """(m,) shares of the intensity at (m,) times, 0..1 in a neutral manner.

        Every manner keeps the four times. Power brings the expression on early and lets it overshoot; weakness lets it
        come late and fade. Of a jerky one the ways begin and end abruptly. A wide one is more than asked, a tight less.

        Args:
            times: [s].
            manner: of the face; spatial extent, power and fluidity are used. What comes out may exceed 1.
        """
        shares = _way(_early((times - self.start) / (self.peak - self.start), manner.power), manner.fluidity)
        if not np.isinf(self.end):
            shares = np.minimum(shares, 1.0 - _way((times - self.relax) / (self.end - self.relax), manner.fluidity))
        return np.asarray((1.0 + WIDEST * manner.spatial) * shares * self._level(times, manner.power))

    def _level(self, times: Floats, power: float) -> Floats | float:
        """(m,) what is held, as a share of what was asked."""
        if power > 0:
            return 1.0 + OVERSHOOT * power * (1.0 - ease("minimum_jerk", (times - self.peak) / SETTLING))
        held = min(max(self.relax - self.peak, QUICKEST), LONGEST)
        return 1.0 + FADING * power * ease("minimum_jerk", (times - self.peak) / held) if power else 1.0


def _early(shares: Floats, power: float) -> Floats:
    """Shares of the time of coming, as a forceful or a weak expression takes them."""
    x = np.clip(shares, 0.0, 1.0)
    return 1.0 - (1.0 - x) ** (1.0 + power) if power > 0 else x ** (1.0 - power)


def _way(shares: Floats, fluidity: float) -> Floats:
    """Shares of a way at shares of its time."""
    smooth = ease("minimum_jerk", shares)
    return smooth if fluidity >= 0 else smooth - fluidity * (ease("linear", shares) - smooth)
