import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from kinesic.body.smoothing import smooth_curve


@pytest.mark.parametrize(("ends", "mode"), [("symmetric", "reflect"), ("edge", "nearest")])
@pytest.mark.parametrize("count", [3, 40])
@pytest.mark.parametrize("deviation", [0.3, 1.7, 6.6])
def test_smoothed_curve_matches_scipy(ends, mode, count, deviation):
    values = np.random.default_rng(count).normal(size=(count, 2))
    expected = gaussian_filter1d(values, deviation, axis=0, mode=mode)
    np.testing.assert_allclose(smooth_curve(values, deviation, ends=ends), expected, atol=1e-13)


def test_smoothing_keeps_a_constant_curve():
    np.testing.assert_allclose(smooth_curve(np.full((5, 1), 0.7), 2.0, ends="edge"), 0.7, atol=1e-15)
