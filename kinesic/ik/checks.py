"""What the numbers of a question must look like; everything else is refused with what would have worked."""

import numpy as np

from kinesic.body.arrays import Floats


def as_floats(name: str, values: Floats, shape: tuple[int, ...]) -> Floats:
    """The values as floats.

    Raises:
        ValueError: the shape is wrong or a number is not finite.
    """
    array = np.asarray(values, dtype=np.float64)
    if array.shape != shape:
        raise ValueError(f"{name} has shape {array.shape}; it needs shape {shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} is {array.tolist()}; every number must be finite")
    return array
