"""Makes a motion one that the servos can follow: first as asked, then with sync points moved as little as needed.

Position, speed and acceleration limits hold for what is returned; the remedies come in the order of the line:
softer passing of keys, then the times, gap by gap where a limit is exceeded, until none is (`retime`).
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.interpolate import PPoly

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.controller.postures import Posture
from kinesic.controller.retime import Keys, Pair, relaxed, rest_to_rest
from kinesic.controller.trajectory import Manner, Trajectory, spline

Quantity = Literal["speed", "acceleration"]

LEAD_IN = 0.6  # [s] by which the motion may begin before it is asked to
ROUNDS = 12  # of retiming before every key is passed at rest
GROWTH = 1.01  # on what a gap lacks, so that few rounds suffice
SOFTENINGS = (0.6, 0.3, 0.0, 0.0)  # share of its speed that a key beside a piece over its limit keeps
SAMPLES = np.linspace(0.0, 1.0, 65)
SAMPLING_RESERVE = 1.0006  # a quartic's peak over its largest of 65 samples
FLAT = 1e-12


@dataclass(frozen=True)
class Bottleneck:
    """The hinge and limit that a motion meets first."""

    hinge: int
    quantity: Quantity
    ratio: float  # by which the time is too short


@dataclass(frozen=True, eq=False)
class Conditioned:
    """A motion within limits, and what had to give."""

    trajectory: Trajectory
    asked: Floats  # (m,) [s] block time of the keys as wished
    planned: Floats  # (m,) [s] block time of the keys as they will be
    bottlenecks: Mapping[Pair, Bottleneck]  # what was too fast as asked, between which keys


def condition(
    postures: tuple[Posture, ...], limits: Limits, manner: Manner, *, lead_in: float = LEAD_IN
) -> Conditioned:
    """Fits the keys into the limits.

    Args:
        postures: at least two, the first and the last keyed in all hinges.
        limits: of position, speed and acceleration.
        manner: how keys are passed.
        lead_in: [s] by which the first key may come earlier.
    """
    keys = Keys.of(postures)
    gaps, met = dict(keys.gaps), dict[Pair, Bottleneck]()
    times = keys.asked if keys.spaced else relaxed(keys, gaps, lead_in)
    for _ in range(ROUNDS):
        trajectory, excess = _softened(times, keys, limits, manner)
        if not excess:
            return Conditioned(trajectory, keys.asked, times, met)
        met = excess | met
        for (i, j), found in excess.items():
            gaps[i, j] = max(gaps[i, j], GROWTH * found.ratio * float(times[j] - times[i]))
        times = relaxed(keys, gaps, lead_in)
    times = relaxed(keys, rest_to_rest(keys, limits), lead_in)
    still = spline(times, keys.angles, keys.keyed, manner, np.zeros_like(keys.angles), zero=0.0)
    return Conditioned(still, keys.asked, times, met)


def _softened(times: Floats, keys: Keys, limits: Limits, manner: Manner) -> tuple[Trajectory, dict[Pair, Bottleneck]]:
    """The motion at these times, keys passed more slowly where that keeps the limits.

    Returns:
        The motion, and where the time between two keys of a hinge is too short; empty when it is nowhere.
    """
    flow = np.ones_like(keys.angles)
    for softness in SOFTENINGS:
        trajectory = spline(times, keys.angles, keys.keyed, manner, flow, zero=0.0)
        excess = list(_excess(trajectory, keys, limits))
        if not excess:
            break
        for pair, found in excess:
            flow[pair, found.hinge] = softness
    return trajectory, dict(sorted(excess, key=lambda entry: entry[1].ratio))


def _excess(trajectory: Trajectory, keys: Keys, limits: Limits) -> Iterator[tuple[Pair, Bottleneck]]:
    """Every piece of a hinge that exceeds a limit, by its two keys."""
    for hinge, curve in enumerate(trajectory.curves):
        speed, acceleration = _ratios(curve, limits, hinge)
        shortest = np.maximum(speed, np.sqrt(acceleration))
        if shortest.max() > 1.0:
            rows = keys.rows(hinge)
            for k in np.flatnonzero(shortest > 1.0):
                quantity: Quantity = "speed" if shortest[k] == speed[k] else "acceleration"
                yield (rows[k], rows[k + 1]), Bottleneck(hinge, quantity, float(shortest[k]))


def _ratios(curve: PPoly, limits: Limits, hinge: int) -> tuple[Floats, Floats]:
    """Per piece of a hinge, the peak of speed and of acceleration over their limits, (k,) each."""
    h, c = np.diff(curve.x), curve.c
    speeds = np.stack([np.outer(h, SAMPLES) ** power for power in range(4, -1, -1)])  # (5, k, samples)
    speeds = np.einsum("pks,pk->ks", speeds, c[-6:-1] * np.array([5, 4, 3, 2, 1])[:, None])
    peaks = np.abs(speeds).max(axis=1) * SAMPLING_RESERVE, _peak_acceleration(c, h)
    return peaks[0] / limits.speed[hinge], peaks[1] / limits.acceleration[hinge]


def _peak_acceleration(c: Floats, h: Floats) -> Floats:
    """(k,) [rad/s^2]: 20 c0 s^3 + 12 c1 s^2 + 6 c2 s (c3 is zero) at the ends of pieces and where its slope is 0."""
    root = np.sqrt(np.maximum((12 * c[1]) ** 2 - 60 * c[0] * 6 * c[2], 0.0))
    cubic = np.where(np.abs(c[0]) < FLAT, FLAT, 60 * c[0])
    square = np.where(np.abs(c[1]) < FLAT, FLAT, 24 * c[1])
    places = (h, (-12 * c[1] + root) / cubic, (-12 * c[1] - root) / cubic, -6 * c[2] / square)
    inside = [np.clip(place, 0.0, h) for place in places]
    return np.asarray(np.max([np.abs(((20 * c[0] * s + 12 * c[1]) * s + 6 * c[2]) * s) for s in inside], axis=0))
