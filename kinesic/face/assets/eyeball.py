"""The shape of an eyeball: a sphere with the bulge of the cornea."""

import numpy as np

from kinesic.body.arrays import Floats

CORNEA = np.radians(30.0)  # where it ends, seen from the ball's centre; organs.frag.glsl has the same
BULGE = 0.05  # of the ball's radius, that it stands out in the middle


def cornea_bulge(angle: Floats) -> Floats:
    """(n,) how far the cornea stands out at angles from the axis of the eye [rad], in radii of the ball."""
    inside = np.maximum(1.0 - (angle / CORNEA) ** 2, 0.0)
    return np.asarray(BULGE * inside * inside)
