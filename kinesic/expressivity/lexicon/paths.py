"""Hand paths between stroke keys: lines, arcs, circles, waves, spirals, points.

See thesis 8.4. Along each axis a path adds f(t) = A s(t) sin(2 pi (F t' + shift)) to the straight line, minus the
values of f at both ends, so that the hand leaves and arrives exactly at its keys. The thesis writes
R sin(T pi t + Shift): R is A, T is 2 F.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from math import ceil, inf
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.expressivity.lexicon.path_course import PathCourse
from kinesic.motion.natural_spline import natural_spline

PathKind = Literal["line", "arc", "circle", "wave", "spiral", "points"]
SizeTrend = Literal["none", "grows", "shrinks"]

MAX_PERIODS = 12.0  # largest number of periods of one path

_SAMPLES_PER_PERIOD = 4  # samples per period of the fastest axis: its zero crossings and extrema
_MAX_BISECTIONS = 6  # largest number of successive bisections of a path interval
_ARC_LENGTH_STEPS = 400  # number of samples along a path of via points, for a constant hand velocity
_ZERO_LENGTH = 1e-9  # [arm lengths] length below which an amplitude or step counts as zero
_AMPLITUDE_TRENDS: Mapping[SizeTrend, Callable[[Floats], Floats]] = {
    "none": np.ones_like,
    "grows": lambda t: t,
    "shrinks": lambda t: 1.0 - t,
}
# Phase 0..1 over path parameter, by frequency variation. Greta's 1 - sqrt(1 - t) and sqrt(t) have infinite velocity at
# one end; the slopes of these functions are at most 2.
_PHASE_TRENDS: Mapping[SizeTrend, Callable[[Floats], Floats]] = {
    "none": lambda t: t,
    "grows": lambda t: t**2,
    "shrinks": lambda t: t * (2.0 - t),
}


@dataclass(frozen=True, eq=False)
class HandPath:
    """Path of a hand to a stroke key.

    Axes and unit are those of the positions.
    """

    kind: PathKind
    amplitude: Floats  # (3,) amplitude along each axis
    frequency: Floats  # (3,) periods over the whole path
    shift: Floats  # (3,) phase in periods
    amplitude_variation: SizeTrend = "none"
    frequency_variation: SizeTrend = "none"
    points: Floats = field(default_factory=lambda: np.empty((0, 3)))  # (p, 3) via points
    course: PathCourse | None = None  # timing and orientation of a captured path; None: constant velocity

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        for values in (self.amplitude, self.frequency, self.shift, self.points):
            values.setflags(write=False)

    @property
    def turns(self) -> float:
        """Number of periods of the fastest moving axis."""
        return float(np.max(self.frequency * (np.abs(self.amplitude) > _ZERO_LENGTH)))

    def at(self, start: Floats, end: Floats, parameters: Floats) -> Floats:
        """Return positions (m, 3) at (m,) path parameters.

        Args:
            start: (3,) position at parameter 0.
            end: (3,) position at parameter 1.
            parameters: (m,) path parameters, 0..1.
        """
        t = np.asarray(parameters)[:, None]
        base = self._through(start, end, t[:, 0]) if len(self.points) else start + t * (end - start)
        first, last = self._swing(np.array([[0.0], [1.0]]))
        return np.asarray(base + self._swing(t) - (1 - t) * first - t * last)

    def length(self, start: Floats, end: Floats) -> float:
        """Return the arc length from start to end, in the positions' unit."""
        return float(np.linalg.norm(self._steps(start, end), axis=1).sum())

    def swings(self, start: Floats, end: Floats) -> int:
        """Return the number of half periods, at least one.

        With via points it is the total change of direction / pi.
        """
        if not len(self.points):
            return max(1, ceil(2 * self.turns - _ZERO_LENGTH))
        steps = self._steps(start, end)
        moving = steps[np.linalg.norm(steps, axis=1) > _ZERO_LENGTH]
        along = moving / np.linalg.norm(moving, axis=1)[:, None]
        turned = np.arccos(np.clip(np.sum(along[:-1] * along[1:], axis=1), -1.0, 1.0)).sum()
        return max(1, round(float(turned / np.pi)))

    def slowed(self, turns: float) -> "HandPath":
        """Return the path with at most the given number of periods.

        Its amplitude stays the same.
        """
        return self if self.turns <= turns else replace(self, frequency=sealed(self.frequency * turns / self.turns))

    def mapped(
        self,
        amplitude: Floats,
        moved: Callable[[Floats], Floats],
        turned: Callable[[Floats], Floats] | None = None,
    ) -> "HandPath":
        """Return the path with a new amplitude and transformed via points.

        Args:
            amplitude: (3,).
            moved: transforms a position (3,).
            turned: transforms a direction (3,) of a captured path; None: directions stay.
        """
        points = np.array([moved(point) for point in self.points]).reshape(-1, 3)
        course = self.course if self.course is None or turned is None else self.course.turned(turned)
        return replace(self, amplitude=amplitude, points=points, course=course)

    def samples(self, start: Floats, end: Floats, tolerance: float, longest: float = inf) -> Floats:
        """Return path parameters between which the path is nearly straight.

        Args:
            start: (3,) position at parameter 0.
            end: (3,) position at parameter 1.
            tolerance: largest distance between the path and the chord of an interval.
            longest: largest distance between two samples.

        Returns:
            (m,) parameters without 0 and 1.
        """
        knots = self._quarters() if self.course is None else self.course.anchors
        for _ in range(_MAX_BISECTIONS):
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
        """Return displacements (m, 3) between finely sampled points of the path."""
        count = 64 * ceil(1 + 2 * self.turns + len(self.points))
        return np.diff(self.at(start, end, np.linspace(0.0, 1.0, count + 1)), axis=0)

    def _quarters(self) -> Floats:
        """Return the path parameters at quarter periods of the fastest axis.

        Both ends are included.
        """
        moving = self.frequency * (np.abs(self.amplitude) > _ZERO_LENGTH)
        axis = int(np.argmax(moving))
        if moving[axis] <= 0:
            return np.array([0.0, 1.0])
        fine = np.linspace(0.0, 1.0, 2001)
        phase = _SAMPLES_PER_PERIOD * (
            self.frequency[axis] * _PHASE_TRENDS[self.frequency_variation](fine) + self.shift[axis]
        )
        whole = np.arange(np.ceil(phase[0] + 1e-3), phase[-1] - 1e-3)
        return np.concatenate([[0.0], np.interp(whole, phase, fine), [1.0]])

    def _swing(self, t: Floats) -> Floats:
        """Return the sinusoidal offsets (m, 3) at (m, 1) path parameters."""
        phase = self.frequency * _PHASE_TRENDS[self.frequency_variation](t) + self.shift
        return np.asarray(self.amplitude * _AMPLITUDE_TRENDS[self.amplitude_variation](t) * np.sin(2 * np.pi * phase))

    def _through(self, start: Floats, end: Floats, parameters: Floats) -> Floats:
        """Return positions (m, 3) on a spline through the path's via points.

        The speed is that of the capture, or else constant.
        """
        via_points = np.vstack([start, self.points, end])
        if self.course is not None:
            return natural_spline(self.course.knots, via_points).at(parameters)
        via_points = via_points[
            np.concatenate([[True], np.linalg.norm(np.diff(via_points, axis=0), axis=1) > _ZERO_LENGTH])
        ]
        if len(via_points) < 2:
            return np.repeat(via_points, len(parameters), axis=0)
        knots = np.concatenate([[0.0], np.cumsum(np.sqrt(np.linalg.norm(np.diff(via_points, axis=0), axis=1)))])
        curve, fine = natural_spline(knots, via_points), np.linspace(0.0, knots[-1], _ARC_LENGTH_STEPS + 1)
        arc_lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(curve.at(fine), axis=0), axis=1))])
        return curve.at(np.interp(parameters * arc_lengths[-1], arc_lengths, fine))


@dataclass(frozen=True)
class _Shape:
    """Default parameters of a kind of path."""

    amplitude: tuple[float, float, float]  # outward, up, forward [arm lengths]
    frequency: float  # number of periods
    crossed: bool = False  # whether the second moving axis is a quarter period ahead
    variation: SizeTrend = "none"


_DEFAULT_SHAPES: Mapping[PathKind, _Shape] = {
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
    """Create a hand path of a shape such as circle or wave.

    Args:
        kind: shape of the path.
        amplitude: outward, up, forward [arm lengths], or one number for the default axes.
        frequency: periods over the whole path, of each axis or of all.
        shift: phase in periods, of each axis or of all.
        variations: of amplitude and of frequency along the path.
        points: each (3,) forward, outward, up [arm lengths].

    Raises:
        ValueError: a number is out of range, or the kind does not use it.
    """
    shape = _DEFAULT_SHAPES[kind]
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
    _check_ranges(kind, size, turns)
    return HandPath(
        kind,
        _to_side_axes(size),
        _to_side_axes(turns),
        _to_side_axes(ahead),
        variations[0] or shape.variation,
        variations[1],
        sealed(np.array(points).reshape(-1, 3)),
    )


def _check_ranges(kind: PathKind, amplitude: Floats, frequency: Floats) -> None:
    if not np.isfinite(amplitude).all() or np.abs(amplitude).max() > 1.0:
        raise ValueError(f"amplitude is {_format_vector(amplitude)}, outside [-1, 1] arm lengths")
    if not np.isfinite(frequency).all() or frequency.min() < 0 or frequency.max() > MAX_PERIODS:
        raise ValueError(f"frequency is {_format_vector(frequency)}, outside [0, {MAX_PERIODS:g}] turns on the way")
    if kind in ("arc", "circle", "wave", "spiral") and not np.any(amplitude * frequency):
        raise ValueError(f"a {kind} path without amplitude or frequency is a line; write kind = 'line'")


def _format_vector(values: Floats) -> str:
    return "[" + ", ".join(f"{value:g}" for value in values) + "]"


def _to_side_axes(vector: Floats) -> Floats:
    """Reorder (3,) outward, up, forward to forward, outward, up."""
    return sealed(np.array([vector[2], vector[0], vector[1]]))
