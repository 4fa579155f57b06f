"""Optimisation of one spline segment by PIQP and sparse linear algebra."""

import casadi
import numpy as np
import scipy

from kinesic.body.limits import Limits
from kinesic.body.linear_program import SparseMatrix
from kinesic.motion.bspline import ACCELERATION_WEIGHT, Grid
from kinesic.motion.keys import Keys
from kinesic.motion.segments import SplineSegment, segments
from kinesic.motion.spline_program import KEPT_RATIO, Relaxation, _linear_part, nearest_without_limits
from kinesic.motion.trajectory import KNOT_INTERVAL

MAX_ITERATIONS = 40  # largest number of iterations; feasible quadratic programs need half as many
MAX_LINEAR_ITERATIONS = 250
LINEAR_PRECISION = 1e-6  # absolute tolerance of constraints and variables
DENSE_ROWS = 64  # number of rows from which a sparse solver is faster than a dense one
ROW_REGULARISATION = 1e-10  # regularisation that separates nearly equal constraint rows


def sparse(matrix: SparseMatrix):
    """Convert a matrix to SciPy's compressed row format."""
    return scipy.sparse.csr_array((matrix.values, (matrix.rows, matrix.columns)), shape=matrix.shape)


def angles_matrix(grid: Grid):
    """Return the matrix that maps control points to angles at the knots."""
    return scipy.sparse.diags_array([1 / 6, 4 / 6, 1 / 6], offsets=[0, 1, 2], shape=(grid.pieces + 1, grid.size))


def closeness(grid: Grid):
    """Return the quadratic cost of deviation from a motion, with slight smoothing."""
    second = np.array([1.0, -2.0, 1.0]) / grid.step**2
    bend = scipy.sparse.diags_array(second, offsets=[0, 1, 2], shape=(grid.pieces + 1, grid.size))
    at_knots = angles_matrix(grid)
    return (at_knots.T @ at_knots + ACCELERATION_WEIGHT * bend.T @ bend).tocsc()


def to_casadi(matrix) -> casadi.DM:
    """Convert a matrix in SciPy's compressed column format to CasADi."""
    pattern = casadi.Sparsity(*map(int, matrix.shape), matrix.indptr.tolist(), matrix.indices.tolist())
    return casadi.DM(pattern, matrix.data.tolist())


def smoothest(segment: SplineSegment, bands, pull, *, dense_rows: int = DENSE_ROWS):
    """Minimise a banded quadratic form under the equality constraints of a segment.

    Args:
        segment: of k knot intervals.
        bands: (w + 1, k + 3) diagonals of H, upper form.
        pull: (k + 3,).
        dense_rows: rows up to which a dense system is solved.
    """
    matrix, values = sparse(segment.fixed.matrix), segment.fixed.values
    if len(values) >= dense_rows:
        nearly = -ROW_REGULARISATION * scipy.sparse.eye_array(len(values))
        size, width = segment.grid.size, len(bands) - 1
        offsets = [*range(-width, width + 1)]
        diagonals = [bands[width - abs(offset), abs(offset) :] for offset in offsets]
        form = scipy.sparse.diags_array(diagonals, offsets=offsets, shape=(size, size))
        system = scipy.sparse.block_array([[form, matrix.T], [matrix, nearly]], format="csc")
        return np.asarray(scipy.sparse.linalg.spsolve(system, np.concatenate([pull, values]))[:size])
    factor = scipy.linalg.cholesky_banded(bands)
    solved = scipy.linalg.cho_solve_banded((factor, False), np.hstack([pull[:, None], matrix.T.toarray()]))
    free, pulls = solved[:, 0], solved[:, 1:]
    return np.asarray(free + pulls @ np.linalg.lstsq(matrix @ pulls, values - matrix @ free)[0])


def nearest_within_limits(segment: SplineSegment, desired, limits: Limits):
    """Return the nearest control points within limits, or None."""
    grid, fixed, (lower, upper) = segment.grid, segment.fixed, segment.corridor(limits, desired)
    rows = scipy.sparse.vstack([sparse(fixed.matrix), sparse(grid.rows(limits, segment.hinge))], format="csc")
    form, every = to_casadi(closeness(grid)), to_casadi(rows)
    program = {"h": form.sparsity(), "a": every.sparsity()}
    solver = casadi.conic("nearest", "piqp", program, {"error_on_fail": False, "piqp": {"max_iter": MAX_ITERATIONS}})
    solution = solver(
        h=form,
        g=-_linear_part(segment, desired),
        a=every,
        lba=np.concatenate([fixed.values, -grid.bounds]),
        uba=np.concatenate([fixed.values, grid.bounds]),
        lbx=lower,
        ubx=upper,
    )
    return np.array(solution["x"]).ravel() if solver.stats()["success"] else None


def relax_limits(segment: SplineSegment, limits: Limits, *, easy: float) -> Relaxation | None:
    """Return the least relaxation that makes a segment's limits feasible, or None."""
    grid, fixed, (lower, upper) = segment.grid, segment.fixed, segment.corridor(limits)
    some = grid.bounds == 1.0
    rows, powers = sparse(grid.rows(limits, segment.hinge))[some], grid.powers[some]
    one, infinite = np.ones(len(powers)), np.full(len(powers), np.inf)
    every = to_casadi(_relaxed(sparse(fixed.matrix).tocoo(), rows.tocoo(), powers))
    program = {"h": casadi.Sparsity(grid.size + 1, grid.size + 1), "a": every.sparsity()}
    options = {"max_iter": MAX_LINEAR_ITERATIONS, "eps_abs": LINEAR_PRECISION, "eps_rel": LINEAR_PRECISION / 10}
    solver = casadi.conic("relaxed", "piqp", program, {"error_on_fail": False, "piqp": options})
    solution = solver(
        g=np.append(np.zeros(grid.size), 1.0),
        a=every,
        lba=np.concatenate([fixed.values, -infinite, -one]),
        uba=np.concatenate([fixed.values, one, infinite]),
        lbx=np.append(lower, easy),
        ubx=np.append(upper, np.inf),
    )
    if not solver.stats()["success"]:
        return None
    variables, multipliers = (np.array(solution[name]).ravel() for name in ("x", "lam_a"))
    count = len(fixed.values)
    pulls = np.abs(multipliers[count:]).reshape(2, -1).max(axis=0)
    return Relaxation(variables[:-1], float(variables[-1]), multipliers[:count], pulls)


def _relaxed(fixed, rows, powers):
    """Stack equality constraints with relaxed lower and upper limits."""
    above, (count, size) = fixed.shape[0], rows.shape
    every, last = np.arange(count), np.full(count, size)
    down = [fixed.row, rows.row + above, every + above, rows.row + above + count, every + above + count]
    across = [fixed.col, rows.col, last, rows.col, last]
    data = np.concatenate([fixed.data, rows.data, -powers, rows.data, powers])
    shape = (above + 2 * count, size + 1)
    return scipy.sparse.coo_array((data, (np.concatenate(down), np.concatenate(across))), shape=shape).tocsc()


def find_free_motion(times, keys: Keys, limits: Limits, desired):
    """Compute `spline_program.find_free_motion` segment by segment."""
    controls, beyond = np.empty((len(desired) + 2, desired.shape[1])), []
    for segment in segments(times, keys, KNOT_INTERVAL):
        part = nearest_without_limits(segment, desired[segment.knots, segment.hinge])
        controls[segment.controls, segment.hinge] = part
        ratio = segment.grid.largest_limit_ratio(part, limits, segment.hinge)
        if ratio > KEPT_RATIO:
            beyond.append((ratio, segment))
    return controls, beyond
