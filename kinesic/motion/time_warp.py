"""Moves key times so that every hinge can pass its keys: one step in a sequence of linear programs.

Another motion near a given one follows from how time is stretched along it, and from how its path is changed. To first
order both change speeds, accelerations, jerks and duties linearly: a share e(t) by which time is stretched takes e off
each speed v, 2 e off its acceleration a, and 3 e off its jerk, less what comes of a stretch that itself changes
(v de/dt off the acceleration, 3 a de/dt + v d2e/dt2 off the jerk). As each gap is stretched where it lies, keys may
come much later without any error of the first order.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TypeAlias

import numpy as np
import scipy

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.motion.infeasibility import Infeasibility
from kinesic.motion.key_time_lp import KeyTimeProblem, state_program
from kinesic.motion.piqp import solve_linear
from kinesic.motion.segments import SplineSegment
from kinesic.motion.trajectory import spline_weights

PRECISION = 1e-4  # enough for times that are looked at exactly afterwards
NEAR = 0.0  # share of a limit on whose side a row may come to bind
LACKING = 300.0  # weight of a share of time that is still lacking

Matrix: TypeAlias = "scipy.sparse.csr_array"


@dataclass
class _Program:
    """A linear program, block by block."""

    costs: list[Floats] = field(default_factory=list)
    ranges: list[tuple[Floats, Floats]] = field(default_factory=list)
    entries: list[tuple[Floats, Floats, Floats]] = field(default_factory=list)  # rows, columns, values
    bounds: list[tuple[Floats, Floats]] = field(default_factory=list)
    width: int = 0
    height: int = 0

    def add_variables(self, lower: Floats, upper: Floats, cost: Floats | float = 0.0) -> int:
        """Returns the column of the first."""
        first = self.width
        self.costs.append(np.broadcast_to(cost, lower.shape))
        self.ranges.append((lower, upper))
        self.width += len(lower)
        return first

    def require(self, blocks: Iterable[tuple[int, Matrix]], lower: Floats, upper: Floats) -> None:
        """Rows between bounds, from matrices and the columns where they begin."""
        for first, block in blocks:
            part = scipy.sparse.coo_array(block)
            self.entries.append((part.row + self.height, part.col + first, part.data))
        self.bounds.append((lower, upper))
        self.height += len(lower)

    def solve(self) -> Floats | None:
        rows, columns, values = (np.concatenate(parts) for parts in zip(*self.entries, strict=True))
        matrix = scipy.sparse.csc_array((values, (rows, columns)), shape=(self.height, self.width))
        found = solve_linear(
            np.concatenate(self.costs), matrix, _joined(self.bounds), _joined(self.ranges), precision=PRECISION
        )
        return None if found is None else found[0]


def _joined(parts: Sequence[tuple[Floats, Floats]]) -> tuple[Floats, Floats]:
    """Lower and upper ends of all parts."""
    return np.concatenate([lower for lower, _ in parts]), np.concatenate([upper for _, upper in parts])


def stretch_times(
    problem: KeyTimeProblem,
    times: Floats,
    lacking: Sequence[tuple[SplineSegment, Infeasibility]],
    *,
    limits: Limits,
    radius: float,
    reserves: Sequence[float],
) -> Floats | None:
    """Finds the key times that are nearest to the asked ones, of those near others at which segments have a motion.

    Args:
        problem: what key times keep to.
        times: (m,) [s] near which they are looked for.
        lacking: segments at these times, with the motions that exceed the limits least.
        limits: of all hinges.
        radius: share by which time is stretched at most.
        reserves: share of its time that each segment keeps to spare.

    Returns:
        (m,) [s] block time; None when the program cannot be solved.
    """
    program, stated = _Program(), state_program(problem)
    program.add_variables(stated.least, np.full(len(stated.least), np.inf), stated.costs)
    program.require([(0, stated.matrix)], stated.lower, stated.upper)
    lack = program.add_variables(np.zeros(1), np.full(1, np.inf), LACKING)
    for (segment, found), reserve in zip(lacking, reserves, strict=True):
        _add_segment(program, segment, found, times, limits, lack, radius, reserve)
    solution = program.solve()
    return None if solution is None else solution[: len(times)]


def _add_segment(
    program: _Program,
    segment: SplineSegment,
    found: Infeasibility,
    times: Floats,
    limits: Limits,
    lack: int,
    radius: float,
    reserve: float,
) -> None:
    """Adds how time is stretched along a segment, and how its path changes, with what is fixed and the limits."""
    grid, controls = segment.grid, found.controls
    lower, upper = segment.corridor(limits)
    most = np.full(grid.pieces + 2, radius)
    stretch = program.add_variables(-most, most)
    path = program.add_variables(np.minimum(lower - controls, 0.0), np.maximum(upper - controls, 0.0))
    middles, moved = _middles(segment, len(times)), _moved(segment)
    program.require([(0, middles), (stretch, -moved)], middles @ times, middles @ times)
    matrix = segment.fixed.matrix
    program.require([(path, matrix)], np.zeros(matrix.shape[0]), np.zeros(matrix.shape[0]))
    some, order = grid.bounds == 1.0, grid.powers
    rows, change = grid.rows(limits, segment.hinge)[some], _change(segment, controls, limits)[some]
    now, weight = rows @ controls, order[some]
    spare, endless = 1.0 - reserve * weight, np.full(len(now), np.inf)
    relaxed = scipy.sparse.csr_array(weight[:, None])
    up, down = now >= NEAR, now <= -NEAR
    program.require([(stretch, change[up]), (path, rows[up]), (lack, -relaxed[up])], -endless[up], (spare - now)[up])
    program.require(
        [(stretch, change[down]), (path, rows[down]), (lack, relaxed[down])], (-spare - now)[down], endless[down]
    )


def _middles(segment: SplineSegment, count: int) -> Matrix:
    """(g, m) by which the times of all keys make up the lengths of a segment's g gaps."""
    entries = [(row, mark, 1.0 / len(marks)) for row, marks in enumerate(segment.marks) for mark in marks]
    rows, columns, shares = np.array(entries).T
    places = rows.astype(np.intp), columns.astype(np.intp)
    whole = scipy.sparse.csr_array((shares, places), shape=(len(segment.marks), count))
    return whole[1:] - whole[:-1]


def _moved(segment: SplineSegment) -> Matrix:
    """(g, k + 2) [s] by which the control points of the stretch lengthen each gap."""
    grid = segment.grid
    first, shares = spline_weights(np.array([0.0, *segment.places, float(grid.pieces)]), grid.pieces)
    rows, columns, values = [], [], []
    for gap, (begin, end) in enumerate(pairwise(first)):
        change = np.zeros(end - begin + 4)
        change[end - begin :] += shares[gap + 1]
        change[:4] -= shares[gap]
        left = grid.step * np.cumsum(change[::-1])[::-1][1:]  # of the integral, whose control points are sums
        rows.append(np.full(len(left), gap))
        columns.append(begin + np.arange(len(left)))
        values.append(left)
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return scipy.sparse.csr_array(entries, shape=(len(first) - 1, grid.pieces + 2))


def _change(segment: SplineSegment, controls: Floats, limits: Limits) -> Matrix:
    """(4 k + 4, k + 2) change of the rows of limits by a stretch, as shares of them."""
    grid, hinge, h = segment.grid, segment.hinge, segment.grid.step
    speed, acceleration, jerk = (np.diff(controls, order) / h**order for order in (1, 2, 3))
    at_knots, at_middles = (speed[:-1] + speed[1:]) / 2, (speed[:-2] + 2 * speed[1:-1] + speed[2:]) / 4
    bend = (acceleration[:-1] + acceleration[1:]) / 2
    slower, at_knots_slower = -speed[:, None], -at_knots[:, None] * [0.5, 0.5]
    less = -acceleration[:, None] * [1.0, 1.0] - at_knots[:, None] * [-1 / h, 1 / h]
    softer = (
        -3 * jerk[:, None] * [0.25, 0.5, 0.25]
        - 3 * bend[:, None] * [-0.5 / h, 0.0, 0.5 / h]
        - at_middles[:, None] * [1 / h**2, -2 / h**2, 1 / h**2]
    )
    pulling = (limits.inertial[hinge] * less + limits.viscous[hinge] * at_knots_slower) / grid.duty(limits)[hinge]
    stencils = (
        slower / limits.speed[hinge],
        less / limits.acceleration[hinge],
        softer / limits.jerk[hinge],
        pulling,
    )
    columns = [np.arange(len(stencil))[:, None] + np.arange(stencil.shape[1]) for stencil in stencils]
    starts = np.cumsum(np.concatenate([[0], *(np.full(len(stencil), stencil.shape[1]) for stencil in stencils)]))
    entries = np.concatenate([stencil.ravel() for stencil in stencils]), np.concatenate([c.ravel() for c in columns])
    return scipy.sparse.csr_array((*entries, starts), shape=(len(starts) - 1, grid.pieces + 2))
