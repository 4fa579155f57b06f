"""Distances between many pairs of line segments."""

from typing import cast

import numpy as np

from kinesic.body.arrays import Floats


def segment_distances(a0: Floats, a1: Floats, b0: Floats, b1: Floats) -> Floats:
    """Return the distances between line segments, after Ericson, Real-Time Collision Detection, 5.1.9.

    Args:
        a0: (k, 3) [m] one end of the first segments; may equal the other.
        a1: (k, 3) [m] their other end.
        b0: (k, 3) [m] one end of the second segments.
        b1: (k, 3) [m] their other end.

    Returns:
        (k,) [m].
    """
    along_a, along_b, apart = a1 - a0, b1 - b0, a0 - b0
    aa, bb, ab = _dot(along_a, along_a), _dot(along_b, along_b), _dot(along_a, along_b)
    ar, br = _dot(along_a, apart), _dot(along_b, apart)
    s = _share(ab * br - ar * bb, aa * bb - ab * ab)  # of the unbounded lines; any s serves parallel ones
    t = _share(ab * s + br, bb)
    s = _share(ab * t - ar, aa)
    gap = apart + s[:, None] * along_a - t[:, None] * along_b
    return cast(Floats, np.sqrt(_dot(gap, gap)))


def _dot(a: Floats, b: Floats) -> Floats:
    return cast(Floats, np.einsum("kc,kc->k", a, b))


def _share(part: Floats, whole: Floats) -> Floats:
    """Return part / whole clipped to [0, 1]."""
    share = np.zeros_like(part)
    np.divide(part, whole, out=share, where=whole > np.finfo(float).tiny)
    return np.clip(share, 0.0, 1.0, out=share)
