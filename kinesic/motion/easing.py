"""Easing functions, and smoothed forms that servos can follow.

The formulas are those of thesis 8.7, its OutBack with the sign that makes it begin at 0. Each but the smoothest begins
with a jump in velocity. Averaged over a window, they begin and end at rest without a jump in velocity or acceleration.
"""

from functools import lru_cache
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats, sealed

Easing = Literal["minimum_jerk", "linear", "out_quart", "out_back", "out_bounce", "out_power", "late"]

EASING_INTERVALS = 16  # number of quintic pieces that approximate an easing
QUADRATURE_POINTS = 1024  # sample points of a window average
MIN_LATE_WINDOW = 0.18  # smallest smoothing window of the easing `late`, relative to its duration
LATE_WINDOW_EXPONENT = 1.5  # exponent of steepness by which the smoothing window of `late` shrinks
DEFAULT_OVERSHOOT = 0.1  # overshoot of the easing OutBack, relative to the distance
# Arcs of OutBounce: end and middle [normalised time x 2.75], and lowest progress.
_BOUNCE_ARCS = ((1.0, 0.0, 0.0), (2.0, 1.5, 0.75), (2.5, 2.25, 0.9375), (2.75, 2.625, 0.984375))


def minimum_jerk(normalised_times: Floats) -> Floats:
    """Return minimum-jerk progress at normalised times, clipped to 0..1.

    The formula is that of Flash and Hogan (1985).
    """
    x = np.minimum(np.maximum(normalised_times, 0.0), 1.0)
    return np.asarray(x**3 * (10.0 - 15.0 * x + 6.0 * x**2))


def ease(
    easing: Easing, normalised_times: Floats, *, steepness: float = 4.0, overshoot: float = DEFAULT_OVERSHOOT
) -> Floats:
    """Return the progress of an easing at normalised times.

    Both go from 0 to 1; nothing moves before 0 and after 1.

    Args:
        easing: name of the formula.
        normalised_times: of any shape.
        steepness: exponent of `out_power`; for `late`, a quarter of it plus one.
        overshoot: of `out_back`, relative to the distance.
    """
    x = np.clip(normalised_times, 0.0, 1.0)
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
            arcs = [7.5625 * (x - middle / 2.75) ** 2 + bottom for _, middle, bottom in _BOUNCE_ARCS]
            return np.select([x < end / 2.75 for end, _, _ in _BOUNCE_ARCS], arcs, 1.0)


@lru_cache(maxsize=1024)
def overshoot_shape(overshoot: float) -> float:
    """Return the OutBack parameter s for a relative overshoot.

    The overshoot is 4 s^3 / (27 (s + 1)^2).
    """
    cubic = np.roots([4.0, -27.0 * overshoot, -54.0 * overshoot, -27.0 * overshoot])
    return float(cubic[np.abs(cubic.imag) < 1e-9].real.max())


@lru_cache(maxsize=64)
def soften_easing(easing: Easing, steepness: float, overshoot: float = DEFAULT_OVERSHOOT) -> Floats:
    """Return a smoothed easing's progress, velocity and acceleration.

    Of shape (3, EASING_INTERVALS + 1), at even normalised times; at rest at both ends.

    The easing is compressed in time and averaged over a window, weighted by the velocity of minimum jerk, so that both
    durations add up to 1. The window is the whole time at steepness 1, where every easing is minimum jerk, and two
    ninths of it at steepness 8. For `late`, which peaks at its end, the window shrinks sooner.
    """
    window = 1.0 if easing == "minimum_jerk" else 2.0 / (1.0 + steepness)
    if easing == "late":
        window = max(MIN_LATE_WINDOW, steepness**-LATE_WINDOW_EXPONENT)
    at = np.linspace(0.0, 1.0, EASING_INTERVALS + 1)
    s = (np.arange(QUADRATURE_POINTS) + 0.5) / QUADRATURE_POINTS
    weights = 30.0 * np.stack(
        [
            s**2 * (1.0 - s) ** 2,
            2.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / window,
            (2.0 - 12.0 * s * (1.0 - s)) / window**2,
        ]
    )
    progress = ease(
        easing, (at[:, None] - window * s) / max(1.0 - window, 1e-9), steepness=steepness, overshoot=overshoot
    )
    softened = weights @ progress.T / QUADRATURE_POINTS
    softened[:, 0], softened[:, -1] = 0.0, (1.0, 0.0, 0.0)
    return sealed(softened)
