"""The array types of the project, and how an array becomes read-only."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.intp]
Picture = NDArray[np.uint8]  # (height, width, 3) sRGB, first row on top

ROWS_PER_COMPARISON = 4096  # rows that are compared together


def distinct_rows(values: Floats, least: float) -> tuple[Indices, Indices]:
    """Finds the rows that differ from the one before: where nothing changes, one row stands for many.

    Args:
        values: (m, n).
        least: what is the same: each row is nearer than this to the one that stands for it.

    Returns:
        (k,) the rows that stand for themselves and those after them; (m,) index of the one that stands for each.
    """
    fresh = np.ones(len(values), dtype=np.bool_)
    for begin in range(0, len(values) - 1, ROWS_PER_COMPARISON):
        steps = np.round(values[begin : begin + ROWS_PER_COMPARISON + 1] / least)
        fresh[begin + 1 : begin + ROWS_PER_COMPARISON + 1] = np.any(steps[1:] != steps[:-1], axis=1)
    return np.flatnonzero(fresh), np.cumsum(fresh) - 1


def sealed(values: ArrayLike) -> Floats:
    """Returns a read-only float64 copy: what every array in a public type goes through."""
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


def seal_own(values: Floats) -> Floats:
    """Makes an array that nobody else holds read-only, without copying it."""
    values.setflags(write=False)
    return values
