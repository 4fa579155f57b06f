"""The array types of the project, and how an array becomes read-only."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.intp]


def sealed(values: ArrayLike) -> Floats:
    """Returns a read-only float64 copy: what every array in a public type goes through."""
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array
