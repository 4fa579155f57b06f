"""Uniform B-splines on a grid: their differences, and the rows by which limits hold at every instant."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import scipy
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits

Indices = NDArray[np.int32]

ROOMY = 2.0  # bound of a scaled row that is decided
TINY = 1e-9  # [rad] range of a hinge that cannot move
CALM = 0.05  # [s] by which jerk weighs beside acceleration where a motion is as smooth as can be
ANCHOR = 1e-10  # what holds such a motion where nothing else does
WIDTHS = (2, 3, 4, 3)  # control points that speed, acceleration, jerk and duty depend on
POWERS = (1.0, 2.0, 3.0, 2.0)  # of the time, by which they fall when it is stretched
SMOOTHNESS = 1e-9  # [s^4] weight of the acceleration beside the distance from what is desired


@dataclass(frozen=True, eq=False)
class FreeRows:
    """Rows of limits that no ends of a spline decide."""

    places: Floats  # (r,) of each, in pieces from the first knot
    kinds: NDArray[np.intp]  # (r,) 0 speed, 1 acceleration, 2 jerk, 3 duty
    powers: Floats  # (r,) of `Grid.powers`


@dataclass(frozen=True, eq=False)
class Grid:
    """The grid of a uniform cubic B-spline (number and length of its pieces), with the matrices that follow."""

    pieces: int  # k
    step: float  # [s]

    @property
    def size(self) -> int:
        """Number of control points of one hinge."""
        return self.pieces + 3

    @property
    def counts(self) -> tuple[int, int, int, int]:
        """How many rows there are of speed, acceleration, jerk and duty."""
        return self.pieces + 2, self.pieces + 1, self.pieces, self.pieces + 1

    @cached_property
    def knots(self) -> Floats:
        """(k + 1,) [s] times of the knots."""
        return np.asarray(np.arange(self.pieces + 1) * self.step, dtype=np.float64)

    @cached_property
    def at_knots(self) -> "scipy.sparse.csr_array":
        """(k + 1, k + 3) matrix from control points to the angles at the knots."""
        return scipy.sparse.diags_array(
            [1 / 6, 4 / 6, 1 / 6], offsets=[0, 1, 2], shape=(self.pieces + 1, self.size)
        ).tocsr()

    @cached_property
    def closeness(self) -> "scipy.sparse.csc_array":
        """(k + 3, k + 3) quadratic form of the distance from a desired motion, with a little smoothness."""
        second = np.array([1.0, -2.0, 1.0]) / self.step**2
        bend = scipy.sparse.diags_array(second, offsets=[0, 1, 2], shape=(self.pieces + 1, self.size))
        return (self.at_knots.T @ self.at_knots + SMOOTHNESS * bend.T @ bend).tocsc()

    @cached_property
    def closeness_bands(self) -> Floats:
        """(3, k + 3) `closeness`, upper form: two beside the diagonal, one, the diagonal."""
        bands = np.zeros((3, self.size))
        _add_squares(bands, np.array([1.0, 4.0, 1.0]) / 6)
        _add_squares(bands, np.sqrt(SMOOTHNESS) * np.array([1.0, -2.0, 1.0]) / self.step**2)
        return bands

    @cached_property
    def calmness_bands(self) -> Floats:
        """(4, k + 3) quadratic form of acceleration and jerk, the sum of their squares: upper form."""
        bands = np.zeros((4, self.size))
        _add_squares(bands, np.array([1.0, -2.0, 1.0]))
        _add_squares(bands, np.array([-1.0, 3.0, -3.0, 1.0]) * CALM / self.step)
        bands[-1] += ANCHOR
        return bands

    def stencils(self, limits: Limits, hinge: int) -> Floats:
        """(4, 4) shares that neighbouring control points have in the limits of a hinge, which are scaled to 1.

        Speed (the first two), acceleration (three), jerk, and the duty at the knots (three).
        """
        h = self.step
        speed, at_knot = np.array([-1.0, 1.0, 0.0, 0.0]) / h, np.array([-0.5, 0.0, 0.5, 0.0]) / h
        acceleration, jerk = np.array([1.0, -2.0, 1.0, 0.0]) / h**2, np.array([-1.0, 3.0, -3.0, 1.0]) / h**3
        pulling = limits.inertial[hinge] * acceleration + limits.viscous[hinge] * at_knot
        boxes = speed / limits.speed[hinge], acceleration / limits.acceleration[hinge], jerk / limits.jerk[hinge]
        return np.array([*boxes, pulling / self.duty(limits)[hinge]])

    def rows(self, limits: Limits, hinge: int) -> "scipy.sparse.csr_array":
        """(4 k + 4, k + 3) rows of every limit of a hinge but its range, scaled to -1..1.

        Speed, acceleration and jerk on their control points, the duty at the knots.
        """
        every = zip(self.stencils(limits, hinge), WIDTHS, self.counts, strict=True)
        data = np.concatenate([np.tile(stencil[:width], count) for stencil, width, count in every])
        return scipy.sparse.csr_array((data, *self._pattern), shape=(4 * self.pieces + 4, self.size))

    @cached_property
    def _pattern(self) -> tuple[Indices, Indices]:
        """Column indices and row starts of `rows`."""
        shapes = tuple(zip(WIDTHS, self.counts, strict=True))
        columns = [(np.arange(count)[:, None] + np.arange(width)).ravel() for width, count in shapes]
        widths = np.repeat([width for width, _ in shapes], [count for _, count in shapes])
        return np.concatenate(columns).astype(np.int32), np.concatenate([[0], np.cumsum(widths)]).astype(np.int32)

    @cached_property
    def powers(self) -> Floats:
        """(4 k + 4,) by which powers of time the rows fall when it is stretched."""
        return np.repeat(POWERS, self.counts)

    @cached_property
    def bounds(self) -> Floats:
        """(4 k + 4,) bounds of the rows: 1, relaxed where three given control points at an end determine a row.

        A row without room has no interior, which the program's method needs.
        """
        bounds = []
        for ends, count in zip((2, 1, 0, 1), self.counts, strict=True):
            group = np.ones(count)
            group[:ends] = group[count - ends :] = ROOMY
            bounds.append(group)
        return np.concatenate(bounds)

    @cached_property
    def free_rows(self) -> "FreeRows":
        """Those of the rows that leave a choice."""
        some = self.bounds == 1.0
        places = np.concatenate([np.linspace(0, self.pieces, count) for count in self.counts])
        kinds = np.repeat(np.arange(len(self.counts)), self.counts)
        return FreeRows(places[some], kinds[some], self.powers[some])

    def duty(self, limits: Limits) -> Floats:
        """(n,) bounds of the duty at the knots.

        In between, inertial * a + viscous * v is a parabola on each piece, which rises above its chord by at most
        viscous * jerk * step^2 / 8.
        """
        return np.asarray(limits.duty - limits.viscous * limits.jerk * self.step**2 / 8)

    def shares(
        self, controls: Floats, limits: Limits, hinge: int | NDArray[np.intp]
    ) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """Shares that splines (..., k + 3) [rad] take of the limits of range, speed, acceleration, jerk and duty.

        Args:
            controls: of one hinge, or (h, k + 3) of several.
            limits: of all hinges.
            hinge: its index, or (h,) theirs.
        """
        once = controls[..., 1:] - controls[..., :-1]
        twice = once[..., 1:] - once[..., :-1]
        speed, acceleration = once / self.step, twice / self.step**2
        jerk = (twice[..., 1:] - twice[..., :-1]) / self.step**3

        def of(values: Floats) -> Floats:
            return np.asarray(values[hinge])[..., None]

        pulling = of(limits.inertial) * acceleration + of(limits.viscous) * (speed[..., :-1] + speed[..., 1:]) / 2
        return (
            (controls - of((limits.upper + limits.lower) / 2)) / of(np.maximum(limits.upper - limits.lower, TINY) / 2),
            speed / of(limits.speed),
            acceleration / of(limits.acceleration),
            jerk / of(limits.jerk),
            pulling / of(self.duty(limits)),
        )

    def keeps(self, controls: Floats, limits: Limits, hinge: int, most: float) -> bool:
        """Says quickly whether a spline takes no more than a share of any limit; False: perhaps it does.

        The parts of the duty count as if they were largest at the same time.
        """
        once = controls[1:] - controls[:-1]
        twice = once[1:] - once[:-1]
        away = max(controls.max() - self._middle(limits, hinge), self._middle(limits, hinge) - controls.min())
        speed, acceleration, jerk = (
            float(max(values.max(), -values.min())) / self.step**order
            for order, values in ((1, once), (2, twice), (3, twice[1:] - twice[:-1]))
        )
        return bool(
            away <= most * self._half(limits, hinge)
            and speed <= most * limits.speed[hinge]
            and acceleration <= most * limits.acceleration[hinge]
            and jerk <= most * limits.jerk[hinge]
            and limits.inertial[hinge] * acceleration + limits.viscous[hinge] * speed
            <= most * self._duty_of(limits, hinge)
        )

    def _duty_of(self, limits: Limits, hinge: int) -> float:
        """What `duty` has for one hinge."""
        return float(limits.duty[hinge] - limits.viscous[hinge] * limits.jerk[hinge] * self.step**2 / 8)

    @staticmethod
    def _middle(limits: Limits, hinge: int) -> float:
        return float((limits.upper[hinge] + limits.lower[hinge]) / 2)

    @staticmethod
    def _half(limits: Limits, hinge: int) -> float:
        return float(max(limits.upper[hinge] - limits.lower[hinge], TINY) / 2)

    def largest(self, controls: Floats, limits: Limits, hinge: int) -> float:
        """The largest share that a spline takes of any limit."""
        return max(float(np.abs(share).max()) for share in self.shares(controls, limits, hinge))


def _add_squares(bands: Floats, stencil: Floats) -> None:
    """Adds the sum of the squares of a stencil, applied wherever it fits, to the bands (w + 1, n) of a form."""
    count = bands.shape[1] - len(stencil) + 1
    for column, share in enumerate(stencil):
        for row, other in enumerate(stencil[: column + 1]):
            bands[len(bands) - 1 - (column - row), column : column + count] += share * other


@lru_cache(maxsize=512)
def grid(pieces: int, step: float) -> Grid:
    """Returns the grid of some pieces of a length [s]; the same one for the same figures."""
    return Grid(pieces, step)
