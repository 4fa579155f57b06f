"""Painting of pores, creases of the lips and oily skin."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.face.assets.late_scipy import scipy

PORE_SIZE = 0.75  # [pixels] standard deviation of the blurred noise whose peaks are pores
PORE_THRESHOLD = 0.2  # [standard deviations] noise above which there is a pore
PORE_DEPTH_RANGE = 2.5  # [standard deviations] noise above the threshold at which a pore is deepest
MIN_PORE_DENSITY = 0.45  # depth of pores on cheeks and temples, relative to nose and forehead
OILY_AREAS = (  # chart coordinates a and y of the centre, half width aside and up
    (0.0, -0.45, 0.22, 0.45),  # nose
    (0.0, 0.80, 0.75, 0.40),  # forehead
    (0.0, -1.60, 0.30, 0.25),  # chin
    (0.55, -0.45, 0.30, 0.25),  # cheekbones
)
CREASE_SIZE = (9.0, 1.3)  # [pixels] standard deviations up and aside of the blurred noise whose peaks are creases


def paint_oil(a: Floats, y: Floats) -> Floats:
    """Return the (n, m) oil on the skin, 0 (dry) to 1.

    Args:
        a: (1, m) absolute chart coordinates to either side.
        y: (n, 1) chart heights.
    """
    dry = np.ones(np.broadcast_shapes(a.shape, y.shape))
    for aside, up, wide, high in OILY_AREAS:
        dry *= 1.0 - np.exp(-(((a - aside) / wide) ** 2) - ((y - up) / high) ** 2)
    return np.asarray(1.0 - dry)


def paint_pores(oil: Floats, random: np.random.Generator) -> Floats:
    """Return the (n, m) depth of pores, 0 (none) to 1.

    Oily skin has the deepest.

    Args:
        oil: (n, m) oil on the skin, 0..1.
        random: random generator.
    """
    noise = scipy.ndimage.gaussian_filter(random.standard_normal(oil.shape), PORE_SIZE, mode="wrap")
    depth = np.clip((noise / noise.std() - PORE_THRESHOLD) / PORE_DEPTH_RANGE, 0.0, 1.0)
    return np.asarray(depth * (MIN_PORE_DENSITY + (1.0 - MIN_PORE_DENSITY) * oil))


def paint_creases(height: int, width: int, random: np.random.Generator) -> Floats:
    """Return the (height, width) depth of upright creases of the lips, 0..1."""
    noise = scipy.ndimage.gaussian_filter(random.standard_normal((height, width)), CREASE_SIZE, mode="wrap")
    return np.asarray(np.clip(noise / noise.std() / PORE_DEPTH_RANGE, 0.0, 1.0))
