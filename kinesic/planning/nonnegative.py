"""Least squares with non-negative variables (Lawson and Hanson, 1974)."""

import numpy as np

from kinesic.body.arrays import Flags, Floats

GRADIENT_TOLERANCE = 1e-13  # relative gradient up to which a variable stays at 0
MAX_EXCHANGES = 4  # largest number of iterations / number of variables


def solve_nonnegative(matrix: Floats, target: Floats) -> Floats:
    """Find nonnegative variables (n,) with matrix @ variables nearest to a target.

    Variables become positive one by one, those first that reduce the residual most. One that would become negative
    returns to 0.

    Args:
        matrix: (m, n).
        target: (m,).
    """
    variables, positive = np.zeros(matrix.shape[1]), np.zeros(matrix.shape[1], dtype=np.bool_)
    tolerance = GRADIENT_TOLERANCE * float(np.linalg.norm(matrix, axis=0).max(initial=0.0) * np.linalg.norm(target))
    for _ in range(MAX_EXCHANGES * len(variables)):
        slopes = matrix.T @ (target - matrix @ variables)
        slopes[positive] = -np.inf
        new = int(slopes.argmax())
        if slopes[new] <= tolerance:
            break
        positive[new] = True
        nearest = _solve_free(matrix, target, positive)
        while (negative := np.flatnonzero(nearest < 0.0)).size:
            shares = variables[negative] / (variables[negative] - nearest[negative])
            variables += shares.min() * (nearest - variables)
            first = negative[shares.argmin()]
            variables[first], positive[first] = 0.0, False
            nearest = _solve_free(matrix, target, positive)
        variables = nearest
        if not positive[new]:  # its slope was a rounding error
            break
    return variables


def _solve_free(matrix: Floats, target: Floats, free: Flags) -> Floats:
    """Solve least squares for the free variables, with the others 0, (n,)."""
    variables = np.zeros(matrix.shape[1])
    variables[free] = np.linalg.lstsq(matrix[:, free], target)[0]
    return variables
