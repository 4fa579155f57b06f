"""Uniform cubic B-splines, with motion limits as linear constraints."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.body.linear_program import SparseMatrix

Indices = NDArray[np.int32]

FIXED_ROW_BOUND = 2.0  # bound of limit ratios that depend only on fixed control points; other ratios are bounded by 1
MIN_RANGE = 1e-9  # [rad] range assumed for a hinge that cannot move
JERK_TIME = 0.05  # [s] time that weights jerk relative to acceleration in the smoothest motion
CALMNESS_REGULARISATION = 1e-10  # added to the diagonal of the acceleration and jerk cost, to make it positive definite
STENCIL_WIDTHS = (2, 3, 4, 3)  # control points per row of velocity, acceleration, jerk and duty
TIME_POWERS = (  # p: value / limit scales with duration**-p, for velocity, acceleration, jerk and duty
    1.0,
    2.0,
    3.0,
    2.0,
)
GRID_CACHE_SIZE = 128  # largest number of cached grids, 40 kB each
ACCELERATION_WEIGHT = 1e-9  # [s^4] weight of squared acceleration relative to squared distance from the desired motion


@dataclass(frozen=True, eq=False)
class FreeRows:
    """Limit constraints that depend on free control points of the spline."""

    places: Floats  # (r,) knot positions of the rows, in steps from the first knot
    kinds: NDArray[np.intp]  # (r,) 0 velocity, 1 acceleration, 2 jerk, 3 duty
    powers: Floats  # (r,) time exponents of the rows, see `Grid.powers`


@dataclass(frozen=True, eq=False)
class Grid:
    """Knots of a uniform cubic B-spline, with its constraint matrices."""

    pieces: int  # k, number of knot intervals
    step: float  # [s]

    @property
    def size(self) -> int:
        """Number of control points of one hinge."""
        return self.pieces + 3

    @property
    def counts(self) -> tuple[int, int, int, int]:
        """Number of constraint rows for velocity, acceleration, jerk and duty limits."""
        return self.pieces + 2, self.pieces + 1, self.pieces, self.pieces + 1

    @cached_property
    def knots(self) -> Floats:
        """Times of the knots, shape (k + 1,) [s]."""
        return np.asarray(np.arange(self.pieces + 1) * self.step, dtype=np.float64)

    @cached_property
    def closeness_bands(self) -> Floats:
        """Banded cost matrix of squared distance to a desired motion.

        Measured at the knots, with a little weight on smoothness. Upper bands of shape (3, k + 3), the diagonal last.
        """
        bands = np.zeros((3, self.size))
        _add_squares(bands, np.array([1.0, 4.0, 1.0]) / 6)
        _add_squares(bands, np.sqrt(ACCELERATION_WEIGHT) * np.array([1.0, -2.0, 1.0]) / self.step**2)
        return bands

    @cached_property
    def calmness_bands(self) -> Floats:
        """Banded cost matrix of squared acceleration and squared jerk.

        Upper bands of shape (4, k + 3), the diagonal last.
        """
        bands = np.zeros((4, self.size))
        _add_squares(bands, np.array([1.0, -2.0, 1.0]))
        _add_squares(bands, np.array([-1.0, 3.0, -3.0, 1.0]) * JERK_TIME / self.step)
        bands[-1] += CALMNESS_REGULARISATION
        return bands

    def stencils(self, limits: Limits, hinge: int) -> Floats:
        """Return control-point weights of a hinge's four limit ratios, (4, 4).

        The weighted sum of control points is 1 at the limit.

        One row each of weights of neighbouring control points: velocity (the first two), acceleration (three), jerk
        (four), and the duty at the knots (three).
        """
        h = self.step
        velocity, knot_velocity = np.array([-1.0, 1.0, 0.0, 0.0]) / h, np.array([-0.5, 0.0, 0.5, 0.0]) / h
        acceleration, jerk = np.array([1.0, -2.0, 1.0, 0.0]) / h**2, np.array([-1.0, 3.0, -3.0, 1.0]) / h**3
        duty = limits.inertial[hinge] * acceleration + limits.viscous[hinge] * knot_velocity
        boxes = velocity / limits.speed[hinge], acceleration / limits.acceleration[hinge], jerk / limits.jerk[hinge]
        return np.array([*boxes, duty / self.duty(limits)[hinge]])

    def rows(self, limits: Limits, hinge: int) -> SparseMatrix:
        """Return the sparse matrix from control points to a hinge's limit ratios.

        -1 <= rows @ controls <= 1. Of shape (4 k + 4, k + 3) for k pieces, without the range: velocity, acceleration
        and jerk on their control points, then the duty at the knots.
        """
        groups = zip(self.stencils(limits, hinge), STENCIL_WIDTHS, self.counts, strict=True)
        return stack_stencils([np.tile(stencil[:width], (count, 1)) for stencil, width, count in groups], self.size)

    @cached_property
    def powers(self) -> Floats:
        """Time exponent of each limit constraint, (4 k + 4,)."""
        return np.repeat(TIME_POWERS, self.counts)

    @cached_property
    def bounds(self) -> Floats:
        """Upper bounds of the limit constraints, shape (4 k + 4,).

        Each is 1, or `FIXED_ROW_BOUND` where three given control points at an end determine a row: a row without slack
        has no interior, which the interior-point method needs.
        """
        bounds = []
        for ends, count in zip((2, 1, 0, 1), self.counts, strict=True):
            group = np.ones(count)
            group[:ends] = group[count - ends :] = FIXED_ROW_BOUND
            bounds.append(group)
        return np.concatenate(bounds)

    @cached_property
    def free_rows(self) -> "FreeRows":
        """Limit constraints that depend on free control points of the spline."""
        is_free = self.bounds == 1.0
        places = np.concatenate([np.linspace(0, self.pieces, count) for count in self.counts])
        kinds = np.repeat(np.arange(len(self.counts)), self.counts)
        return FreeRows(places[is_free], kinds[is_free], self.powers[is_free])

    def duty(self, limits: Limits) -> Floats:
        """Return each hinge's duty bound at the knots, shape (n,).

        Between knots, inertial * a + viscous * v is a parabola, which rises above its chord by at most
        viscous * jerk * step^2 / 8.
        """
        return np.asarray(limits.duty - limits.viscous * limits.jerk * self.step**2 / 8)

    def limit_ratios(
        self, controls: Floats, limits: Limits, hinge: int | NDArray[np.intp]
    ) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """Return splines' signed ratios to range, velocity, acceleration, jerk and duty limits.

        One array for each kind of limit, in this order.

        Args:
            controls: (k + 3,) [rad] control points of one hinge, or (h, k + 3) of several.
            limits: of all hinges.
            hinge: its index, or (h,) indices.
        """
        first = controls[..., 1:] - controls[..., :-1]  # differences of first and second order
        second = first[..., 1:] - first[..., :-1]
        velocity, acceleration = first / self.step, second / self.step**2
        jerk = (second[..., 1:] - second[..., :-1]) / self.step**3

        def select(values: Floats) -> Floats:
            return np.asarray(values[hinge])[..., None]

        knot_velocity_sum = velocity[..., :-1] + velocity[..., 1:]
        duty = select(limits.inertial) * acceleration + select(limits.viscous) * knot_velocity_sum / 2
        return (
            (controls - select((limits.upper + limits.lower) / 2))
            / select(np.maximum(limits.upper - limits.lower, MIN_RANGE) / 2),
            velocity / select(limits.speed),
            acceleration / select(limits.acceleration),
            jerk / select(limits.jerk),
            duty / select(self.duty(limits)),
        )

    def largest_limit_ratio(self, controls: Floats, limits: Limits, hinge: int) -> float:
        """Return one hinge's largest absolute ratio to any of its limits."""
        return max(float(np.abs(ratios).max()) for ratios in self.limit_ratios(controls, limits, hinge))


def _add_squares(bands: Floats, stencil: Floats) -> None:
    """Add a stencil's squares to the bands of a quadratic form.

    The bands have shape (w + 1, n). The stencil is applied at every position where it fits.
    """
    count = bands.shape[1] - len(stencil) + 1
    for column, weight in enumerate(stencil):
        for row, other in enumerate(stencil[: column + 1]):
            bands[len(bands) - 1 - (column - row), column : column + count] += weight * other


def at_knots(controls: Floats) -> Floats:
    """Return the angles of a spline at its knots [rad]."""
    return np.asarray((controls[:-2] + 4.0 * controls[1:-1] + controls[2:]) / 6.0)


def stack_stencils(groups: Sequence[Floats], size: int) -> SparseMatrix:
    """Return a matrix of stencils over successive control points, group by group.

    Args:
        groups: (r, w) weights of w control points; the first has index 0 in the first row, 1 in the next.
        size: n, number of control points.
    """
    columns = [np.add.outer(np.arange(len(group)), np.arange(group.shape[1])).ravel() for group in groups]
    widths = np.repeat([group.shape[1] for group in groups], [len(group) for group in groups])
    rows, values = np.repeat(np.arange(len(widths)), widths), np.concatenate([group.ravel() for group in groups])
    return SparseMatrix(rows, np.concatenate(columns), values, (len(widths), size))


@lru_cache(maxsize=GRID_CACHE_SIZE)
def grid(pieces: int, step: float) -> Grid:
    """Return the cached spline grid for a number of knot intervals."""
    return Grid(pieces, step)
