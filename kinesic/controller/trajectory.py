"""Motion as a function of time: one quintic spline per hinge through its own keys."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PPoly

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.command import State

HOLD = 1e-9  # [rad] keys nearer than this are a hold


@dataclass(frozen=True, eq=False)
class Manner:
    """How a spline passes its keys (Kochanek-Bartels; thesis 8.7, Sequential Variation)."""

    tension: float = 0.0  # -1..1: 1 stops at each key
    continuity: float = 0.0  # -1..0: a servo cannot jump in speed, so below 0 the speed at keys shrinks by 1 + c
    bias: float = 0.0  # -1..1: 1 follows the incoming chord


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Angles over performance time; at rest before its start and after its end."""

    curves: tuple[PPoly, ...]  # (n,) quintics of each hinge over performance time, all from 0 to the same end
    zero: float  # [s] performance time of the block's zero

    @property
    def duration(self) -> float:
        """[s]."""
        return float(self.curves[0].x[-1])

    def sample(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Angles, speeds and accelerations, each (k, n), at (k,) performance times."""
        inside = np.clip(times, 0.0, self.duration)
        still = (times < 0.0) | (times > self.duration)
        angles, speeds, accelerations = (
            np.stack([curve(inside, nu=order) for curve in self.curves], axis=1) for order in range(3)
        )
        speeds[still] = 0.0
        accelerations[still] = 0.0
        return angles, speeds, accelerations

    def at(self, time: float) -> State:
        """The state at one performance time."""
        angles, speeds, accelerations = self.sample(np.array([time]))
        return State(sealed(angles[0]), sealed(speeds[0]), sealed(accelerations[0]))


def spline(times: Floats, angles: Floats, keyed: Flags, manner: Manner, flow: Floats, *, zero: float) -> Trajectory:
    """Joins the keys of each hinge by quintics that are smooth up to the acceleration.

    Speeds at keys are the tangents of a non-uniform Kochanek-Bartels spline, zero at the ends, beside holds and where
    the hinge turns back, and so bounded that the hinge stays between its keys; accelerations at keys are zero.

    Args:
        times: (m,) [s] of the keys, increasing from key to key of each hinge.
        angles: (m, n) [rad].
        keyed: (m, n), which hinges have a key where; all have one in the first and the last row.
        manner: tension, continuity and bias.
        flow: (m, n) 0..1, how much of its tangent each key keeps.
        zero: [s] the time among `times` that is the block's zero.

    Returns:
        The trajectory; performance time starts at the first key.
    """
    curves = []
    for hinge in range(angles.shape[1]):
        rows = np.flatnonzero(keyed[:, hinge])
        at, value = times[rows] - times[0], angles[rows, hinge]
        speed = _tangents(at, value, manner) * flow[rows, hinge]
        curves.append(PPoly(_quintics(np.diff(at), value, speed), at))
    return Trajectory(tuple(curves), zero - float(times[0]))


def _tangents(times: Floats, values: Floats, manner: Manner) -> Floats:
    """Speeds (k,) at the keys of one hinge, from (k,) times and values."""
    speeds = np.zeros(len(times))
    if len(times) < 3:
        return speeds
    steps, chords = np.diff(times), np.diff(values)
    t, c, b = manner.tension, manner.continuity, manner.bias
    inner = (1 - t) * (1 + c) * ((1 + b) * chords[:-1] + (1 - b) * chords[1:]) / (steps[:-1] + steps[1:])
    held = (np.abs(chords[:-1]) < HOLD) | (np.abs(chords[1:]) < HOLD)
    turning = chords[:-1] * chords[1:] < 0.0
    bound = 2.0 * np.minimum(np.abs(chords[:-1]) / steps[:-1], np.abs(chords[1:]) / steps[1:])
    speeds[1:-1] = np.where(held | turning, 0.0, np.clip(inner, -bound, bound))
    return speeds


def _quintics(steps: Floats, angles: Floats, speeds: Floats) -> Floats:
    """(6, k) coefficients, highest power first, between (k + 1,) keys with zero acceleration."""
    h, v0 = steps, speeds[:-1]
    d = angles[1:] - angles[:-1] - v0 * h
    v = (speeds[1:] - v0) * h
    none = np.zeros_like(h)
    return np.stack([(6 * d - 3 * v) / h**5, (-15 * d + 7 * v) / h**4, (10 * d - 4 * v) / h**3, none, v0, angles[:-1]])


def held(angles: Floats, duration: float = 0.1) -> Trajectory:
    """Staying in one posture, (n,) [rad]."""
    return Trajectory(tuple(PPoly(np.array([[angle]]), np.array([0.0, duration])) for angle in angles), 0.0)
