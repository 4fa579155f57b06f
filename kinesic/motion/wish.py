"""The motion as wished: one quintic spline per hinge through its own keys, whatever the servos can do."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy

from kinesic.body.arrays import Floats
from kinesic.motion.eases import changes
from kinesic.motion.easing import PARTS
from kinesic.motion.keys import SMOOTHEST, Waypoints
from kinesic.motion.passing import accelerations, speeds

Hinges = tuple[int, ...]  # in joint order

SHARES = np.arange(PARTS) / PARTS  # of a way, where an easing is told


@dataclass(frozen=True, eq=False)
class Wish:
    """Angles over performance time; at rest before its start and after its end."""

    # Of hinges with the same keys, over performance time, all from 0 to the same end.
    curves: Mapping[Hinges, "scipy.interpolate.PPoly"]
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


def wish(times: Floats, keys: Waypoints, *, zero: float = 0.0) -> Wish:
    """Joins the keys of each hinge by quintics that are smooth up to the acceleration.

    Speeds at keys are the tangents of a non-uniform Kochanek-Bartels spline, each key with its own tension, continuity
    and bias; they are zero at the ends and beside holds, and carry a hinge beyond its keys only where its tension is
    negative and only as far as its range goes. Easings move what the speeds at keys leave of a way.

    Args:
        times: (m,) [s] of the keys, increasing from key to key of each hinge.
        keys: what is passed, and how; all hinges have a key in the first and the last row.
        zero: [s] the time among `times` that is the block's zero.

    Returns:
        The wish; performance time starts at the first key.
    """
    together: dict[bytes, list[int]] = {}
    for hinge, column in enumerate(keys.keyed.T):
        together.setdefault(column.tobytes(), []).append(hinge)
    curves = {}
    for hinges in together.values():
        rows = np.flatnonzero(keys.keyed[:, hinges[0]])
        curves[tuple(hinges)] = _curve(times[rows] - times[0], keys.part(rows, np.array(hinges)))
    return Wish(curves, zero - float(times[0]))


def _curve(times: Floats, keys: Waypoints) -> "scipy.interpolate.PPoly":
    """Of hinges that all have the same keys, at (k,) times."""
    steps, passed = np.diff(times), speeds(times, keys)
    plain = scipy.interpolate.PPoly(_quintics(steps, keys.angles, passed, accelerations(times, keys, passed)), times)
    if np.all(keys.easing[1:] == SMOOTHEST):
        return plain
    ways, carried = np.diff(keys.angles, axis=0), steps[:, None] * (passed[:-1] + passed[1:]) / 2
    left = np.where((ways - carried) * ways > 0.0, ways - carried, 0.0)
    fine = np.append((times[:-1, None] + steps[:, None] * SHARES).ravel(), times[-1])
    states = np.stack([plain(fine, nu=order) for order in range(3)])
    along = states[:, :-1].reshape(3, len(steps), PARTS, -1).transpose(0, 1, 3, 2)
    added = changes(left, along, steps, keys)
    states[:, :-1] += added.transpose(0, 1, 3, 2).reshape(3, len(fine) - 1, -1)
    return scipy.interpolate.PPoly(_quintics(np.diff(fine), *states), fine)


def _quintics(steps: Floats, angles: Floats, speeds: Floats, accelerations: Floats) -> Floats:
    """(6, k, h) coefficients, highest power first, between (k + 1, h) angles, speeds and accelerations."""
    h, v0, a0 = steps[:, None], speeds[:-1], accelerations[:-1]
    d = angles[1:] - angles[:-1] - v0 * h - a0 * h**2 / 2
    v = (speeds[1:] - v0 - a0 * h) * h
    a = (accelerations[1:] - a0) * h**2
    high = [(6 * d - 3 * v + a / 2) / h**5, (-15 * d + 7 * v - a) / h**4, (10 * d - 4 * v + a / 2) / h**3]
    return np.stack([*high, a0 / 2, v0, angles[:-1]])
