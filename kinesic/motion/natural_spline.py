"""Natural cubic splines."""

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.motion.piecewise import PiecewisePolynomial


def natural_spline(knots: Floats, points: Floats) -> PiecewisePolynomial:
    """Interpolate points by a cubic spline without curvature at its ends.

    Args:
        knots: (k,) increasing parameters of the points, at least two.
        points: (k, n).
    """
    steps = np.diff(knots)
    chords = np.diff(points, axis=0) / steps[:, None]
    system = np.diag(2.0 * (steps[:-1] + steps[1:])) + np.diag(steps[1:-1], 1) + np.diag(steps[1:-1], -1)
    curvatures = np.zeros_like(points)
    curvatures[1:-1] = np.linalg.solve(system, 6.0 * np.diff(chords, axis=0))
    before, after = curvatures[:-1], curvatures[1:]
    cubes = (after - before) / (6.0 * steps[:, None])
    slopes = chords - steps[:, None] * (2.0 * before + after) / 6.0
    return PiecewisePolynomial(sealed(knots), sealed(np.stack([cubes, before / 2.0, slopes, points[:-1]])))
