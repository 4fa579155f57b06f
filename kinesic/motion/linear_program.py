"""Sparse linear programs solved by PIQP through CasADi."""

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
import scipy

from kinesic.body.arrays import Floats

if TYPE_CHECKING:
    import casadi

MAX_ITERATIONS = 250  # largest number of iterations of the interior-point method


def solve_linear(
    costs: Floats,
    matrix: "scipy.sparse.csc_array",
    bounds: tuple[Floats, Floats],
    ranges: tuple[Floats, Floats],
    *,
    precision: float = 1e-6,
) -> tuple[Floats, Floats] | None:
    """Solve a linear program for the variables of least cost.

    Args:
        costs: (n,) cost of each variable.
        matrix: (m, n) rows.
        bounds: (m,) smallest and largest value of each row.
        ranges: (n,) smallest and largest value of each variable.
        precision: absolute tolerance of rows and variables.

    Returns:
        (n,) variables and (m,) multipliers of the rows, or None if the solver does not converge.
    """
    import casadi  # noqa: PLC0415 - takes longer to import than a gesture takes to plan, and few plans need it

    quadratic, linear = _to_casadi(scipy.sparse.csc_array((len(costs), len(costs)))), _to_casadi(matrix)
    solver = casadi.conic(
        "linear",
        "piqp",
        {"h": quadratic.sparsity(), "a": linear.sparsity()},
        {
            "error_on_fail": False,
            "piqp": {"max_iter": MAX_ITERATIONS, "eps_abs": precision, "eps_rel": precision / 10},
        },
    )
    # CasADi reads lists faster than arrays
    edges = dict(zip(("lba", "uba", "lbx", "ubx"), (values.tolist() for values in (*bounds, *ranges)), strict=True))
    solution = solver(h=quadratic, a=linear, g=costs.tolist(), **edges)
    if not solver.stats()["success"]:
        return None
    return np.array(solution["x"]).ravel(), np.array(solution["lam_a"]).ravel()


def _to_casadi(matrix: "scipy.sparse.csc_array") -> "casadi.DM":
    import casadi  # noqa: PLC0415 - as above

    shape = (int(matrix.shape[0]), int(matrix.shape[1]))
    pattern = _pattern(shape, matrix.indptr.astype(np.int64).tobytes(), matrix.indices.astype(np.int64).tobytes())
    return casadi.DM(pattern, matrix.data.tolist())


@lru_cache(maxsize=256)
def _pattern(shape: tuple[int, int], starts: bytes, indices: bytes) -> "casadi.Sparsity":
    """Return the cached sparsity pattern of a repeated program."""
    import casadi  # noqa: PLC0415 - as above

    return casadi.Sparsity(*shape, *(np.frombuffer(part, dtype=np.int64).tolist() for part in (starts, indices)))
