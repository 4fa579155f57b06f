"""The desired motion: one quintic spline per hinge through its own keys, whatever the servos can do.

Speeds at keys are those of a Kochanek-Bartels spline, held back where nobody asks for a swing (D. Kochanek and R.
Bartels, Interpolating splines with local tension, continuity, and bias control, SIGGRAPH 1984). Between uneven
times the speed on each chord weighs as the time of the other, so that keys on a parabola are passed along it: a
circle through uneven keys strays by a tenth of what it does with the mean over both.

Easings change the ways between keys: as much as is asked, as far as the limits allow. All hinges with the same
keys are eased alike, so that a hand keeps its path; a steepness that one of them cannot follow is lowered for all.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from math import ceil

import numpy as np

from kinesic.body.arrays import Flags, Floats, seal_own, sealed
from kinesic.body.limits import Limits
from kinesic.motion.easing import OVERSHOOT, PARTS, Easing, soften_easing
from kinesic.motion.keys import EASINGS, EVEN, HOLD, SMOOTHEST, SOFTEST, Choices, Keys, flow
from kinesic.motion.piecewise import QuinticSpline

Hinges = tuple[int, ...]  # in joint order
_Asked = tuple[tuple[Easing, float, float], ...]  # easing, overshoot and steepness of each hinge

LARGEST_SWING = (
    0.05  # [rad] beyond its keys that any hinge may swing to pass them smoothly: what conditioning allows, too
)
BULGE = 5.0  # speed, in distance / duration, that a quintic may have beside a still key to swing out by the distance
BOW = 58.0  # acceleration, in distance / duration^2, that it may have for the same
HULL = 2.5  # speed, in distance / duration, that keeps the control points of a quintic within the distance
STEEPEST = 2.0  # speed, in shares of the slower chord, with which a hinge stays between its keys
TURNING_ACCELERATION = (
    6.0  # acceleration, in distance / duration^2, with which a hinge comes to a key and turns back without a swing
)
GRADE = 0.25  # of the steepness
LEAST_OVERSHOOT = 0.02  # of a way; with less room OutQuart takes the place of OutBack
FINEST = 0.01  # of a way, steps of the overshoot
ROUNDING = 1e-6  # of such a step
CURVES_KEPT = 24  # curves of hinges with the same keys
MOST_CURVE_KEYS = 1024  # keys of a curve that is remembered, of all its hinges: 0.4 MB, half a minute of gestures
EASING_ROOM = (
    3.0  # times the limits that an eased way may take: what is beyond them is rounded off without leaving the path
)

SHARES = np.arange(PARTS) / PARTS  # of a way, at which an easing is given


@dataclass(frozen=True, eq=False)
class _Course:
    """Keys (k, h) of some hinges, at times that all of them have, and what lies between them."""

    keys: Keys
    steps: Floats  # (k - 1, 1) [s]
    ways: Floats  # (k - 1, h) [rad]
    flow: Floats  # (k - 2, h) how much of its speed a hinge keeps at each inner key
    resting: Flags  # (k - 2, h) whether it is still before or after each of them

    @classmethod
    def of(cls, times: Floats, keys: Keys) -> "_Course":
        steps, ways = (times[1:] - times[:-1])[:, None], keys.angles[1:] - keys.angles[:-1]
        still = np.abs(ways) < HOLD
        tension, continuity, swing = keys.manner[[0, 1, 5], 1:-1]
        return cls(keys, steps, ways, flow(tension, continuity, swing), still[:-1] | still[1:])


def _choose_speeds(course: _Course) -> Floats:
    """Chooses the speeds (k, h) [rad/s] at the keys of some hinges.

    Zero at the ends and beside holds. A speed that would swing the hinge past its keys by more than `LARGEST_SWING` is
    cut, unless the tension is negative or the key has a swing: at -1 and 1 only the ends of the range cut it.
    """
    keys, steps, ways = course.keys, course.steps, course.ways
    found = np.zeros_like(keys.angles)
    tension, _, bias = keys.manner[:3, 1:-1]
    before, after = ways[:-1], ways[1:]
    earlier, later = before / steps[:-1] * steps[1:], after / steps[1:] * steps[:-1]
    free = course.flow * ((1 + bias) * earlier + (1 - bias) * later) / (steps[:-1] + steps[1:])
    slower = np.minimum(np.abs(before) / steps[:-1], np.abs(after) / steps[1:])
    inside = np.where(before * after < 0.0, 0.0, STEEPEST * slower)
    smooth = BULGE * LARGEST_SWING / np.maximum(steps[:-1], steps[1:])
    below, above = keys.angles[1:-1] - keys.limits.lower, keys.limits.upper - keys.angles[1:-1]
    upward, downward = (
        HULL * np.minimum(ahead / steps[1:], behind / steps[:-1]) for ahead, behind in ((above, below), (below, above))
    )
    room = np.where(free > 0.0, upward, downward)
    kept = np.maximum(inside, np.minimum(smooth, room))
    opened = np.minimum(np.maximum(-tension, 0.0) + keys.manner[5, 1:-1], 1.0)
    bound = kept + opened * np.maximum(room - kept, 0.0)
    found[1:-1] = np.where(course.resting, 0.0, np.minimum(np.maximum(free, -bound), bound))
    return found


def _choose_accelerations(course: _Course, passed: Floats) -> Floats:
    """Chooses the accelerations (k, h) [rad/s^2] at the keys: the mean of what cubics have before and after a key.

    So keys that lie on a smooth curve are passed along it. Zero at the ends, beside holds, and where a hinge stops.
    """
    steps, ways, found = course.steps, course.ways, np.zeros_like(passed)
    ends = (-6 * ways + steps * (2 * passed[:-1] + 4 * passed[1:])) / steps**2
    begins = (6 * ways - steps * (4 * passed[:-1] + 2 * passed[1:])) / steps**2
    bends = np.abs(ways) / steps**2
    longer = np.maximum(steps[:-1], steps[1:])
    bound = np.maximum(TURNING_ACCELERATION * np.minimum(bends[:-1], bends[1:]), BOW * LARGEST_SWING / longer**2)
    middle = np.minimum(course.flow, 1.0) * (ends[:-1] + begins[1:]) / 2
    found[1:-1] = np.where(course.resting, 0.0, np.minimum(np.maximum(middle, -bound), bound))
    return found


def _ease(left: Floats, states: Floats, steps: Floats, keys: Keys) -> Floats:
    """Computes (3, k, h, p) what easings add to angles, speeds and accelerations along k ways of h hinges.

    Args:
        left: (k, h) [rad] of each way, what is eased.
        states: (3, k, h, p) angles, speeds and accelerations without easings, at even shares of each way.
        steps: (k,) [s] of the ways.
        keys: (k + 1, h) at their ends.
    """
    found = np.zeros_like(states)
    room = np.where(left > 0.0, keys.limits.upper - keys.angles[1:], keys.angles[1:] - keys.limits.lower)
    shares = np.minimum(OVERSHOOT, room / np.maximum(np.abs(left), 1e-9))
    steepness, easings = keys.manner[3:5, 1:]
    moved = (easings != SMOOTHEST) & (left != 0.0)
    limits = keys.limits
    most = np.stack([limits.speed, limits.acceleration, limits.duty, limits.inertial, limits.viscous])
    for k in np.flatnonzero(moved.any(axis=1)).tolist():
        hinges = np.flatnonzero(moved[k])
        scales = left[k, hinges] / (steps[k] ** np.arange(3))[:, None]
        rows = (easings[k, hinges].astype(np.intp), shares[k, hinges], steepness[k, hinges])
        asked = tuple(
            (*_easing(EASINGS[easing], share), steep)
            for easing, share, steep in zip(*(row.tolist() for row in rows), strict=True)
        )
        plain, bounds = states[:, k, hinges], most[:, hinges]
        for added in _offers(asked):
            change = scales[:, :, None] * added
            if _allowed(plain + change, bounds):
                found[:, k, hinges] = change
                break
    return found


def _easing(easing: Easing, room: float) -> tuple[Easing, float]:
    """An easing and its overshoot, where there is room for a share of the way."""
    if easing == "out_back" and room < LEAST_OVERSHOOT:
        return "out_quart", OVERSHOOT
    return easing, FINEST * int(room / FINEST + ROUNDING) if easing == "out_back" else OVERSHOOT


def _offers(asked: _Asked) -> Iterator[Floats]:
    """(3, h, p) what the easings of some hinges add to minimum jerk, from as steep as is asked to ever softer."""
    steepest = max(steepness for _, _, steepness in asked)
    for tries in range(ceil((steepest - SOFTEST) / GRADE)):
        yield _changes(asked, GRADE * tries)


@lru_cache(maxsize=512)
def _changes(asked: _Asked, softer: float) -> Floats:
    """(3, h, p) what they add, so much softer than is asked."""
    return sealed(np.stack([_change(*row[:2], max(row[2] - softer, SOFTEST)) for row in asked], axis=1))


@lru_cache(maxsize=4096)
def _change(easing: Easing, overshoot: float, steepness: float) -> Floats:
    """(3, p) what an easing adds to minimum jerk, its speed and its acceleration."""
    if steepness <= (EVEN if easing == "linear" else SOFTEST):
        easing, steepness = "minimum_jerk", SOFTEST
    return sealed((soften_easing(easing, steepness, overshoot) - soften_easing("minimum_jerk", SOFTEST))[:, :-1])


def _allowed(states: Floats, most: Floats) -> bool:
    """Whether (3, h, p) angles, speeds and accelerations of hinges keep the limits of speed, acceleration and duty.

    Args:
        states: of the hinges.
        most: (5, h) these limits, and the shares of the duty per acceleration and per speed.
    """
    inertial, viscous = most[3:, :, None]
    taken = np.stack([states[1], states[2], inertial * states[2] + viscous * states[1]])
    return bool((np.abs(taken).max(axis=2) <= EASING_ROOM * most[:3]).all())


@dataclass(frozen=True, eq=False)
class DesiredMotion:
    """The desired angles over performance time; at rest before the start and after the end."""

    # Of hinges with the same keys, over performance time, all from 0 to the same end.
    curves: Mapping[Hinges, QuinticSpline]
    zero: float  # [s] performance time of the block's zero

    @property
    def duration(self) -> float:
        """[s]."""
        return float(next(iter(self.curves.values())).times[-1])

    def sample(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Angles, speeds and accelerations, each (m, n), at (m,) performance times."""
        still = (times < 0.0) | (times > self.duration)
        angles, speeds, accelerations = self._derivatives(times, 3)
        speeds[still] = 0.0
        accelerations[still] = 0.0
        return angles, speeds, accelerations

    def angles(self, times: Floats) -> Floats:
        """(m, n) [rad] at (m,) performance times: the first part of `sample` alone."""
        angles: Floats = self._derivatives(times, 1)[0]
        return angles

    def _derivatives(self, times: Floats, count: int) -> Floats:
        """(count, m, n)."""
        inside = np.clip(times, 0.0, self.duration)
        found = np.empty((count, len(times), sum(map(len, self.curves))))
        for hinges, curve in self.curves.items():
            found[:, :, hinges] = curve.derivatives(inside, count)
        return found


def join_keys(times: Floats, keys: Keys, *, zero: float = 0.0) -> DesiredMotion:
    """Joins the keys of each hinge by quintics that are smooth up to the acceleration.

    Speeds at keys are the tangents of a non-uniform Kochanek-Bartels spline, each key with its own tension, continuity
    bias and swing; they are zero at the ends and beside holds, and carry a hinge beyond its keys only where its tension
    is negative or it swings, and only as far as its range goes. Easings move what the speeds at keys leave of a way.

    Args:
        times: (m,) [s] of the keys, increasing from key to key of each hinge.
        keys: what is passed, and how; all hinges have a key in the first and the last row.
        zero: [s] the time among `times` that is the block's zero.

    Returns:
        The motion; performance time starts at the first key.
    """
    together: dict[bytes, list[int]] = {}
    for hinge, column in enumerate(keys.keyed.T):
        together.setdefault(column.tobytes(), []).append(hinge)
    curves = {}
    for hinges in together.values():
        rows = np.flatnonzero(keys.keyed[:, hinges[0]])
        curves[tuple(hinges)] = _curve(_Ways.of(times[rows] - times[0], keys, rows, np.array(hinges)))
    return DesiredMotion(curves, zero - float(times[0]))


@dataclass(frozen=True)
class _Ways:
    """Everything on which the curve of hinges with the same keys depends: the key under which it is remembered."""

    told: tuple[bytes, ...]  # (k,) times, (k, h) angles, (6, k, h) manner and (h,) hinges
    limits: Limits  # of all hinges
    asked: tuple[Floats, Keys, Choices, Choices] = field(compare=False)  # times, all keys, whose rows and hinges

    @classmethod
    def of(cls, times: Floats, keys: Keys, rows: Choices, hinges: Choices) -> "_Ways":
        angles, manner = keys.angles[rows[:, None], hinges], keys.manner[:, rows[:, None], hinges]
        told = (times.tobytes(), angles.tobytes(), manner.tobytes(), hinges.tobytes())
        return cls(told, keys.limits, (times, keys, rows, hinges))


def _curve(ways: _Ways) -> QuinticSpline:
    """Returns the curve through the keys of some hinges; short ones are remembered, as most stay when others change."""
    _, _, rows, hinges = ways.asked
    return _remember(ways) if len(rows) * len(hinges) <= MOST_CURVE_KEYS else _draw(ways)


def _draw(ways: _Ways) -> QuinticSpline:
    times, keys, rows, hinges = ways.asked
    return _join(times, keys.part(rows, hinges))


_remember = lru_cache(maxsize=CURVES_KEPT)(_draw)


def _join(times: Floats, keys: Keys) -> QuinticSpline:
    """Joins hinges that all have the same keys, at (k,) times."""
    course = _Course.of(times, keys)
    steps, passed = course.steps[:, 0], _choose_speeds(course)
    plain = QuinticSpline(sealed(times), sealed([keys.angles, passed, _choose_accelerations(course, passed)]))
    if np.all(keys.manner[4, 1:] == SMOOTHEST):
        return plain
    ways, carried = course.ways, course.steps * (passed[:-1] + passed[1:]) / 2
    left = np.where((ways - carried) * ways > 0.0, ways - carried, 0.0)
    fine = np.append((times[:-1, None] + steps[:, None] * SHARES).ravel(), times[-1])
    states = plain.derivatives(fine, 3)
    along = states[:, :-1].reshape(3, len(steps), PARTS, -1).transpose(0, 1, 3, 2)
    added = _ease(left, along, steps, keys)
    states[:, :-1] += added.transpose(0, 1, 3, 2).reshape(3, len(fine) - 1, -1)
    return QuinticSpline(seal_own(fine), seal_own(states))
