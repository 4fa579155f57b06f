"""Makes a motion one that the servos can follow: first as asked, then with sync points moved as little as needed.

Position, speed and acceleration limits hold for what is returned; the remedies come in the order of the line:
softer passing of keys, then the times (a linear program on closed-form minimum durations, bisected towards the
asked times), where strokes weigh most and preparations, holds and retractions give.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.optimize import linprog

from kinesic.body.arrays import Flags, Floats
from kinesic.body.limits import Limits
from kinesic.controller.postures import Posture
from kinesic.controller.trajectory import Manner, Trajectory, spline

PEAK_SPEED = 1.875  # of a rest-to-rest quintic, in distance / duration
PEAK_ACCELERATION = 5.7735  # in distance / duration^2
RESERVE = 1.02  # on minimum durations
LEAD_IN = 0.6  # [s] by which the motion may begin before it is asked to
LEAST_GAP = 0.02  # [s] between keys
BISECTIONS = 5
SOFTENINGS = (0.6, 0.3, 0.0, 0.0)  # share of its speed that a key beside a piece over its limit keeps
WEIGHTS = {"strokeStart": 5.0, "stroke": 5.0, "strokeEnd": 5.0, "ready": 0.3, "relax": 0.3}
WEIGHT_ELSE = 0.05
LATENESS = 3.0  # weight of being late over being early
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
    asked = np.array([posture.time for posture in postures])
    angles = np.stack([posture.angles for posture in postures])
    keyed = np.array([posture.keyed for posture in postures])
    wished = _softened(asked, angles, keyed, limits, manner)
    if wished is not None:
        return Conditioned(wished, asked, asked, None)
    first = bottleneck(spline(asked, angles, keyed, manner, np.ones_like(angles), zero=0.0), limits)
    slow = _relaxed(asked, angles, keyed, limits, [posture.syncs for posture in postures], lead_in)
    found, times = _softened(slow, angles, keyed, limits, manner), slow
    if found is None:
        still = np.zeros_like(angles)
        found = spline(slow, angles, keyed, manner, still, zero=0.0)
    low, high = 0.0, 1.0  # share of the way from the asked to the relaxed times
    for _ in range(BISECTIONS):
        share = (low + high) / 2
        between = asked + share * (slow - asked)
        candidate = _softened(between, angles, keyed, limits, manner)
        if candidate is None:
            low = share
        else:
            high, found, times = share, candidate, between
    return Conditioned(found, asked, times, first)


def bottleneck(trajectory: Trajectory, limits: Limits) -> Bottleneck:
    """The largest ratio of speed or acceleration to its limit."""
    speed, acceleration = _ratios(trajectory, limits)
    peaks = {"speed": speed.max(axis=0), "acceleration": acceleration.max(axis=0)}
    quantity: Literal["speed", "acceleration"] = (
        "speed" if peaks["speed"].max() >= peaks["acceleration"].max() else "acceleration"
    )
    hinge = int(peaks[quantity].argmax())
    return Bottleneck(hinge, quantity, float(peaks[quantity][hinge]))


def _softened(times: Floats, angles: Floats, keyed: Flags, limits: Limits, manner: Manner) -> Trajectory | None:
    """The motion at these times, keys passed more slowly where that keeps the limits; None if nothing does."""
    flow = np.ones_like(angles)
    for softness in SOFTENINGS:
        trajectory = spline(times, angles, keyed, manner, flow, zero=0.0)
        speed, acceleration = _ratios(trajectory, limits)
        over = np.maximum(speed, acceleration) > 1.0
        if not over.any():
            return trajectory
        flow = np.where(_beside(over, keyed), softness, flow)
    return None


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


def minimum_duration(distance: Floats, limits: Limits) -> Floats:
    """Shortest rest-to-rest quintic within speed and acceleration, (n,) [s] for (n,) [rad]."""
    size = np.abs(distance)
    return RESERVE * np.maximum(
        PEAK_SPEED * size / limits.speed, np.sqrt(PEAK_ACCELERATION * size / limits.acceleration)
    )


def _relaxed(
    asked: Floats,
    angles: Floats,
    keyed: Flags,
    limits: Limits,
    syncs: list[tuple[tuple[str, str], ...]],
    lead_in: float,
) -> Floats:
    """Key times, as near to the asked ones as minimum durations allow (linear program).

    Variables are t (m,), earliness e- and lateness e+ (m,): t - asked = e+ - e-.
    """
    count = len(asked)
    weight = np.array([max([WEIGHT_ELSE, *(WEIGHTS.get(sync, WEIGHT_ELSE) for _, sync in at)]) for at in syncs])
    gaps = _least_gaps(asked, angles, keyed, limits)
    rows = np.zeros((len(gaps), 3 * count))
    least = np.zeros(len(gaps))
    for row, ((i, j), gap) in enumerate(gaps.items()):
        rows[row, i], rows[row, j] = 1.0, -1.0
        least[row] = -gap
    identity = np.eye(count)
    result = linprog(
        np.concatenate([np.zeros(count), weight, LATENESS * weight]),
        A_ub=rows,
        b_ub=least,
        A_eq=np.hstack([identity, identity, -identity]),
        b_eq=asked,
        bounds=[(asked[0] - lead_in, None)] * count + [(0.0, None)] * (2 * count),
        method="highs",
    )
    return np.array(result.x[:count])


def _least_gaps(asked: Floats, angles: Floats, keyed: Flags, limits: Limits) -> dict[tuple[int, int], float]:
    """Least time between keys i < j: minimum durations of hinges that have a key in both and none between."""
    gaps = {(k, k + 1): min(LEAST_GAP, float(asked[k + 1] - asked[k])) for k in range(len(asked) - 1)}
    last = np.zeros(angles.shape[1], dtype=int)
    for k in range(1, len(asked)):
        for before in np.unique(last[keyed[k]]):
            moved = keyed[k] & (last == before)
            duration = minimum_duration(np.where(moved, angles[k] - angles[before], 0.0), limits).max()
            pair = (int(before), k)
            gaps[pair] = max(float(duration), gaps.get(pair, 0.0))
        last[keyed[k]] = k
    return gaps
