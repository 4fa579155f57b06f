"""Desired motion: quintic splines through the keys, ignoring servo limits.

Velocities at keys are those of a Kochanek-Bartels spline, bounded unless a key has a swing (D. Kochanek and R. Bartels,
Interpolating splines with local tension, continuity, and bias control, SIGGRAPH 1984). Between uneven times, each
chord's velocity is weighted by the duration of the other chord, so that keys on a parabola are passed along it. A
circle through uneven keys then has a tenth of the error of the mean over both.

Easings change the motion between keys, as far as the limits allow. All hinges with the same keys use the same
steepness, so that a hand keeps its path: a steepness that one of them cannot follow is lowered for all.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from math import ceil

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, seal_in_place, sealed
from kinesic.body.limits import Limits
from kinesic.motion.easing import DEFAULT_OVERSHOOT, EASING_INTERVALS, Easing, soften_easing
from kinesic.motion.keys import (
    EASING_NAMES,
    HOLD_TOLERANCE,
    LINEAR_STEEPNESS,
    MIN_STEEPNESS,
    SMOOTHEST_EASING,
    Keys,
    flow,
)
from kinesic.motion.piecewise import QuinticSpline

Hinges = tuple[int, ...]  # hinge indices in joint order
_EasingRows = tuple[tuple[Easing, float, float], ...]  # easing, overshoot and steepness of each hinge

MAX_SWING = 0.05  # [rad] largest overshoot beyond a key without `swing`, within the joint range
OVERSHOOT_VELOCITY = 5.0  # key velocity * interval duration / overshoot of the quintic beyond the key
OVERSHOOT_ACCELERATION = 58.0  # key acceleration * interval duration^2 / overshoot of the quintic beyond the key
HULL_VELOCITY = 2.5  # key velocity bound * interval duration / control points' distance to the joint limit
MONOTONE_VELOCITY = 2.0  # largest key velocity without overshoot / mean velocity of the slower interval
TURNING_ACCELERATION = 6.0  # largest key acceleration without overshoot * interval duration^2 / rotation
STEEPNESS_STEP = 0.25  # decrement of an easing's steepness, applied until the eased motion is allowed
MIN_OVERSHOOT = 0.02  # relative overshoot below which OutQuart replaces OutBack
OVERSHOOT_STEP = 0.01  # resolution of the relative overshoot
BOUNCE_INDEX = EASING_NAMES.index("out_bounce")  # index of the easing that bounces at the key
OVERSHOOT_INDEX = EASING_NAMES.index("out_back")  # index of the easing that passes the key and returns
STEP_TOLERANCE = 1e-6  # rounding tolerance, in units of `OVERSHOOT_STEP`
CURVE_CACHE_SIZE = 24  # largest number of cached desired curves, each of hinges with the same keys
MAX_CACHED_KEYS = 1024  # largest number of key angles of a cached curve: 0.4 MB, half a minute of gestures
MAX_EASED_RATIO = 3.0  # largest velocity, acceleration or duty of an eased motion / its limit

SAMPLE_TIMES = np.arange(EASING_INTERVALS) / EASING_INTERVALS  # normalised times at which an easing is sampled


@dataclass(frozen=True, eq=False)
class _Course:
    """Keys of hinges that have the same key times, shape (k, h)."""

    keys: Keys
    steps: Floats  # (k - 1, 1) [s]
    rotations: Floats  # (k - 1, h) [rad]
    flow: Floats  # (k - 2, h) fraction of the velocity kept at each inner key
    is_resting: Flags  # (k - 2, h) whether the hinge holds before or after each inner key

    @classmethod
    def of(cls, times: Floats, keys: Keys) -> "_Course":
        steps, rotations = (times[1:] - times[:-1])[:, None], keys.angles[1:] - keys.angles[:-1]
        is_hold = np.abs(rotations) < HOLD_TOLERANCE
        tension, continuity, swing = keys.passage_values[[0, 1, 5], 1:-1]
        return cls(keys, steps, rotations, flow(tension, continuity, swing), is_hold[:-1] | is_hold[1:])


def _choose_velocities(course: _Course) -> Floats:
    """Return the velocities (k, h) [rad/s] at the keys of some hinges.

    Zero at the ends and at holds. A velocity that would make the hinge overshoot its keys by more than `MAX_SWING` is
    reduced, unless the tension is negative or the key has a swing: at -1 and 1 only the ends of the range bound it.
    """
    keys, steps, rotations = course.keys, course.steps, course.rotations
    velocities = np.zeros_like(keys.angles)
    tension, _, bias = keys.passage_values[:3, 1:-1]
    before, after = rotations[:-1], rotations[1:]
    earlier, later = before / steps[:-1] * steps[1:], after / steps[1:] * steps[:-1]
    free = course.flow * ((1 + bias) * earlier + (1 - bias) * later) / (steps[:-1] + steps[1:])
    slower = np.minimum(np.abs(before) / steps[:-1], np.abs(after) / steps[1:])
    inside = np.where(before * after < 0.0, 0.0, MONOTONE_VELOCITY * slower)
    smooth = OVERSHOOT_VELOCITY * MAX_SWING / np.maximum(steps[:-1], steps[1:])
    below, above = keys.angles[1:-1] - keys.limits.lower, keys.limits.upper - keys.angles[1:-1]
    upward, downward = (
        HULL_VELOCITY * np.minimum(ahead / steps[1:], behind / steps[:-1])
        for ahead, behind in ((above, below), (below, above))
    )
    range_bound = np.where(free > 0.0, upward, downward)
    usual_bound = np.maximum(inside, np.minimum(smooth, range_bound))
    widening = np.minimum(np.maximum(-tension, 0.0) + keys.passage_values[5, 1:-1], 1.0)
    bound = usual_bound + widening * np.maximum(range_bound - usual_bound, 0.0)
    velocities[1:-1] = np.where(course.is_resting, 0.0, np.minimum(np.maximum(free, -bound), bound))
    return velocities


def _choose_accelerations(course: _Course, velocities: Floats) -> Floats:
    """Return accelerations at the keys, averaged from the adjacent cubic curves.

    Of shape (k, h) [rad/s^2]. Keys on a smooth curve are passed along it. Zero at the ends, at holds, and where a hinge
    stops.
    """
    steps, rotations, accelerations = course.steps, course.rotations, np.zeros_like(velocities)
    ends = (-6 * rotations + steps * (2 * velocities[:-1] + 4 * velocities[1:])) / steps**2
    begins = (6 * rotations - steps * (4 * velocities[:-1] + 2 * velocities[1:])) / steps**2
    bends = np.abs(rotations) / steps**2
    longer = np.maximum(steps[:-1], steps[1:])
    bound = np.maximum(
        TURNING_ACCELERATION * np.minimum(bends[:-1], bends[1:]), OVERSHOOT_ACCELERATION * MAX_SWING / longer**2
    )
    middle = np.minimum(course.flow, 1.0) * (ends[:-1] + begins[1:]) / 2
    accelerations[1:-1] = np.where(course.is_resting, 0.0, np.minimum(np.maximum(middle, -bound), bound))
    return accelerations


def _ease(remaining: Floats, states: Floats, steps: Floats, keys: Keys) -> Floats:
    """Return offsets that easings add to angles, velocities and accelerations.

    Of shape (3, k, h, p): k key intervals, h hinges, p sample times.

    Args:
        remaining: (k, h) [rad] part of each rotation that is eased.
        states: (3, k, h, p) angles, velocities and accelerations without easings, at even fractions of each interval.
        steps: (k,) [s] durations of the intervals.
        keys: (k + 1, h) at their ends.
    """
    changes = np.zeros_like(states)
    margins = np.where(remaining > 0.0, keys.limits.upper - keys.angles[1:], keys.angles[1:] - keys.limits.lower)
    overshoots = np.minimum(DEFAULT_OVERSHOOT, margins / np.maximum(np.abs(remaining), 1e-9))
    steepness, easings = keys.passage_values[3:5, 1:]
    is_eased = (easings != SMOOTHEST_EASING) & (remaining != 0.0)
    limits = keys.limits
    limit_rows = np.stack([limits.speed, limits.acceleration, limits.duty, limits.inertial, limits.viscous])
    for k in np.flatnonzero(is_eased.any(axis=1)).tolist():
        hinges = np.flatnonzero(is_eased[k])
        scales = remaining[k, hinges] / (steps[k] ** np.arange(3))[:, None]
        rows = (easings[k, hinges].astype(np.intp), overshoots[k, hinges], steepness[k, hinges])
        requested = tuple(
            (*_adapt_easing(EASING_NAMES[easing], overshoot), steep)
            for easing, overshoot, steep in zip(*(row.tolist() for row in rows), strict=True)
        )
        plain, bounds = states[:, k, hinges], limit_rows[:, hinges]
        for unit_change in _soften_stepwise(requested):
            change = scales[:, :, None] * unit_change
            if _is_allowed(plain + change, bounds):
                changes[:, k, hinges] = change
                break
    return changes


def _adapt_easing(easing: Easing, max_overshoot: float) -> tuple[Easing, float]:
    """Limit the overshoot of OutBack, or replace OutBack by OutQuart."""
    if easing == "out_back" and max_overshoot < MIN_OVERSHOOT:
        return "out_quart", DEFAULT_OVERSHOOT
    return easing, OVERSHOOT_STEP * int(
        max_overshoot / OVERSHOOT_STEP + STEP_TOLERANCE
    ) if easing == "out_back" else DEFAULT_OVERSHOOT


def _soften_stepwise(requested: _EasingRows) -> Iterator[Floats]:
    """Yield differences of ever less steep easing curves from minimum jerk.

    Each has shape (3, h, p).
    """
    steepest = max(steepness for _, _, steepness in requested)
    for count in range(ceil((steepest - MIN_STEEPNESS) / STEEPNESS_STEP)):
        yield _stack_changes(requested, STEEPNESS_STEP * count)


@lru_cache(maxsize=128)
def _stack_changes(requested: _EasingRows, reduction: float) -> Floats:
    """Return softened easings' offsets from the minimum-jerk curve, (3, h, p)."""
    return sealed(np.stack([_change(*row[:2], max(row[2] - reduction, MIN_STEEPNESS)) for row in requested], axis=1))


@lru_cache(maxsize=64)
def _change(easing: Easing, overshoot: float, steepness: float) -> Floats:
    """Return an easing's offset from the minimum-jerk curve with derivatives, (3, p)."""
    if steepness <= (LINEAR_STEEPNESS if easing == "linear" else MIN_STEEPNESS):
        easing, steepness = "minimum_jerk", MIN_STEEPNESS
    return sealed((soften_easing(easing, steepness, overshoot) - soften_easing("minimum_jerk", MIN_STEEPNESS))[:, :-1])


def _is_allowed(states: Floats, limit_rows: Floats) -> bool:
    """Return whether sampled states stay within `MAX_EASED_RATIO` times the limits.

    Args:
        states: of the hinges.
        limit_rows: (5, h) limits of velocity, acceleration and duty, and the duty per acceleration and per velocity.
    """
    inertial, viscous = limit_rows[3:, :, None]
    loads = np.stack([states[1], states[2], inertial * states[2] + viscous * states[1]])
    return bool((np.abs(loads).max(axis=2) <= MAX_EASED_RATIO * limit_rows[:3]).all())


@dataclass(frozen=True, eq=False)
class DesiredMotion:
    """Desired joint angles over time, at rest before and after."""

    # Of hinges with the same keys, over performance time, all from 0 to the same end.
    curves: Mapping[Hinges, QuinticSpline]
    zero: float  # [s] performance time of block time 0

    @property
    def duration(self) -> float:
        """Duration of the motion [s]."""
        return float(next(iter(self.curves.values())).times[-1])

    def sample(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Return angles, velocities and accelerations (m, n) at performance times (m,) [s]."""
        still = (times < 0.0) | (times > self.duration)
        angles, speeds, accelerations = self._derivatives(times, 3)
        speeds[still] = 0.0
        accelerations[still] = 0.0
        return angles, speeds, accelerations

    def angles(self, times: Floats) -> Floats:
        """Return angles (m, n) [rad] at performance times (m,) [s]."""
        angles: Floats = self._derivatives(times, 1)[0]
        return angles

    def _derivatives(self, times: Floats, count: int) -> Floats:
        """Return angles and their derivatives, shape (count, m, n)."""
        inside = np.clip(times, 0.0, self.duration)
        derivatives = np.empty((count, len(times), sum(map(len, self.curves))))
        for hinges, curve in self.curves.items():
            derivatives[:, :, hinges] = curve.derivatives(inside, count)
        return derivatives


def join_keys(times: Floats, keys: Keys, *, zero: float = 0.0) -> DesiredMotion:
    """Interpolate each hinge's keys by quintics with continuous acceleration.

    Velocities at keys are the tangents of a non-uniform Kochanek-Bartels spline with the tension, continuity, bias and
    swing of each key. They are zero at the ends and at holds. A hinge overshoots its keys only with negative tension or
    a swing, and only within its range. Easings redistribute the part of a rotation that these velocities do not cover.

    Args:
        times: (m,) [s] of the keys, increasing from key to key of each hinge.
        keys: with their passages; all hinges have a key in the first and the last row.
        zero: [s] block time 0 on the scale of `times`.

    Returns:
        The motion; performance time starts at the first key.
    """
    hinges_by_keys: dict[bytes, list[int]] = {}
    for hinge, column in enumerate(keys.keyed.T):
        hinges_by_keys.setdefault(column.tobytes(), []).append(hinge)
    curves = {}
    for hinges in hinges_by_keys.values():
        rows = np.flatnonzero(keys.keyed[:, hinges[0]])
        curves[tuple(hinges)] = _make_curve(_CurveKey.of(times[rows] - times[0], keys, rows, np.array(hinges)))
    return DesiredMotion(curves, zero - float(times[0]))


@dataclass(frozen=True)
class _CurveKey:
    """Cache key of an interpolated curve, made of all its inputs."""

    content: tuple[bytes, ...]  # (k,) times, (k, h) angles, (6, k, h) passage values and (h,) hinges
    limits: Limits  # of all hinges
    source: tuple[Floats, Keys, Indices, Indices] = field(compare=False)  # interpolated times, all keys, rows, hinges

    @classmethod
    def of(cls, times: Floats, keys: Keys, rows: Indices, hinges: Indices) -> "_CurveKey":
        angles, passage_values = keys.angles[rows[:, None], hinges], keys.passage_values[:, rows[:, None], hinges]
        content = (times.tobytes(), angles.tobytes(), passage_values.tobytes(), hinges.tobytes())
        return cls(content, keys.limits, (times, keys, rows, hinges))


def _make_curve(curve_key: _CurveKey) -> QuinticSpline:
    """Return the curve through the keys of some hinges, cached if short."""
    _, _, rows, hinges = curve_key.source
    is_short = len(rows) * len(hinges) <= MAX_CACHED_KEYS
    return _interpolate_cached(curve_key) if is_short else _interpolate(curve_key)


def _interpolate(curve_key: _CurveKey) -> QuinticSpline:
    times, keys, rows, hinges = curve_key.source
    return _join(times, keys.part(rows, hinges))


_interpolate_cached = lru_cache(maxsize=CURVE_CACHE_SIZE)(_interpolate)


def _join(times: Floats, keys: Keys) -> QuinticSpline:
    """Interpolate hinges that have the same key times (k,) [s]."""
    course = _Course.of(times, keys)
    steps, velocities = course.steps[:, 0], _choose_velocities(course)
    plain = QuinticSpline(sealed(times), sealed([keys.angles, velocities, _choose_accelerations(course, velocities)]))
    if np.all(keys.passage_values[4, 1:] == SMOOTHEST_EASING):
        return plain
    rotations, covered = course.rotations, course.steps * (velocities[:-1] + velocities[1:]) / 2
    fractions = (rotations - covered) / np.where(rotations == 0.0, 1.0, rotations)
    # An accent of more than the rotation outruns a swing and rebounds, as only a forceful hand does.
    tension, easings = keys.passage_values[[0, 4], 1:]
    rebounds = (easings == BOUNCE_INDEX) | ((easings == OVERSHOOT_INDEX) & (tension < 0.0))
    remaining = rotations * np.clip(fractions, 0.0, np.where(rebounds, np.inf, 1.0))
    sample_times = np.append((times[:-1, None] + steps[:, None] * SAMPLE_TIMES).ravel(), times[-1])
    states = plain.derivatives(sample_times, 3)
    by_interval = states[:, :-1].reshape(3, len(steps), EASING_INTERVALS, -1).transpose(0, 1, 3, 2)
    changes = _ease(remaining, by_interval, steps, keys)
    states[:, :-1] += changes.transpose(0, 1, 3, 2).reshape(3, len(sample_times) - 1, -1)
    return QuinticSpline(seal_in_place(sample_times), seal_in_place(states))
