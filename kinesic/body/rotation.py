"""The few rotation formulas that hinges need; everything else is `scipy.spatial.transform`."""

import numpy as np

from kinesic.body.arrays import Floats

UNTURNED = np.eye(3)
CROSSED = np.zeros((3, 3, 3))  # [a]_ij = sum_k CROSSED[k, i, j] a_k, the matrix of the cross product with a
CROSSED[[0, 1, 2], [2, 0, 1], [1, 2, 0]] = 1.0
CROSSED[[0, 1, 2], [1, 2, 0], [2, 0, 1]] = -1.0


def about(axis: Floats, angle: float | Floats) -> Floats:
    """Makes rotation matrices of turns about an axis a: R = c I + s [a] + (1 - c) a a^T (Rodrigues).

    Args:
        axis: (3,) unit vector, or (n, 3), one for each of n turns.
        angle: turns in [rad], one or any shape of them; (..., n) for n axes.

    Returns:
        (..., 3, 3) rotation matrices.
    """
    c, s = np.cos(angle)[..., None, None], np.sin(angle)[..., None, None]
    cross, along = axis @ CROSSED.reshape(3, 9), axis[..., :, None] * axis[..., None, :]
    turned: Floats = c * UNTURNED + s * cross.reshape(along.shape) + (1.0 - c) * along
    return turned
