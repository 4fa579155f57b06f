"""Array types of the project, and functions that make arrays read-only."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.intp]
Picture = NDArray[np.uint8]  # (height, width, 3) sRGB, top row first

ROWS_PER_COMPARISON = 4096  # Rows per vectorised comparison, which bounds the memory of temporaries


def find_distinct_rows(values: Floats, resolution: float) -> tuple[Indices, Indices]:
    """Find the rows that differ from the previous row after rounding.

    Runs of equal rows are replaced by their first row.

    Args:
        values: (m, n).
        resolution: values are rounded to multiples of it before they are compared.

    Returns:
        (k,) indices of the distinct rows; (m,) position of each row's representative in the first array.
    """
    is_new = np.ones(len(values), dtype=np.bool_)
    for begin in range(0, len(values) - 1, ROWS_PER_COMPARISON):
        steps = np.round(values[begin : begin + ROWS_PER_COMPARISON + 1] / resolution)
        is_new[begin + 1 : begin + ROWS_PER_COMPARISON + 1] = np.any(steps[1:] != steps[:-1], axis=1)
    return np.flatnonzero(is_new), np.cumsum(is_new) - 1


def find_runs(flags: Flags) -> list[tuple[int, int]]:
    """Return first index and end (exclusive) of each run of True values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [(int(begin), int(end)) for begin, end in edges.reshape(-1, 2)]


def sealed(values: ArrayLike) -> Floats:
    """Return a read-only float64 copy of an array.

    Every array in a public type goes through this function.
    """
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


def seal_in_place(values: Floats) -> Floats:
    """Make an array read-only without a copy.

    The caller must hold the only reference to it.
    """
    values.setflags(write=False)
    return values
