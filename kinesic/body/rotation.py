"""The few rotation formulas that hinges need; everything else is `scipy.spatial.transform`."""

import numpy as np

from kinesic.body.arrays import Floats


def about(axis: Floats, angle: float) -> Floats:
    """Rotation matrix of a turn about an axis (Rodrigues' formula).

    Args:
        axis: (3,) unit vector.
        angle: turn in [rad].

    Returns:
        (3, 3) rotation matrix.
    """
    x, y, z = axis
    c, s = np.cos(angle), np.sin(angle)
    d = 1.0 - c
    return np.array(
        [
            [c + x * x * d, x * y * d - z * s, x * z * d + y * s],
            [y * x * d + z * s, c + y * y * d, y * z * d - x * s],
            [z * x * d - y * s, z * y * d + x * s, c + z * z * d],
        ]
    )
