"""Finds the motion that is nearest to a desired one and passes its keys within every limit: a QP for each segment.

The optimum without limits is a banded solve; where it keeps the limits it is the optimum with them, too, and no program
is needed.
"""

from functools import lru_cache

import casadi
import numpy as np
import scipy

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.motion.segments import SplineSegment

ITERATIONS = 40  # feasible programs take half as many
MANY = 64  # rows of what is fixed, from which on a sparse system is solved sooner than a dense one
TINY = 1e-10  # that keeps rows apart which fix nearly the same
WITHIN = 1.0 + 1e-9  # share of a limit that counts as kept


def nearest_motion(segment: SplineSegment, desired: Floats, limits: Limits) -> Floats | None:
    """Finds the control points (k + 3,) [rad] of a segment that are nearest to a desired motion.

    Args:
        segment: of k pieces.
        desired: (k + 1,) [rad] at its knots.
        limits: of all hinges.

    Returns:
        None when the hinge cannot pass its keys in these times.
    """
    controls = nearest_without_limits(segment, desired)
    if segment.grid.largest(controls, limits, segment.hinge) <= WITHIN:
        return controls
    return nearest_within_limits(segment, desired, limits)


def nearest_without_limits(segment: SplineSegment, desired: Floats) -> Floats:
    """Finds the control points (k + 3,) [rad] nearest to a desired motion, whatever the limits are."""
    if segment.still:
        return np.full(segment.grid.size, segment.start)
    grid = segment.grid
    return _through(segment, grid.closeness, grid.factor, grid.at_knots.T @ desired)


def smoothest(segment: SplineSegment) -> Floats:
    """Finds the control points (k + 3,) [rad] of the way through the keys with the least acceleration and jerk."""
    grid = segment.grid
    return _through(segment, grid.calmness, grid.calm, np.zeros(grid.size))


def _through(segment: SplineSegment, form: "scipy.sparse.csc_array", factor: Floats, pulled: Floats) -> Floats:
    """Optimum of a quadratic form, with its banded factor, under what is fixed."""
    matrix, values = segment.fixed
    if len(values) >= MANY:
        nearly = -TINY * scipy.sparse.eye_array(len(values))
        system = scipy.sparse.block_array([[form, matrix.T], [matrix, nearly]], format="csc")
        return np.asarray(scipy.sparse.linalg.spsolve(system, np.concatenate([pulled, values]))[: segment.grid.size])
    solved = scipy.linalg.cho_solve_banded((factor, False), np.hstack([pulled[:, None], matrix.T.toarray()]))
    free, pull = solved[:, 0], solved[:, 1:]
    return np.asarray(free + pull @ np.linalg.lstsq(matrix @ pull, values - matrix @ free)[0])


def nearest_within_limits(segment: SplineSegment, desired: Floats, limits: Limits) -> Floats | None:
    """Finds the same as `nearest_motion` where the optimum without limits is known to exceed them."""
    grid, hinge, (matrix, values) = segment.grid, segment.hinge, segment.fixed
    rows, (lower, upper) = grid.rows(limits, hinge), segment.corridor(limits, desired)
    form, every = numbers(grid.closeness), numbers(_stacked(matrix, rows))
    program = {"h": form.sparsity(), "a": every.sparsity()}
    solver = casadi.conic("nearest", "piqp", program, {"error_on_fail": False, "piqp": {"max_iter": ITERATIONS}})
    solution = solver(
        h=form,
        g=column(-(grid.at_knots.T @ desired)),
        a=every,
        lba=column(np.concatenate([values, -grid.bounds])),
        uba=column(np.concatenate([values, grid.bounds])),
        lbx=column(lower),
        ubx=column(upper),
    )
    return np.array(solution["x"]).ravel() if solver.stats()["success"] else None


def solve_linear(
    goal: Floats,
    matrix: "scipy.sparse.csc_array",
    bounds: tuple[Floats, Floats],
    ranges: tuple[Floats, Floats],
    *,
    precision: float = 1e-6,
) -> tuple[Floats, Floats] | None:
    """Finds the variables of a linear program with the smallest cost.

    Args:
        goal: (n,) cost of each variable.
        matrix: (m, n) rows.
        bounds: (m,) least and largest value of each row.
        ranges: (n,) of each variable.
        precision: absolute, of rows and variables.

    Returns:
        (n,) variables and (m,) multipliers of the rows; None where they are not found.
    """
    quadratic, linear = numbers(scipy.sparse.csc_array((len(goal), len(goal)))), numbers(matrix)
    program = {"h": quadratic.sparsity(), "a": linear.sparsity()}
    solver = casadi.conic(
        "linear",
        "piqp",
        program,
        {"error_on_fail": False, "piqp": {"max_iter": 250, "eps_abs": precision, "eps_rel": precision / 10}},
    )
    given = dict(zip(("lba", "uba", "lbx", "ubx"), map(column, (*bounds, *ranges)), strict=True))
    solution = solver(h=quadratic, a=linear, g=column(goal), **given)
    if not solver.stats()["success"]:
        return None
    return np.array(solution["x"]).ravel(), np.array(solution["lam_a"]).ravel()


def _stacked(top: "scipy.sparse.csr_array", bottom: "scipy.sparse.csr_array") -> "scipy.sparse.csc_array":
    data = np.concatenate([top.data, bottom.data])
    indices = np.concatenate([top.indices, bottom.indices])
    starts = np.concatenate([top.indptr, top.indptr[-1] + bottom.indptr[1:]])
    return scipy.sparse.csr_array((data, indices, starts), shape=(top.shape[0] + bottom.shape[0], top.shape[1])).tocsc()


def numbers(matrix: "scipy.sparse.csc_array") -> casadi.DM:
    """Converts a sparse matrix for CasADi."""
    shape = (int(matrix.shape[0]), int(matrix.shape[1]))
    pattern = _pattern(shape, matrix.indptr.astype(np.int64).tobytes(), matrix.indices.astype(np.int64).tobytes())
    return casadi.DM(pattern, matrix.data.tolist())


def column(values: Floats) -> casadi.DM:
    """Converts (k,) to (k, 1) for CasADi, which reads lists sooner than arrays."""
    return casadi.DM(values.tolist())


@lru_cache(maxsize=256)
def _pattern(shape: tuple[int, int], starts: bytes, indices: bytes) -> casadi.Sparsity:
    """Remembered, as most segments are looked at more than once."""
    return casadi.Sparsity(*shape, *(np.frombuffer(each, dtype=np.int64).tolist() for each in (starts, indices)))
