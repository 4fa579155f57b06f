"""Rotation matrices, rotation vectors and quaternions.

Matrices act on column vectors. A rotation vector is the unit axis times the angle [rad]. Quaternions are unit, ordered
x, y, z, w. All functions but the last two accept any leading dimensions.
"""

import numpy as np

from kinesic.body.arrays import Floats

IDENTITY_ROTATION = np.eye(3)  # rotation matrix by an angle of zero
CROSS_PRODUCT = np.zeros((3, 3, 3))  # [a]_ij = sum_k CROSS_PRODUCT[k, i, j] a_k, the cross product matrix of a
CROSS_PRODUCT[[0, 1, 2], [2, 0, 1], [1, 2, 0]] = 1.0
CROSS_PRODUCT[[0, 1, 2], [1, 2, 0], [2, 0, 1]] = -1.0
MIN_SINE = 1e-150  # smallest norm of a vector that defines a rotation axis


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


def vector_to_rotation(vectors: Floats) -> Floats:
    """Convert rotation vectors (..., 3) [rad] to rotation matrices (..., 3, 3)."""
    angles = np.linalg.norm(vectors, axis=-1)
    return rotation_about(vectors / np.maximum(angles, MIN_SINE)[..., None], angles)


def rotation_to_vector(rotations: Floats) -> Floats:
    """Convert rotation matrices to rotation vectors of at most half a turn.

    Args:
        rotations: (..., 3, 3).

    Returns:
        (..., 3) [rad].
    """
    quaternions = rotation_to_quaternion(rotations)
    quaternions *= np.where(quaternions[..., 3:] < 0.0, -1.0, 1.0)
    sines = np.linalg.norm(quaternions[..., :3], axis=-1)
    scales = 2.0 * np.arctan2(sines, quaternions[..., 3]) / np.maximum(sines, MIN_SINE)
    vectors: Floats = scales[..., None] * quaternions[..., :3]
    return vectors


def quaternion_to_rotation(quaternions: Floats) -> Floats:
    """Convert quaternions (..., 4) of any length but 0 to rotation matrices."""
    unit = quaternions / np.linalg.norm(quaternions, axis=-1, keepdims=True)
    imaginary, real = unit[..., :3], unit[..., 3, None, None]
    cross = (imaginary @ CROSS_PRODUCT.reshape(3, 9)).reshape(*imaginary.shape, 3)
    rotations: Floats = IDENTITY_ROTATION + 2.0 * (real * cross + cross @ cross)
    return rotations


def rotation_to_quaternion(rotations: Floats) -> Floats:
    """Convert rotation matrices to quaternions with a positive largest component.

    The columns of 4 q q^T follow from sums and differences of the matrix. The column with the largest diagonal entry is
    accurate at every angle (Markley, 2008).

    Args:
        rotations: (..., 3, 3).

    Returns:
        (..., 4) unit quaternions x, y, z, w.
    """
    products = np.empty((*rotations.shape[:-2], 4, 4))
    diagonal = np.diagonal(rotations, axis1=-2, axis2=-1)
    trace = diagonal.sum(axis=-1, keepdims=True)
    products[..., :3, :3] = rotations + np.swapaxes(rotations, -1, -2)
    products[..., [0, 1, 2], [0, 1, 2]] = 1.0 + 2.0 * diagonal - trace
    products[..., 3, 3] = 1.0 + trace[..., 0]
    products[..., 3, :3] = products[..., :3, 3] = np.einsum("kij,...ij->...k", CROSS_PRODUCT, rotations)
    largest = np.diagonal(products, axis1=-2, axis2=-1).argmax(axis=-1)
    columns = np.take_along_axis(products, largest[..., None, None], axis=-1)[..., 0]
    quaternions: Floats = columns / np.linalg.norm(columns, axis=-1, keepdims=True)
    return quaternions


def shortest_rotation(start: Floats, end: Floats) -> Floats:
    """Return the smallest rotation (3, 3) from one direction to another.

    Parallel directions give the identity. Opposite directions give a half turn about some perpendicular axis.

    Args:
        start: (3,) vector of any length but 0.
        end: (3,) likewise.
    """
    normal = np.cross(start, end)
    sine, cosine = float(np.linalg.norm(normal)), float(start @ end)
    if sine < MIN_SINE:
        if cosine > 0.0:
            return IDENTITY_ROTATION
        normal = np.cross(start, IDENTITY_ROTATION[np.abs(start).argmin()])
    return rotation_about(normal / np.linalg.norm(normal), float(np.arctan2(sine, cosine)))


def mean_rotation(rotations: Floats, weights: Floats) -> Floats:
    """Return the weighted mean (3, 3) of rotation matrices.

    It minimises the weighted sum of squared chordal distances (Markley et al., 2007): the mean quaternion is the main
    eigenvector of sum w q q^T, which does not depend on the signs of the quaternions.

    Args:
        rotations: (n, 3, 3).
        weights: (n,) not negative.
    """
    quaternions = rotation_to_quaternion(rotations)
    return quaternion_to_rotation(np.linalg.eigh((weights * quaternions.T) @ quaternions)[1][:, -1])
