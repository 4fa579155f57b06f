"""One linearised step towards feasible key times by warping time.

A motion near a given one results from a stretch of time along it and from a change of its path. To first order both
change velocities, accelerations, jerks and duties linearly: a relative stretch e(t) of time reduces each velocity v by
e, its acceleration a by 2 e and its jerk by 3 e. A varying stretch has further terms (v de/dt in the acceleration,
3 a de/dt + v d2e/dt2 in the jerk). As each gap is stretched locally, keys may come much later without an error of first
order.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from kinesic.body.arrays import Floats, Indices
from kinesic.body.limits import Limits
from kinesic.body.linear_program import SparseMatrix
from kinesic.motion.bspline import stack_stencils
from kinesic.motion.infeasibility import Infeasibility
from kinesic.motion.interior_point import solve_by_interior_point
from kinesic.motion.key_time_lp import KeyTimeProblem, build_program
from kinesic.motion.segments import SplineSegment
from kinesic.motion.trajectory import spline_weights

SOLVER_PRECISION = 1e-4  # absolute tolerance of the solver; results are made exact afterwards
BINDING_RATIO = 0.0  # limit ratio above which a row gets an upper bound; below its negative, a row gets a lower bound
DEFICIT_WEIGHT = 300.0  # cost of a remaining time deficit relative to key shifts


@dataclass
class _Program:
    """Linear program that is assembled block by block."""

    costs: list[Floats] = field(default_factory=list)
    ranges: list[tuple[Floats, Floats]] = field(default_factory=list)
    entries: list[tuple[Indices, Indices, Floats]] = field(default_factory=list)  # rows, columns, values
    bounds: list[tuple[Floats, Floats]] = field(default_factory=list)
    width: int = 0
    height: int = 0

    def add_variables(self, lower: Floats, upper: Floats, cost: Floats | float = 0.0) -> int:
        """Add optimisation variables and return the first variable's column."""
        first = self.width
        self.costs.append(np.broadcast_to(cost, lower.shape))
        self.ranges.append((lower, upper))
        self.width += len(lower)
        return first

    def require(self, blocks: Iterable[tuple[int, SparseMatrix]], lower: Floats, upper: Floats) -> None:
        """Add constraint rows from matrices placed at given columns."""
        for first, block in blocks:
            self.entries.append((block.rows + self.height, block.columns + first, block.values))
        self.bounds.append((lower, upper))
        self.height += len(lower)

    def solve(self) -> Floats | None:
        rows, columns, values = (np.concatenate(parts) for parts in zip(*self.entries, strict=True))
        return solve_by_interior_point(
            np.concatenate(self.costs),
            SparseMatrix(rows, columns, values, (self.height, self.width)),
            _join_bounds(self.bounds),
            _join_bounds(self.ranges),
            precision=SOLVER_PRECISION,
        )


def _join_bounds(parts: Sequence[tuple[Floats, Floats]]) -> tuple[Floats, Floats]:
    """Concatenate several pairs of lower and upper bound arrays."""
    return np.concatenate([lower for lower, _ in parts]), np.concatenate([upper for _, upper in parts])


def stretch_times(
    problem: KeyTimeProblem,
    times: Floats,
    deficits: Sequence[tuple[SplineSegment, Infeasibility]],
    *,
    limits: Limits,
    radius: float,
    reserves: Sequence[float],
) -> Floats | None:
    """Return key times of least shift cost under linearised constraints.

    Args:
        problem: constraints on key times.
        times: (m,) [s] given key times.
        deficits: segments at these times, with the motions that exceed the limits least.
        limits: of all hinges.
        radius: largest relative stretch.
        reserves: relative time reserve of each segment.

    Returns:
        (m,) [s] block time; None when the program cannot be solved.
    """
    program, key_times = _Program(), build_program(problem)
    infinity = np.full(len(key_times.lower_bounds), np.inf)
    program.add_variables(key_times.lower_bounds, infinity, key_times.costs)
    program.require([(0, key_times.matrix)], key_times.lower, key_times.upper)
    remaining_deficit = program.add_variables(np.zeros(1), np.full(1, np.inf), DEFICIT_WEIGHT)
    warp = _WarpConstraints(times, limits, remaining_deficit, radius)
    for (segment, deficit), reserve in zip(deficits, reserves, strict=True):
        warp.add_segment(program, segment, deficit, reserve)
    solution = program.solve()
    return None if solution is None else solution[: len(times)]


@dataclass(frozen=True, eq=False)
class _WarpConstraints:
    """Values common to all segments of the time-warp optimisation."""

    times: Floats  # (m,) [s] given key times
    limits: Limits
    remaining_deficit: int  # index of the variable of the remaining time deficit
    radius: float  # largest relative stretch

    def add_segment(self, program: _Program, segment: SplineSegment, deficit: Infeasibility, reserve: float) -> None:
        """Add a segment's time warp, path change and constraints to the program."""
        grid, controls = segment.grid, deficit.controls
        lower, upper = segment.corridor(self.limits)
        max_stretch = np.full(grid.pieces + 2, self.radius)
        stretch = program.add_variables(-max_stretch, max_stretch)
        path = program.add_variables(np.minimum(lower - controls, 0.0), np.maximum(upper - controls, 0.0))
        gaps, lengthening = _gap_matrix(segment, len(self.times)), _gap_lengthening(segment)
        program.require([(0, gaps), (stretch, -lengthening)], gaps @ self.times, gaps @ self.times)
        matrix = segment.fixed.matrix
        program.require([(path, matrix)], np.zeros(matrix.shape[0]), np.zeros(matrix.shape[0]))
        is_free, powers = grid.bounds == 1.0, grid.powers
        rows = grid.rows(self.limits, segment.hinge).select_rows(is_free)
        change = _ratio_change(segment, controls, self.limits).select_rows(is_free)
        ratios, weight = rows @ controls, powers[is_free]
        bound, unbounded = 1.0 - reserve * weight, np.full(len(ratios), np.inf)
        up, down = ratios >= BINDING_RATIO, ratios <= -BINDING_RATIO
        relaxation = SparseMatrix(
            np.arange(len(weight)), np.zeros(len(weight), dtype=np.intp), weight, (len(weight), 1)
        )
        for selected, share, lowest, highest in (
            (up, -relaxation, -unbounded, bound - ratios),
            (down, relaxation, -bound - ratios, unbounded),
        ):
            blocks = (stretch, change), (path, rows), (self.remaining_deficit, share)
            program.require(
                [(first, block.select_rows(selected)) for first, block in blocks], lowest[selected], highest[selected]
            )


def _gap_matrix(segment: SplineSegment, count: int) -> SparseMatrix:
    """Return the matrix (g, m) from key times to gap durations."""
    entries = [
        (gap, mark, sign / len(marks))
        for gap, (begin, end) in enumerate(pairwise(segment.marks))
        for sign, marks in ((-1.0, begin), (1.0, end))
        for mark in marks
    ]
    gaps, marks, weights = zip(*entries, strict=True)
    return SparseMatrix(np.array(gaps), np.array(marks), np.array(weights), (len(segment.marks) - 1, count))


def _gap_lengthening(segment: SplineSegment) -> SparseMatrix:
    """Return each gap's lengthening per control point of the warp.

    Of shape (g, k + 2) [s].
    """
    grid = segment.grid
    first, weights = spline_weights(np.array([0.0, *segment.places, float(grid.pieces)]), grid.pieces)
    rows, columns, values = [], [], []
    for gap, (begin, end) in enumerate(pairwise(first)):
        change = np.zeros(end - begin + 4)
        change[end - begin :] += weights[gap + 1]
        change[:4] -= weights[gap]
        integral = grid.step * np.cumsum(change[::-1])[::-1][1:]  # control points of the integral are sums
        rows.append(np.full(len(integral), gap))
        columns.append(begin + np.arange(len(integral)))
        values.append(integral)
    entries = np.concatenate(rows), np.concatenate(columns), np.concatenate(values)
    return SparseMatrix(*entries, (len(first) - 1, grid.pieces + 2))


def _ratio_change(segment: SplineSegment, controls: Floats, limits: Limits) -> SparseMatrix:
    """Return the matrix from warp control points to limit ratio changes.

    Of shape (4 k + 4, k + 2).
    """
    grid, hinge, h = segment.grid, segment.hinge, segment.grid.step
    velocity, acceleration, jerk = (np.diff(controls, order) / h**order for order in (1, 2, 3))
    at_knots, at_middles = (velocity[:-1] + velocity[1:]) / 2, (velocity[:-2] + 2 * velocity[1:-1] + velocity[2:]) / 4
    bend = (acceleration[:-1] + acceleration[1:]) / 2
    velocity_change, knot_velocity_change = -velocity[:, None], -at_knots[:, None] * [0.5, 0.5]
    acceleration_change = -acceleration[:, None] * [1.0, 1.0] - at_knots[:, None] * [-1 / h, 1 / h]
    jerk_change = (
        -3 * jerk[:, None] * [0.25, 0.5, 0.25]
        - 3 * bend[:, None] * [-0.5 / h, 0.0, 0.5 / h]
        - at_middles[:, None] * [1 / h**2, -2 / h**2, 1 / h**2]
    )
    duty_change = (
        limits.inertial[hinge] * acceleration_change + limits.viscous[hinge] * knot_velocity_change
    ) / grid.duty(limits)[hinge]
    stencils = (
        velocity_change / limits.speed[hinge],
        acceleration_change / limits.acceleration[hinge],
        jerk_change / limits.jerk[hinge],
        duty_change,
    )
    return stack_stencils(stencils, grid.pieces + 2)
