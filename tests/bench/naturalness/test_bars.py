import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.bench.naturalness.bars import COMPARED_ROWS, kolmogorov_smirnov
from kinesic.bench.naturalness.captured_table import read_captured_table
from kinesic.bench.naturalness.rows import MOTION_ROWS

SAMPLE_LISTS = st.lists(st.floats(-5.0, 5.0), min_size=1, max_size=40)


@given(SAMPLE_LISTS, SAMPLE_LISTS)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # from its p-values
def test_kolmogorov_smirnov_distance_equals_scipys(first, second):
    from scipy.stats import ks_2samp  # noqa: PLC0415 - slow import, not needed by other tests

    assert kolmogorov_smirnov(np.array(first), np.array(second)) == pytest.approx(ks_2samp(first, second).statistic)


def test_disjoint_samples_have_kolmogorov_smirnov_distance_one():
    assert kolmogorov_smirnov(np.array([1.0, 2.0]), np.array([3.0])) == 1.0
    assert kolmogorov_smirnov(np.array([1.0, 2.0]), np.array([2.0, 1.0])) == 0.0


def test_stored_percentiles_of_captured_gestures_agree_with_the_stored_samples():
    table = read_captured_table()
    assert set(table.percentiles) <= set(MOTION_ROWS)
    for name in COMPARED_ROWS:
        values = table.values[name]
        assert len(values) == 241
        assert list(values) == sorted(values)
        assert np.percentile(values, (5, 25, 50, 75, 95)) == pytest.approx(table.percentiles[name], abs=0.011)
    for percentiles in table.percentiles.values():
        assert list(percentiles) == sorted(percentiles)
