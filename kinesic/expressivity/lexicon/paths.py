"""Paths of the hand from one stroke key to the next: lines, arcs, circles, waves, spirals and free points (thesis 8.4).

Along each axis a path adds f(t) = A s(t) sin(2 pi (F t' + shift)) to the straight way, less what f is at both ends, so
that the hand leaves and arrives exactly where its keys are. The thesis writes R sin(T pi t + Shift): R is A, T is 2 F.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from math import ceil, inf
from typing import Literal

import numpy as np
import scipy

from kinesic.body.arrays import Floats, sealed

PathKind = Literal["line", "arc", "circle", "wave", "spiral", "points"]
SizeTrend = Literal["none", "grows", "shrinks"]

MOST_TURNS = 12.0  # of one stroke

_QUARTERS = 4  # of a turn: where the fastest axis is at rest or farthest out, and so must be sampled
_DEPTH = 6  # times that a piece is halved at most
_FINE = 400  # steps along free points, to go along them evenly
_STILL = 1e-9
_VARIED: Mapping[SizeTrend, Callable[[Floats], Floats]] = {
    "none": np.ones_like,
    "grows": lambda t: t,
    "shrinks": lambda t: 1.0 - t,
}
# Greta's 1 - sqrt(1 - t) and sqrt(t) are infinitely fast at one end, which no servo follows: these stay below 2 F.
_TURNED: Mapping[SizeTrend, Callable[[Floats], Floats]] = {
    "none": lambda t: t,
    "grows": lambda t: t**2,
    "shrinks": lambda t: t * (2.0 - t),
}


@dataclass(frozen=True, eq=False)
class HandPath:
    """How a hand comes to a key; axes and unit are those of the positions that it joins."""

    kind: PathKind
    amplitude: Floats  # (3,)
    frequency: Floats  # (3,) turns on the whole way
    shift: Floats  # (3,) turns
    amplitude_variation: SizeTrend = "none"
    frequency_variation: SizeTrend = "none"
    points: Floats = field(default_factory=lambda: sealed(np.empty((0, 3))))  # (p, 3) positions on the way

    @property
    def turns(self) -> float:
        """Turns of the fastest axis that moves."""
        return float(np.max(self.frequency * (np.abs(self.amplitude) > _STILL)))

    def at(self, start: Floats, end: Floats, shares: Floats) -> Floats:
        """Finds (m, 3) positions at (m,) shares 0..1 of the way from a (3,) start to a (3,) end."""
        t = np.asarray(shares)[:, None]
        base = self._through(start, end, t[:, 0]) if len(self.points) else start + t * (end - start)
        first, last = self._swing(np.array([[0.0], [1.0]]))
        return np.asarray(base + self._swing(t) - (1 - t) * first - t * last)

    def length(self, start: Floats, end: Floats) -> float:
        """Measures the way of the hand along the path, from a (3,) start to a (3,) end."""
        return float(np.linalg.norm(self._steps(start, end), axis=1).sum())

    def swings(self, start: Floats, end: Floats) -> int:
        """Counts how often the hand goes one way before it turns round: half turns, at least one."""
        if not len(self.points):
            return max(1, ceil(2 * self.turns - _STILL))
        steps = self._steps(start, end)
        moving = steps[np.linalg.norm(steps, axis=1) > _STILL]
        along = moving / np.linalg.norm(moving, axis=1)[:, None]
        turned = np.arccos(np.clip(np.sum(along[:-1] * along[1:], axis=1), -1.0, 1.0)).sum()
        return max(1, round(float(turned / np.pi)))

    def slowed(self, turns: float) -> "HandPath":
        """Slows the path down to fewer turns on the way."""
        return self if self.turns <= turns else replace(self, frequency=sealed(self.frequency * turns / self.turns))

    def mapped(self, amplitude: Floats, moved: Callable[[Floats], Floats]) -> "HandPath":
        """Gives the path another (3,) amplitude, and moves its points by a function from (3,) to (3,)."""
        points = sealed(np.array([moved(point) for point in self.points]).reshape(-1, 3))
        return replace(self, amplitude=sealed(amplitude), points=points)

    def samples(self, start: Floats, end: Floats, tolerance: float, longest: float = inf) -> Floats:
        """Finds (m,) shares, without 0 and 1, between which the path is short, and straight to within a tolerance.

        Args:
            start: (3,).
            end: (3,).
            tolerance: greatest distance of the path from where the hand would be if it went straight.
            longest: distance between two samples.
        """
        knots = self._quarters()
        for _ in range(_DEPTH):
            inner = knots[:-1, None] + np.diff(knots)[:, None] * np.array([0.25, 0.5, 0.75])
            curve = self.at(start, end, inner.ravel()).reshape(-1, 3, 3)
            ends = self.at(start, end, knots)
            chords = ends[:-1, None] + np.array([0.25, 0.5, 0.75])[:, None] * np.diff(ends, axis=0)[:, None]
            bent = np.linalg.norm(curve - chords, axis=2).max(axis=1) > tolerance
            split = bent | (np.linalg.norm(np.diff(ends, axis=0), axis=1) > longest)
            if not split.any():
                break
            knots = np.sort(np.concatenate([knots, inner.reshape(-1, 3)[split, 1]]))
        return sealed(knots[1:-1])

    def _steps(self, start: Floats, end: Floats) -> Floats:
        """(m, 3) small steps from start to end."""
        count = 64 * ceil(1 + 2 * self.turns + len(self.points))
        return np.diff(self.at(start, end, np.linspace(0.0, 1.0, count + 1)), axis=0)

    def _quarters(self) -> Floats:
        """Shares at which the fastest axis passes a quarter of a turn, with both ends."""
        moving = self.frequency * (np.abs(self.amplitude) > _STILL)
        axis = int(np.argmax(moving))
        if moving[axis] <= 0:
            return np.array([0.0, 1.0])
        fine = np.linspace(0.0, 1.0, 2001)
        phase = _QUARTERS * (self.frequency[axis] * _TURNED[self.frequency_variation](fine) + self.shift[axis])
        whole = np.arange(np.ceil(phase[0] + 1e-3), phase[-1] - 1e-3)
        return np.concatenate([[0.0], np.interp(whole, phase, fine), [1.0]])

    def _swing(self, t: Floats) -> Floats:
        """(m, 3) of f at (m, 1) shares."""
        phase = self.frequency * _TURNED[self.frequency_variation](t) + self.shift
        return np.asarray(self.amplitude * _VARIED[self.amplitude_variation](t) * np.sin(2 * np.pi * phase))

    def _through(self, start: Floats, end: Floats, shares: Floats) -> Floats:
        """(m, 3) along a smooth curve through the points, at even speed."""
        every = np.vstack([start, self.points, end])
        every = every[np.concatenate([[True], np.linalg.norm(np.diff(every, axis=0), axis=1) > _STILL])]
        if len(every) < 2:
            return np.repeat(every, len(shares), axis=0)
        knots = np.concatenate([[0.0], np.cumsum(np.sqrt(np.linalg.norm(np.diff(every, axis=0), axis=1)))])
        curve, fine = (
            scipy.interpolate.CubicSpline(knots, every, bc_type="natural"),
            np.linspace(0.0, knots[-1], _FINE + 1),
        )
        ways = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(curve(fine), axis=0), axis=1))])
        return np.asarray(curve(np.interp(shares * ways[-1], ways, fine)))


@dataclass(frozen=True)
class _Shape:
    """What a kind of path is when nothing else is said."""

    amplitude: tuple[float, float, float]  # outward, up, forward [arm lengths]
    frequency: float  # turns
    crossed: bool = False  # the second axis that moves is a quarter of a turn ahead
    variation: SizeTrend = "none"


_SHAPES: Mapping[PathKind, _Shape] = {
    "line": _Shape((0.0, 0.0, 0.0), 0.0),
    "arc": _Shape((0.0, 0.12, 0.0), 0.5),
    "circle": _Shape((0.12, 0.12, 0.0), 1.0, crossed=True),
    "wave": _Shape((0.12, 0.0, 0.0), 2.0),
    "spiral": _Shape((0.15, 0.15, 0.0), 2.0, crossed=True, variation="grows"),
    "points": _Shape((0.0, 0.0, 0.0), 0.0),
}

Three = tuple[float, float, float]


def shape_path(
    kind: PathKind,
    *,
    amplitude: float | Three | None = None,
    frequency: float | Three | None = None,
    shift: float | Three | None = None,
    variations: tuple[SizeTrend | None, SizeTrend] = (None, "none"),
    points: tuple[Floats, ...] = (),
) -> HandPath:
    """Makes a path in gesture space; what is left out is as usual for its kind.

    Args:
        kind: its shape.
        amplitude: outward, up, forward [arm lengths], or one number for the axes that are usual.
        frequency: turns on the whole way, of each axis or of all.
        shift: turns, of each axis or of all.
        variations: of amplitude and of frequency along the way.
        points: each (3,) forward, outward, up [arm lengths].

    Raises:
        ValueError: a number out of range, or one that the kind has no use for.
    """
    shape = _SHAPES[kind]
    if kind in ("line", "points") and not amplitude is frequency is shift is None:
        raise ValueError(f"a {kind} path has no amplitude, frequency or shift; arc, circle, wave and spiral have")
    if (kind == "points") != bool(points):
        have = "has no points, give at least one as [outward, up, forward]" if kind == "points" else "has points"
        raise ValueError(f"a {kind} path {have}; kind = 'points' goes through points")
    size = np.array(amplitude if isinstance(amplitude, tuple) else shape.amplitude)
    if isinstance(amplitude, float):
        size = amplitude * (size > 0)
    turns = np.full(3, shape.frequency if frequency is None else frequency)
    ahead = np.zeros(3) if shift is None else np.full(3, shift)
    if shift is None and shape.crossed:
        ahead[np.flatnonzero(size)[1:2]] = 0.25
    _check(kind, size, turns)
    return HandPath(
        kind,
        _own(size),
        _own(turns),
        _own(ahead),
        variations[0] or shape.variation,
        variations[1],
        sealed(np.array(points).reshape(-1, 3)),
    )


def _check(kind: PathKind, amplitude: Floats, frequency: Floats) -> None:
    if not np.isfinite(amplitude).all() or np.abs(amplitude).max() > 1.0:
        raise ValueError(f"amplitude is {_listed(amplitude)}, outside [-1, 1] arm lengths")
    if not np.isfinite(frequency).all() or frequency.min() < 0 or frequency.max() > MOST_TURNS:
        raise ValueError(f"frequency is {_listed(frequency)}, outside [0, {MOST_TURNS:g}] turns on the way")
    if kind in ("arc", "circle", "wave", "spiral") and not np.any(amplitude * frequency):
        raise ValueError(f"a {kind} path without amplitude or frequency is a line; write kind = 'line'")


def _listed(values: Floats) -> str:
    return "[" + ", ".join(f"{value:g}" for value in values) + "]"


def _own(greta: Floats) -> Floats:
    """(3,) outward, up, forward as forward, outward, up."""
    return sealed(np.array([greta[2], greta[0], greta[1]]))
