"""The few rotation formulas that hinges need; everything else is `scipy.spatial.transform`."""

import numpy as np

from kinesic.body.arrays import Floats

UNTURNED = np.eye(3)


def about(axis: Floats, angle: float | Floats) -> Floats:
    """Rotation matrices of turns about an axis a: R = c I + s [a] + (1 - c) a a^T (Rodrigues' formula).

    Args:
        axis: (3,) unit vector.
        angle: turns in [rad], one or any shape of them.

    Returns:
        (..., 3, 3) rotation matrices.
    """
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    c, s = np.cos(angle), np.sin(angle)
    turned: Floats = (
        np.multiply.outer(c, UNTURNED) + np.multiply.outer(s, cross) + np.multiply.outer(1.0 - c, np.outer(axis, axis))
    )
    return turned
