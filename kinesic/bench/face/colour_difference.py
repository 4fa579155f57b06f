"""Differences of colours as people see them: CIE 1976 L*a*b* (thesis 3.5)."""

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats

TO_XYZ = np.array(  # IEC 61966-2-1, D65
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
WHITE = np.array([0.95047, 1.0, 1.08883])
SMALL, STEEP = 216 / 24389, 24389 / 27


def lab(pixels: NDArray[np.uint8]) -> Floats:
    """(..., 3) L*, a* and b* of (..., 3) sRGB pixels."""
    told = pixels / 255.0
    linear = np.where(told <= 0.04045, told / 12.92, ((told + 0.055) / 1.055) ** 2.4)
    shares = linear @ TO_XYZ.T / WHITE
    x, y, z = np.moveaxis(np.where(shares > SMALL, np.cbrt(shares), (STEEP * shares + 16) / 116), -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def difference(one: NDArray[np.uint8], other: NDArray[np.uint8]) -> Floats:
    """(...) how far colours are apart; 1 is about what can be told."""
    return np.asarray(np.linalg.norm(lab(one) - lab(other), axis=-1))
