import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from kinesic.sim.shells.cross_sections import MonotoneCurve


@pytest.mark.parametrize("count", [2, 3, 4, 33])
@pytest.mark.parametrize("seed", range(6))
def test_monotone_curve_matches_the_pchip_interpolator_of_scipy(count, seed):
    random = np.random.default_rng(seed)
    positions, values = np.cumsum(random.uniform(0.1, 1.0, count)), random.normal(size=(count, 2))
    values[1, 0] = values[0, 0]
    at = np.linspace(positions[0], positions[-1], 70)
    expected = PchipInterpolator(positions, values)(at)
    np.testing.assert_allclose(MonotoneCurve.through(positions, values).at(at), expected, atol=1e-12)


def test_monotone_curve_does_not_overshoot_a_step():
    positions, values = np.arange(6.0), np.array([[0.0], [0.0], [0.0], [1.0], [1.0], [1.0]])
    curve = MonotoneCurve.through(positions, values).at(np.linspace(0.0, 5.0, 200))
    assert curve.min() >= 0.0
    assert curve.max() <= 1.0
    assert (np.diff(curve[:, 0]) >= -1e-12).all()
