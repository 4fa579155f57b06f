import numpy as np
import pytest

from kinesic.motion.recursion import sum_decaying


@pytest.mark.parametrize("factor", [-0.9, -0.27, 0.0, 0.5, 0.999])
@pytest.mark.parametrize("count", [1, 2, 3, 100, 1000])
def test_decaying_row_sums_equal_their_recursive_definition(factor: float, count: int):
    values = np.random.default_rng(count).normal(size=(count, 3))
    given, sums = values.copy(), sum_decaying(values, factor)
    np.testing.assert_array_equal(sums[0], values[0])
    np.testing.assert_allclose(sums[1:], values[1:] + factor * sums[:-1], atol=1e-11)
    np.testing.assert_array_equal(values, given)
