"""Minimum-time double-S velocity profiles, from rest to rest or to a stop.

The durations of key intervals are computed as well: at full velocity, and from rest to rest.
"""

from collections.abc import Mapping
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from kinesic.body.arrays import Floats, Indices, sealed
from kinesic.body.limits import Limits
from kinesic.motion.keys import Keys, Pair

KeyInterval = tuple[int, Pair]  # hinge, and two of its successive keys
IntervalDurations = Mapping[KeyInterval, float]  # [s] duration of each key interval

REST_DURATION_FACTOR = 1.02  # safety factor on rest-to-rest durations
GRID_ALLOWANCE = 0.04  # [s] time added to rest-to-rest durations for the knot grid
DUTY_FRACTIONS = np.linspace(0.1, 0.9, 9)  # fractions of the duty limit that velocity may use; all are tried


def least_time(distance: ArrayLike, speed: ArrayLike, acceleration: ArrayLike, jerk: ArrayLike) -> Floats:
    """Return minimum rest-to-rest times within velocity, acceleration and jerk limits.

    The profile reaches the velocity limit over long distances, the acceleration limit over medium ones, and neither
    over short ones. Arguments broadcast; their unit of length is any, such as rad or m.

    Args:
        distance: its sign does not matter.
        speed: velocity limit, above 0.
        acceleration: limit, above 0; infinite where only velocity and jerk bound it.
        jerk: limit, above 0; infinite where there is no bound.

    Returns:
        [s], of the common shape; grows with the distance, and is 0 for distance 0.
    """
    travel = np.abs(np.asarray(distance, dtype=float))
    v, j = np.asarray(speed, dtype=float), np.asarray(jerk, dtype=float)
    a = np.minimum(acceleration, np.sqrt(v * j))  # more is never reached below the velocity limit
    rise = a / j  # [s] until the acceleration limit is reached
    cruising = travel / v + v / a + rise
    accelerating = rise + np.sqrt(rise**2 + 4 * travel / a)
    jerking = 4 * np.cbrt(travel / (2 * j))
    reaches_velocity, reaches_acceleration = travel >= v * (v / a + rise), travel >= 2 * a * rise**2
    return np.asarray(np.where(reaches_velocity, cruising, np.where(reaches_acceleration, accelerating, jerking)))


def least_rest_times(turns: Floats, limits: Limits) -> Floats:
    """Return minimum rest-to-rest times of hinges within all limits.

    Each is that of a double S within a speed and an acceleration that keep the duty together; the best of several
    such pairs.

    Args:
        turns: (..., n) [rad] by which the hinges turn; their sign does not matter.
        limits: of the n hinges.

    Returns:
        (..., n) [s].
    """
    speed, acceleration = _velocity_options(limits)
    return np.asarray(least_time(turns[..., None, :], speed, acceleration, limits.jerk).min(axis=-2))


def least_rest_times_of(hinges: Indices, turns: Floats, limits: Limits) -> Floats:
    """Return minimum rest-to-rest times of single rotations.

    Args:
        hinges: (p,) hinge of each rotation.
        turns: (p,) [rad].
        limits: of all hinges.

    Returns:
        (p,) [s].
    """
    speed, acceleration = _velocity_options(limits)
    return np.asarray(least_time(turns, speed[:, hinges], acceleration[:, hinges], limits.jerk[hinges]).min(axis=0))


@lru_cache(maxsize=64)
def _velocity_options(limits: Limits) -> tuple[Floats, Floats]:
    """Return nine candidate velocity and acceleration limits per hinge, each (9, n)."""
    speed = np.minimum(limits.speed, DUTY_FRACTIONS[:, None] * limits.duty / limits.viscous)
    remaining_duty = limits.duty - limits.viscous * speed
    return sealed(speed), sealed(np.minimum(limits.acceleration, remaining_duty / limits.inertial))


def least_stop(speed: ArrayLike, acceleration: ArrayLike, max_acceleration: ArrayLike, jerk: ArrayLike) -> Floats:
    """Return the minimum time to stop within acceleration and jerk limits.

    The jerk takes the acceleration to a braking value and back to 0. The braking acceleration p follows from the
    remaining velocity, p^2 = jerk * speed + acceleration^2 / 2; above the limit, the limit is held.

    Args:
        speed: initial velocity.
        acceleration: initial value, within its limit.
        max_acceleration: limit, above 0.
        jerk: limit, above 0.

    Returns:
        [s], of the common shape.
    """
    v, a, j = (np.asarray(value, dtype=float) for value in (speed, acceleration, jerk))
    direction = np.where(v + a * np.abs(a) / (2 * j) < 0.0, -1.0, 1.0)  # sign of the velocity once a is back to 0
    v, a = direction * v, direction * a
    peak = np.sqrt(np.maximum(j * v + a**2 / 2, 0.0))
    braking = np.minimum(peak, max_acceleration)
    holding = np.maximum(peak**2 - braking**2, 0.0) / (j * braking + np.finfo(float).tiny)
    return np.asarray((a + 2 * braking) / j + holding)


def compute_rest_durations(keys: Keys, limits: Limits) -> IntervalDurations:
    """Return sufficient rest-to-rest durations [s] of all key intervals."""
    intervals, hinges, rotations = _list_intervals(keys)
    durations = REST_DURATION_FACTOR * least_rest_times_of(hinges, rotations, limits) + GRID_ALLOWANCE
    return dict(zip(intervals, durations.tolist(), strict=True))


@lru_cache(maxsize=4)  # the searches for timing conflicts and for key times need those of the same keys
def compute_velocity_durations(keys: Keys, limits: Limits) -> IntervalDurations:
    """Return each key interval's minimum duration at full velocity [s].

    They are lower bounds: less is never enough.
    """
    intervals, hinges, rotations = _list_intervals(keys)
    durations = np.abs(rotations) / np.minimum(limits.speed, limits.duty / limits.viscous)[hinges]
    return dict(zip(intervals, durations.tolist(), strict=True))


def _list_intervals(keys: Keys) -> tuple[list[KeyInterval], Indices, Floats]:
    """Return all key intervals with their hinges and rotations [rad]."""
    intervals = [(hinge, pair) for hinge, rows in enumerate(keys.exact_rows) for pair in pairwise(rows)]
    indices = np.array([(hinge, i, j) for hinge, (i, j) in intervals], dtype=np.intp).reshape(-1, 3)
    hinges, before, after = indices.T
    return intervals, hinges, keys.angles[after, hinges] - keys.angles[before, hinges]
