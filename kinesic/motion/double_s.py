"""The shortest times from rest to rest, and from any motion to rest, in closed form: double-S profiles.

And so the times that hinges need from one of their keys to the next: at full speed, and from rest to rest.
"""

from collections.abc import Mapping
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from kinesic.body.arrays import Floats, Indices, sealed
from kinesic.body.limits import Limits
from kinesic.motion.keys import Keys, Pair

Way = tuple[int, Pair]  # hinge, two of its keys that follow one another
Gaps = Mapping[Way, float]  # [s]

RESERVE = 1.02  # on durations from rest to rest
GRID = 0.04  # [s] that the grid may cost
SPEEDS = np.linspace(0.1, 0.9, 9)  # shares of the duty that a constant speed may take


def least_time(distance: ArrayLike, speed: ArrayLike, acceleration: ArrayLike, jerk: ArrayLike) -> Floats:
    """Computes the shortest time from rest to rest within speed, acceleration and jerk.

    The profile reaches the greatest speed on long ways, the greatest acceleration on middling ones and neither on
    short ones. Arguments broadcast; their unit of length is any, such as rad or m.

    Args:
        distance: of the way; its sign does not matter.
        speed: greatest, above 0.
        acceleration: greatest, above 0; infinite where only speed and jerk bound it.
        jerk: greatest, above 0; infinite where there is no bound.

    Returns:
        [s], of the common shape; grows with the distance, and is 0 for none.
    """
    way, v, j = np.abs(np.asarray(distance, dtype=float)), np.asarray(speed, dtype=float), np.asarray(jerk, dtype=float)
    a = np.minimum(acceleration, np.sqrt(v * j))  # more is never reached before the greatest speed
    rise = a / j  # [s] from no acceleration to the greatest
    cruising = way / v + v / a + rise
    accelerating = rise + np.sqrt(rise**2 + 4 * way / a)
    jerking = 4 * np.cbrt(way / (2 * j))
    cruises, accelerates = way >= v * (v / a + rise), way >= 2 * a * rise**2
    return np.asarray(np.where(cruises, cruising, np.where(accelerates, accelerating, jerking)))


def least_rest_times(turns: Floats, limits: Limits) -> Floats:
    """Computes the shortest times from rest to rest of hinges within all their limits, that of the duty included.

    Each is that of a double S within a speed and an acceleration that keep the duty together; the best of several
    such pairs.

    Args:
        turns: (..., n) [rad] by which the hinges turn; their sign does not matter.
        limits: of the n hinges.

    Returns:
        (..., n) [s].
    """
    speed, acceleration = _speeds(limits)
    return np.asarray(least_time(turns[..., None, :], speed, acceleration, limits.jerk).min(axis=-2))


def least_rest_times_of(hinges: Indices, turns: Floats, limits: Limits) -> Floats:
    """Computes the same for single turns of some hinges.

    Args:
        hinges: (p,) which hinge each turn is of.
        turns: (p,) [rad].
        limits: of all hinges.

    Returns:
        (p,) [s].
    """
    speed, acceleration = _speeds(limits)
    return np.asarray(least_time(turns, speed[:, hinges], acceleration[:, hinges], limits.jerk[hinges]).min(axis=0))


@lru_cache(maxsize=64)
def _speeds(limits: Limits) -> tuple[Floats, Floats]:
    """(9, n) speeds [rad/s], and accelerations [rad/s^2] that the duty allows with each of them."""
    speed = np.minimum(limits.speed, SPEEDS[:, None] * limits.duty / limits.viscous)
    spare = limits.duty - limits.viscous * speed
    return sealed(speed), sealed(np.minimum(limits.acceleration, spare / limits.inertial))


def least_stop(speed: ArrayLike, acceleration: ArrayLike, most: ArrayLike, jerk: ArrayLike) -> Floats:
    """Computes the shortest time to rest, wherever that is, within an acceleration and a jerk.

    From an acceleration the jerk leads to a braking one and back to none; the braking acceleration p follows from
    the speed that is left to lose, p^2 = jerk * speed + acceleration^2 / 2, and is held where that is too much.

    Args:
        speed: to begin with.
        acceleration: to begin with, at most the greatest.
        most: greatest acceleration, above 0.
        jerk: greatest, above 0.

    Returns:
        [s], of the common shape.
    """
    v, a, j = (np.asarray(value, dtype=float) for value in (speed, acceleration, jerk))
    way = np.where(v + a * np.abs(a) / (2 * j) < 0.0, -1.0, 1.0)  # which way the speed goes once a is used up
    v, a = way * v, way * a
    peak = np.sqrt(np.maximum(j * v + a**2 / 2, 0.0))
    braking = np.minimum(peak, most)
    holding = np.maximum(peak**2 - braking**2, 0.0) / (j * braking + np.finfo(float).tiny)
    return np.asarray((a + 2 * braking) / j + holding)


def rest_to_rest(keys: Keys, limits: Limits) -> Gaps:
    """Computes the time in which each hinge can stop at each of its keys: always enough."""
    ways, hinges, turns = _turns(keys)
    every = RESERVE * least_rest_times_of(hinges, turns, limits) + GRID
    return dict(zip(ways, every.tolist(), strict=True))


@lru_cache(maxsize=4)  # clashes and key times ask for those of the same keys
def full_speed(keys: Keys, limits: Limits) -> Gaps:
    """Computes the time that each hinge needs from key to key at full speed: less is never enough."""
    ways, hinges, turns = _turns(keys)
    every = np.abs(turns) / np.minimum(limits.speed, limits.duty / limits.viscous)[hinges]
    return dict(zip(ways, every.tolist(), strict=True))


def _turns(keys: Keys) -> tuple[list[Way], Indices, Floats]:
    """Hinges with two keys that follow one another, (p,) the same hinges, and (p,) [rad] from the one to the other."""
    ways = [(hinge, pair) for hinge, own in enumerate(keys.own) for pair in pairwise(own)]
    hinges, before, after = np.array([(hinge, i, j) for hinge, (i, j) in ways], dtype=np.intp).reshape(-1, 3).T
    return ways, hinges, keys.angles[after, hinges] - keys.angles[before, hinges]
