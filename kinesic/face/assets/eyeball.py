"""Shape of an eyeball: a sphere with a cornea."""

import numpy as np

from kinesic.body.arrays import Floats

CORNEA_ANGLE = np.radians(30.0)  # [rad] half angle of the cornea at the eyeball's centre; equal to organs.frag.glsl
CORNEA_HEIGHT = 0.05  # height of the cornea over the sphere, in radii of the eyeball


def compute_cornea_bulge(angle: Floats) -> Floats:
    """Return the (n,) cornea height at angles from the eye's axis [rad].

    Heights are in radii of the eyeball.
    """
    inside = np.maximum(1.0 - (angle / CORNEA_ANGLE) ** 2, 0.0)
    return np.asarray(CORNEA_HEIGHT * inside * inside)
