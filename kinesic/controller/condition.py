"""Makes a motion one that the servos can follow: first as asked, then with sync points moved as little as needed.

Position, speed and acceleration limits hold for what is returned; the remedies come in the order of the line:
softer passing of keys, then the times, gap by gap where a limit is exceeded, until none is (`retime`).
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.limits import Limits
from kinesic.controller.postures import LEAST_GAP, Posture
from kinesic.controller.retime import Keys, Pair, relaxed, rest_to_rest
from kinesic.controller.trajectory import Manner, Trajectory, spline

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
    quantity: Literal["speed", "acceleration"]
    ratio: float  # to the limit


@dataclass(frozen=True, eq=False)
class Conditioned:
    """A motion within limits, and what had to give."""

    trajectory: Trajectory
    asked: Floats  # (m,) [s] block time of the keys as wished
    planned: Floats  # (m,) [s] block time of the keys as they will be
    bottleneck: Bottleneck | None  # of the wished motion, when it could not be done as asked


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
    gaps = {(k, k + 1): min(LEAST_GAP, float(step)) for k, step in enumerate(np.diff(keys.asked))}
    times, first = keys.asked, None
    for _ in range(ROUNDS):
        trajectory, excess = _softened(times, keys, limits, manner)
        if not excess:
            return Conditioned(trajectory, keys.asked, times, first)
        first = first or bottleneck(trajectory, limits)
        for (i, j), factor in excess.items():
            gaps[i, j] = max(gaps.get((i, j), 0.0), GROWTH * factor * float(times[j] - times[i]))
        times = relaxed(keys, gaps, lead_in)
    times = relaxed(keys, rest_to_rest(keys, limits), lead_in)
    still = spline(times, keys.angles, keys.keyed, manner, np.zeros_like(keys.angles), zero=0.0)
    return Conditioned(still, keys.asked, times, first)


def bottleneck(trajectory: Trajectory, limits: Limits) -> Bottleneck:
    """The largest ratio of speed or acceleration to its limit."""
    speed, acceleration = _ratios(trajectory, limits)
    peaks = {"speed": speed.max(axis=0), "acceleration": acceleration.max(axis=0)}
    quantity: Literal["speed", "acceleration"] = (
        "speed" if peaks["speed"].max() >= peaks["acceleration"].max() else "acceleration"
    )
    hinge = int(peaks[quantity].argmax())
    return Bottleneck(hinge, quantity, float(peaks[quantity][hinge]))


def _softened(times: Floats, keys: Keys, limits: Limits, manner: Manner) -> tuple[Trajectory, dict[Pair, float]]:
    """The motion at these times, keys passed more slowly where that keeps the limits.

    Returns:
        The motion, and by what factor the time between two keys of a hinge is too short; empty when none is.
    """
    flow = np.ones_like(keys.angles)
    for softness in SOFTENINGS:
        trajectory = spline(times, keys.angles, keys.keyed, manner, flow, zero=0.0)
        speed, acceleration = _ratios(trajectory, limits)
        over = np.maximum(speed, np.sqrt(acceleration))
        if over.max() <= 1.0:
            return trajectory, {}
        flow = np.where(_beside(over > 1.0, keys.keyed), softness, flow)
    return trajectory, _excess(over, keys.keyed)


def _excess(over: Floats, keyed: Flags) -> dict[Pair, float]:
    """The largest factor per pair of keys that follow one another in some hinge."""
    found: dict[Pair, float] = {}
    for row, hinge in np.argwhere(over > 1.0):
        rows = np.flatnonzero(keyed[:, hinge])
        end = int(np.searchsorted(rows, row, side="right"))
        pair = (int(rows[end - 1]), int(rows[end]))
        found[pair] = max(found.get(pair, 1.0), float(over[row, hinge]))
    return found


def _beside(over: Flags, keyed: Flags) -> Flags:
    """Keys (m, n) at either end of a piece of their hinge that is over its limit (m - 1, n)."""
    beside = np.zeros_like(keyed)
    for hinge in np.flatnonzero(over.any(axis=0)):
        rows = np.flatnonzero(keyed[:, hinge])
        ends = np.searchsorted(rows, np.flatnonzero(over[:, hinge]), side="right")
        beside[rows[ends - 1], hinge] = True
        beside[rows[ends], hinge] = True
    return beside


def _ratios(trajectory: Trajectory, limits: Limits) -> tuple[Floats, Floats]:
    """Per piece and hinge, the peak of speed and of acceleration over their limits, (m, n) each."""
    steps = np.diff(trajectory.breaks)
    c = trajectory.coefficients
    powers = np.stack([np.outer(steps, SAMPLES) ** k for k in range(4, -1, -1)])  # (5, m, samples)
    speeds = np.einsum("kms,kmn->smn", powers, c[:5] * np.array([5, 4, 3, 2, 1])[:, None, None])
    speed = np.abs(speeds).max(axis=0) * SAMPLING_RESERVE
    return speed / limits.speed, _peak_acceleration(c, steps) / limits.acceleration


def _peak_acceleration(c: Floats, steps: Floats) -> Floats:
    """(m, n) [rad/s^2]: 20 c0 s^3 + 12 c1 s^2 + 6 c2 s + 2 c3 at the ends of pieces and where its slope is 0."""
    root = np.sqrt(np.maximum((12 * c[1]) ** 2 - 60 * c[0] * 6 * c[2], 0.0))
    flat = np.where(np.abs(c[0]) < FLAT, FLAT, 60 * c[0])
    linear = -6 * c[2] / np.where(np.abs(c[1]) < FLAT, FLAT, 24 * c[1])
    ends = np.broadcast_to(steps[:, None], c[0].shape)
    places = [0.0 * ends, ends, (-12 * c[1] + root) / flat, (-12 * c[1] - root) / flat, linear]
    inside = [np.clip(place, 0.0, ends) for place in places]
    peaks = [np.abs(((20 * c[0] * s + 12 * c[1]) * s + 6 * c[2]) * s + 2 * c[3]) for s in inside]
    return np.asarray(np.max(peaks, axis=0))
