"""Motion as a function of time: one quintic spline per hinge through its own keys."""

from dataclasses import dataclass
from functools import cached_property

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

    breaks: Floats  # (m + 1,) [s] performance time, from 0
    coefficients: Floats  # (6, m, n) of the quintics, highest power first, on time since the break before
    zero: float  # [s] performance time of the block's zero

    @property
    def duration(self) -> float:
        """[s]."""
        return float(self.breaks[-1])

    @cached_property
    def _splines(self) -> tuple[PPoly, PPoly, PPoly]:
        angles = PPoly(np.array(self.coefficients), np.array(self.breaks))
        return angles, angles.derivative(1), angles.derivative(2)

    def sample(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Angles, speeds and accelerations, each (k, n), at (k,) performance times."""
        inside = np.clip(times, 0.0, self.duration)
        still = (times < 0.0) | (times > self.duration)
        angles, speeds, accelerations = (np.asarray(spline(inside)) for spline in self._splines)
        speeds[still] = 0.0
        accelerations[still] = 0.0
        return angles, speeds, accelerations

    def at(self, time: float) -> State:
        """The state at one performance time."""
        angles, speeds, accelerations = self.sample(np.array([time]))
        return State(sealed(angles[0]), sealed(speeds[0]), sealed(accelerations[0]))


def spline(times: Floats, angles: Floats, keyed: Flags, manner: Manner, flow: Floats, *, zero: float) -> Trajectory:
    """Joins keys by quintics that are smooth up to the acceleration.

    Speeds at keys are the tangents of a non-uniform Kochanek-Bartels spline, zero at the ends and beside holds,
    and never so large that a hinge could leave the range between its neighbouring keys by more than the
    spline's own overshoot; accelerations at keys are zero.

    Args:
        times: (m,) [s] of the keys, strictly increasing.
        angles: (m, n) [rad].
        keyed: (m, n) bool, which hinges have a key where; all have one in the first and the last row.
        manner: tension, continuity and bias.
        flow: (m, n) 0..1, how much of its tangent each key keeps.
        zero: [s] the time among `times` that is the block's zero.

    Returns:
        The trajectory; performance time starts at the first key.
    """
    derivatives = np.zeros((len(times), 3, angles.shape[1]))
    for hinge in range(angles.shape[1]):
        rows = np.flatnonzero(keyed[:, hinge])
        own = np.zeros((len(rows), 3, 1))
        own[:, 0, 0] = angles[rows, hinge]
        own[:, 1, 0] = _tangents(times[rows], own[:, 0, 0], manner) * flow[rows, hinge]
        curve = PPoly(_quintics(np.diff(times[rows]), own), times[rows])
        for order in range(3):
            derivatives[:, order, hinge] = curve(times, nu=order)[:, 0]
        derivatives[rows, :, hinge] = own[:, :, 0]
    breaks = times - times[0]
    return Trajectory(sealed(breaks), sealed(_quintics(np.diff(breaks), derivatives)), zero - float(times[0]))


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


def _quintics(steps: Floats, derivatives: Floats) -> Floats:
    """(6, m, n) coefficients from angle, speed and acceleration (m + 1, 3, n) at the breaks."""
    h = steps[:, None]
    p0, v0, a0 = derivatives[:-1, 0], derivatives[:-1, 1], derivatives[:-1, 2]
    p1, v1, a1 = derivatives[1:, 0], derivatives[1:, 1], derivatives[1:, 2]
    d = p1 - p0 - v0 * h - a0 * h**2 / 2
    v = (v1 - v0 - a0 * h) * h
    a = (a1 - a0) * h**2
    return np.stack(
        [
            (6 * d - 3 * v + a / 2) / h**5,
            (-15 * d + 7 * v - a) / h**4,
            (10 * d - 4 * v + a / 2) / h**3,
            a0 / 2,
            v0,
            p0,
        ]
    )


def held(angles: Floats, duration: float = 0.1) -> Trajectory:
    """Staying in one posture, (n,) [rad]."""
    coefficients = np.zeros((6, 1, len(angles)))
    coefficients[5, 0] = angles
    return Trajectory(sealed([0.0, duration]), sealed(coefficients), 0.0)
