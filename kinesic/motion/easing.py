"""Easings: the share of a way that is covered at a share of its time, as formulas and as servos can play them.

The formulas are those of thesis 8.7, its OutBack with the sign that makes it begin at 0. Each but the smoothest begins
with a jump in speed; averaged over a window they begin and end at rest without a jump in speed or acceleration.
"""

from functools import lru_cache
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats, sealed

Easing = Literal["minimum_jerk", "linear", "out_quart", "out_back", "out_bounce", "out_power", "late"]

PARTS = 16  # of a way, between which a quintic is as good as the easing
QUADRATURE = 1024  # points of an average
LAST = 0.18  # of a way, in which what is `late` comes to rest: with less, servos round the stop off
SOONER = 1.5  # exponent of its steepness with which it comes to that
OVERSHOOT = 0.1  # of OutBack, as a share of the way
_BOUNCES = ((1.0, 0.0, 0.0), (2.0, 1.5, 0.75), (2.5, 2.25, 0.9375), (2.75, 2.625, 0.984375))  # end, middle, bottom


def minimum_jerk(shares: Floats) -> Floats:
    """Shares of a way at shares of its time, as smoothly as can be (Flash and Hogan, 1985); clipped to 0..1."""
    x = np.minimum(np.maximum(shares, 0.0), 1.0)
    return np.asarray(x**3 * (10.0 - 15.0 * x + 6.0 * x**2))


def ease(easing: Easing, shares: Floats, *, steepness: float = 4.0, overshoot: float = OVERSHOOT) -> Floats:
    """Computes shares of a way at shares of its time, both from 0 to 1; before 0 and after 1 nothing moves.

    Args:
        easing: which.
        shares: of the time, any shape.
        steepness: exponent of `out_power`; of `late` a quarter of it, and one more.
        overshoot: of `out_back`, as a share of the way.
    """
    x = np.clip(shares, 0.0, 1.0)
    match easing:
        case "minimum_jerk":
            return minimum_jerk(x)
        case "linear":
            return x
        case "out_quart":
            return np.asarray(1.0 - (1.0 - x) ** 4)
        case "out_power":
            return np.asarray(1.0 - (1.0 - x) ** steepness)
        case "late":
            return np.asarray(x ** (1.0 + steepness / 4.0))
        case "out_back":
            s = overshoot_shape(overshoot)
            return np.asarray(1.0 + (x - 1.0) ** 2 * ((s + 1.0) * (x - 1.0) + s))
        case "out_bounce":
            arcs = [7.5625 * (x - middle / 2.75) ** 2 + bottom for _, middle, bottom in _BOUNCES]
            return np.select([x < end / 2.75 for end, _, _ in _BOUNCES], arcs, 1.0)


@lru_cache(maxsize=1024)
def overshoot_shape(overshoot: float) -> float:
    """Finds the s of OutBack that overshoots by a share of the way: 4 s^3 / (27 (s + 1)^2) is the overshoot."""
    cubic = np.roots([4.0, -27.0 * overshoot, -54.0 * overshoot, -27.0 * overshoot])
    return float(cubic[np.abs(cubic.imag) < 1e-9].real.max())


@lru_cache(maxsize=1024)
def soften_easing(easing: Easing, steepness: float, overshoot: float = OVERSHOOT) -> Floats:
    """Softens an easing: (3, PARTS + 1) share, speed and acceleration at even shares of the time, from rest to rest.

    The easing is played in a shorter time and averaged over a window that makes up for it, with the speeds of minimum
    jerk as weights. The window is the whole time at steepness 1, where every easing is minimum jerk, and two ninths of
    it at steepness 8. What is `late` has its peak at its end however gently it rises: its window shrinks sooner.
    """
    window = 1.0 if easing == "minimum_jerk" else 2.0 / (1.0 + steepness)
    if easing == "late":
        window = max(LAST, steepness**-SOONER)
    at = np.linspace(0.0, 1.0, PARTS + 1)
    s = (np.arange(QUADRATURE) + 0.5) / QUADRATURE
    weights = 30.0 * np.stack(
        [
            s**2 * (1.0 - s) ** 2,
            2.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / window,
            (2.0 - 12.0 * s * (1.0 - s)) / window**2,
        ]
    )
    come = ease(easing, (at[:, None] - window * s) / max(1.0 - window, 1e-9), steepness=steepness, overshoot=overshoot)
    found = weights @ come.T / QUADRATURE
    found[:, 0], found[:, -1] = 0.0, (1.0, 0.0, 0.0)
    return sealed(found)
