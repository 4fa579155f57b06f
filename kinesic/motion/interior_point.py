"""Large sparse linear programs solved by PIQP through CasADi."""

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.linear_program import SparseMatrix

if TYPE_CHECKING:
    import casadi

MAX_ITERATIONS = 250  # largest number of iterations of the interior-point method


def solve_by_interior_point(
    costs: Floats,
    matrix: SparseMatrix,
    bounds: tuple[Floats, Floats],
    ranges: tuple[Floats, Floats],
    *,
    precision: float,
) -> Floats | None:
    """Solve a linear program for the variables of least cost.

    Args:
        costs: (n,) cost of each variable.
        matrix: (m, n) rows.
        bounds: (m,) smallest and largest value of each row.
        ranges: (n,) smallest and largest value of each variable.
        precision: absolute tolerance of rows and variables.

    Returns:
        (n,) variables, or None if the solver does not converge.
    """
    import casadi  # noqa: PLC0415 - takes longer to import than a gesture takes to plan, and few plans need it

    starts, rows, values = matrix.compress()
    pattern = _pattern(matrix.shape, starts.tobytes(), rows.tobytes())
    solver = casadi.conic(
        "linear",
        "piqp",
        {"h": casadi.Sparsity(len(costs), len(costs)), "a": pattern},
        {
            "error_on_fail": False,
            "piqp": {"max_iter": MAX_ITERATIONS, "eps_abs": precision, "eps_rel": precision / 10},
        },
    )
    # CasADi reads lists faster than arrays
    edges = dict(zip(("lba", "uba", "lbx", "ubx"), (values.tolist() for values in (*bounds, *ranges)), strict=True))
    solution = solver(a=casadi.DM(pattern, values.tolist()), g=costs.tolist(), **edges)
    return np.array(solution["x"]).ravel() if solver.stats()["success"] else None


@lru_cache(maxsize=256)
def _pattern(shape: tuple[int, int], starts: bytes, rows: bytes) -> "casadi.Sparsity":
    """Return the cached sparsity pattern of a repeated program."""
    import casadi  # noqa: PLC0415 - as above

    return casadi.Sparsity(*shape, *(np.frombuffer(part, dtype=np.intp).tolist() for part in (starts, rows)))
