"""The motion as wished: one quintic spline per hinge through its own keys, whatever the servos can do."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PPoly

from kinesic.body.arrays import Flags, Floats

Hinges = tuple[int, ...]  # in joint order

HOLD = 1e-9  # [rad] keys nearer than this are a hold


@dataclass(frozen=True, eq=False)
class Manner:
    """How a spline passes its keys (Kochanek-Bartels; thesis 8.7, Sequential Variation)."""

    tension: float = 0.0  # -1..1: 1 stops at each key
    continuity: float = 0.0  # -1..0: a servo cannot jump in speed, so below 0 the speed at keys shrinks by 1 + c
    bias: float = 0.0  # -1..1: 1 follows the incoming chord


@dataclass(frozen=True, eq=False)
class Wish:
    """Angles over performance time; at rest before its start and after its end."""

    curves: Mapping[Hinges, PPoly]  # of hinges with the same keys, over performance time, all from 0 to the same end
    zero: float  # [s] performance time of the block's zero

    @property
    def duration(self) -> float:
        """[s]."""
        return float(next(iter(self.curves.values())).x[-1])

    def sample(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Angles, speeds and accelerations, each (m, n), at (m,) performance times."""
        still = (times < 0.0) | (times > self.duration)
        angles, speeds, accelerations = (self._values(times, order) for order in range(3))
        speeds[still] = 0.0
        accelerations[still] = 0.0
        return angles, speeds, accelerations

    def angles(self, times: Floats) -> Floats:
        """(m, n) [rad] at (m,) performance times: of `sample` the first alone."""
        return self._values(times, 0)

    def _values(self, times: Floats, order: int) -> Floats:
        """(m, n) of one derivative."""
        inside = np.clip(times, 0.0, self.duration)
        values = np.empty((len(times), sum(map(len, self.curves))))
        for hinges, curve in self.curves.items():
            values[:, hinges] = curve(inside, nu=order)
        return values


def wish(times: Floats, angles: Floats, keyed: Flags, manner: Manner, *, zero: float = 0.0) -> Wish:
    """Joins the keys of each hinge by quintics that are smooth up to the acceleration.

    Speeds at keys are the tangents of a non-uniform Kochanek-Bartels spline, zero at the ends, beside holds and where
    the hinge turns back, and so bounded that the hinge stays between its keys; accelerations at keys are zero.

    Args:
        times: (m,) [s] of the keys, increasing from key to key of each hinge.
        angles: (m, n) [rad].
        keyed: (m, n), which hinges have a key where; all have one in the first and the last row.
        manner: tension, continuity and bias.
        zero: [s] the time among `times` that is the block's zero.

    Returns:
        The wish; performance time starts at the first key.
    """
    together: dict[bytes, list[int]] = {}
    for hinge, column in enumerate(keyed.T):
        together.setdefault(column.tobytes(), []).append(hinge)
    curves = {}
    for hinges in together.values():
        rows = np.flatnonzero(keyed[:, hinges[0]])
        at, values = times[rows] - times[0], angles[rows][:, hinges]
        curves[tuple(hinges)] = PPoly(_quintics(np.diff(at), values, _tangents(at, values, manner)), at)
    return Wish(curves, zero - float(times[0]))


def _tangents(times: Floats, values: Floats, manner: Manner) -> Floats:
    """Speeds (k, h) at the keys of some hinges, from (k,) times and (k, h) values."""
    speeds = np.zeros_like(values)
    if len(times) < 3:
        return speeds
    steps, chords = np.diff(times)[:, None], np.diff(values, axis=0)
    t, c, b = manner.tension, manner.continuity, manner.bias
    inner = (1 - t) * (1 + c) * ((1 + b) * chords[:-1] + (1 - b) * chords[1:]) / (steps[:-1] + steps[1:])
    held = (np.abs(chords[:-1]) < HOLD) | (np.abs(chords[1:]) < HOLD)
    turning = chords[:-1] * chords[1:] < 0.0
    bound = 2.0 * np.minimum(np.abs(chords[:-1]) / steps[:-1], np.abs(chords[1:]) / steps[1:])
    speeds[1:-1] = np.where(held | turning, 0.0, np.clip(inner, -bound, bound))
    return speeds


def _quintics(steps: Floats, angles: Floats, speeds: Floats) -> Floats:
    """(6, k, h) coefficients, highest power first, between (k + 1, h) keys with zero acceleration."""
    h, v0 = steps[:, None], speeds[:-1]
    d = angles[1:] - angles[:-1] - v0 * h
    v = (speeds[1:] - v0) * h
    none = np.zeros_like(d)
    return np.stack([(6 * d - 3 * v) / h**5, (-15 * d + 7 * v) / h**4, (10 * d - 4 * v) / h**3, none, v0, angles[:-1]])
