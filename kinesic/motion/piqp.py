"""Solves linear programs of any shape by CasADi's PIQP, and those of segments where nothing is compiled."""

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
import scipy

from kinesic.body.arrays import Floats
from kinesic.body.limits import Limits
from kinesic.motion.segments import SplineSegment

if TYPE_CHECKING:
    import casadi

ITERATIONS = 40  # feasible programs take half as many
MANY = 64  # rows of what is fixed, from which on a sparse system is solved sooner than a dense one
TINY = 1e-10  # that keeps rows apart which fix nearly the same

Corridor = tuple[Floats, Floats]  # (k + 3,) [rad] lowest and highest control points


def smooth(segment: SplineSegment, bands: Floats, pull: Floats) -> Floats:
    """Finds the control points (k + 3,) [rad] of least cost x' H x / 2 - pull' x under what is fixed.

    Args:
        segment: of k pieces.
        bands: (w + 1, k + 3) diagonals of H, upper form.
        pull: (k + 3,).
    """
    matrix, values = segment.fixed.matrix, segment.fixed.values
    if len(values) >= MANY:
        nearly, size, width = -TINY * scipy.sparse.eye_array(len(values)), segment.grid.size, len(bands) - 1
        offsets = [*range(-width, width + 1)]
        diagonals = [bands[width - abs(offset), abs(offset) :] for offset in offsets]
        form = scipy.sparse.diags_array(diagonals, offsets=offsets, shape=(size, size))
        system = scipy.sparse.block_array([[form, matrix.T], [matrix, nearly]], format="csc")
        return np.asarray(scipy.sparse.linalg.spsolve(system, np.concatenate([pull, values]))[:size])
    factor = scipy.linalg.cholesky_banded(bands)
    solved = scipy.linalg.cho_solve_banded((factor, False), np.hstack([pull[:, None], matrix.T.toarray()]))
    free, pulls = solved[:, 0], solved[:, 1:]
    return np.asarray(free + pulls @ np.linalg.lstsq(matrix @ pulls, values - matrix @ free)[0])


def nearest_within_limits(segment: SplineSegment, pull: Floats, limits: Limits, corridor: Corridor) -> Floats | None:
    """Finds the control points (k + 3,) [rad] nearest to a desired motion within limits; None when there are none."""
    grid, fixed, (lower, upper) = segment.grid, segment.fixed, corridor
    rows = grid.rows(limits, segment.hinge)
    form, every = numbers(grid.closeness), numbers(_stacked(fixed.matrix, rows))
    program = {"h": form.sparsity(), "a": every.sparsity()}
    import casadi  # noqa: PLC0415 - only where nothing is compiled, and for linear programs

    solver = casadi.conic("nearest", "piqp", program, {"error_on_fail": False, "piqp": {"max_iter": ITERATIONS}})
    solution = solver(
        h=form,
        g=column(-pull),
        a=every,
        lba=column(np.concatenate([fixed.values, -grid.bounds])),
        uba=column(np.concatenate([fixed.values, grid.bounds])),
        lbx=column(lower),
        ubx=column(upper),
    )
    return np.array(solution["x"]).ravel() if solver.stats()["success"] else None


def relax_limits(
    segment: SplineSegment, limits: Limits, corridor: Corridor, easy: float
) -> tuple[Floats, float, Floats, Floats] | None:
    """Finds the least relaxation of limits: control points, amount, multipliers of what is fixed and of limits."""
    grid, fixed, (lower, upper) = segment.grid, segment.fixed, corridor
    some = grid.bounds == 1.0
    rows, powers = grid.rows(limits, segment.hinge)[some], grid.powers[some]
    one, endless = np.ones(len(powers)), np.full(len(powers), np.inf)
    solution = solve_linear(
        np.append(np.zeros(grid.size), 1.0),
        _relaxed(fixed.matrix.tocoo(), rows.tocoo(), powers),
        (np.concatenate([fixed.values, -endless, -one]), np.concatenate([fixed.values, one, endless])),
        (np.append(lower, easy), np.append(upper, np.inf)),
    )
    if solution is None:
        return None
    found, pulls = solution
    count = len(fixed.values)
    return found[:-1], float(found[-1]), pulls[:count], np.abs(pulls[count:]).reshape(2, -1).max(axis=0)


def _relaxed(
    fixed: "scipy.sparse.coo_array", rows: "scipy.sparse.coo_array", powers: Floats
) -> "scipy.sparse.csc_array":
    """Stacks what is fixed, the rows of limits less what relaxes them (the last variable), and the rows plus it."""
    above, (count, size) = fixed.shape[0], rows.shape
    every, last = np.arange(count), np.full(count, size)
    down = [fixed.row, rows.row + above, every + above, rows.row + above + count, every + above + count]
    across = [fixed.col, rows.col, last, rows.col, last]
    data = np.concatenate([fixed.data, rows.data, -powers, rows.data, powers])
    shape = (above + 2 * count, size + 1)
    return scipy.sparse.coo_array((data, (np.concatenate(down), np.concatenate(across))), shape=shape).tocsc()


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
    import casadi  # noqa: PLC0415 - as above

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


def numbers(matrix: "scipy.sparse.csc_array") -> "casadi.DM":
    """Converts a sparse matrix for CasADi."""
    shape = (int(matrix.shape[0]), int(matrix.shape[1]))
    import casadi  # noqa: PLC0415 - as above

    pattern = _pattern(shape, matrix.indptr.astype(np.int64).tobytes(), matrix.indices.astype(np.int64).tobytes())
    return casadi.DM(pattern, matrix.data.tolist())


def column(values: Floats) -> "casadi.DM":
    """Converts (k,) to (k, 1) for CasADi, which reads lists sooner than arrays."""
    import casadi  # noqa: PLC0415 - as above

    return casadi.DM(values.tolist())


@lru_cache(maxsize=256)
def _pattern(shape: tuple[int, int], starts: bytes, indices: bytes) -> "casadi.Sparsity":
    """Remembered, as most segments are looked at more than once."""
    import casadi  # noqa: PLC0415 - as above

    return casadi.Sparsity(*shape, *(np.frombuffer(each, dtype=np.int64).tolist() for each in (starts, indices)))
