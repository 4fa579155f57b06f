import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.bench.naturalness.bars import COMPARED, kolmogorov_smirnov
from kinesic.bench.naturalness.captured_table import captured_table
from kinesic.bench.naturalness.rows import ROWS

SAMPLES = st.lists(st.floats(-5.0, 5.0), min_size=1, max_size=40)


@given(SAMPLES, SAMPLES)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # of its p-values
def test_the_distance_is_that_of_scipy(ours, theirs):
    from scipy.stats import ks_2samp  # noqa: PLC0415 - slow to import, which every process of tests would

    assert kolmogorov_smirnov(np.array(ours), np.array(theirs)) == pytest.approx(ks_2samp(ours, theirs).statistic)


def test_samples_that_do_not_overlap_are_as_far_apart_as_can_be():
    assert kolmogorov_smirnov(np.array([1.0, 2.0]), np.array([3.0])) == 1.0
    assert kolmogorov_smirnov(np.array([1.0, 2.0]), np.array([2.0, 1.0])) == 0.0


def test_the_table_of_captured_gestures_agrees_with_itself():
    table = captured_table()
    assert set(table.percentiles) <= set(ROWS)
    for name in COMPARED:
        values = table.values[name]
        assert len(values) == 241
        assert list(values) == sorted(values)
        assert np.percentile(values, (5, 25, 50, 75, 95)) == pytest.approx(table.percentiles[name], abs=0.011)
    for percentiles in table.percentiles.values():
        assert list(percentiles) == sorted(percentiles)
