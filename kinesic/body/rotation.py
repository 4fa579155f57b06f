"""Rotation matrices of hinges.

Other rotation formulas come from `scipy.spatial.transform`.
"""

import numpy as np

from kinesic.body.arrays import Floats

IDENTITY_ROTATION = np.eye(3)  # rotation matrix by an angle of zero
CROSS_PRODUCT = np.zeros((3, 3, 3))  # [a]_ij = sum_k CROSS_PRODUCT[k, i, j] a_k, the cross product matrix of a
CROSS_PRODUCT[[0, 1, 2], [2, 0, 1], [1, 2, 0]] = 1.0
CROSS_PRODUCT[[0, 1, 2], [1, 2, 0], [2, 0, 1]] = -1.0


def rotation_about(axis: Floats, angle: float | Floats) -> Floats:
    """Compute rotation matrices about an axis by Rodrigues' formula.

    R = c I + s [a] + (1 - c) a a^T, with cosine c and sine s of the angle.

    Args:
        axis: (3,) unit vector a, or (n, 3), one per rotation.
        angle: [rad] scalar or array of any shape; (..., n) for n axes.

    Returns:
        (..., 3, 3) rotation matrices.
    """
    c, s = np.cos(angle)[..., None, None], np.sin(angle)[..., None, None]
    cross, along = axis @ CROSS_PRODUCT.reshape(3, 9), axis[..., :, None] * axis[..., None, :]
    rotations: Floats = c * IDENTITY_ROTATION + s * cross.reshape(along.shape) + (1.0 - c) * along
    return rotations
