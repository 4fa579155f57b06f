import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from kinesic.motion.natural_spline import natural_spline


@pytest.mark.parametrize("count", [2, 3, 4, 12])
def test_natural_spline_matches_scipy(count):
    random = np.random.default_rng(count)
    knots, points = np.cumsum(random.uniform(0.1, 1.0, count)), random.normal(size=(count, 3))
    at = np.linspace(knots[0], knots[-1], 50)
    expected = CubicSpline(knots, points, bc_type="natural")(at)
    np.testing.assert_allclose(natural_spline(knots, points).at(at), expected, atol=1e-12)
