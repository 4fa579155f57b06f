import numpy as np
import pytest

from kinesic.body import arrays
from kinesic.body.arrays import find_distinct_rows, find_runs, sealed


def test_sealed_array_is_a_read_only_float_array():
    array = sealed([1, 2, 3])
    assert array.dtype == np.float64
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 5.0


def test_sealed_array_is_independent_of_its_source():
    source = np.zeros(2)
    array = sealed(source)
    source[0] = 1.0
    assert array[0] == 0.0
    assert source.flags.writeable


def test_successive_array_rows_within_the_tolerance_are_merged():
    rows = np.array([[0.0, 1.0], [0.0, 1.0], [0.0, 1.0 + 4e-4], [0.5, 1.0], [0.0, 1.0], [0.0, 1.0]])
    chosen, back = find_distinct_rows(rows, 1e-3)
    assert chosen.tolist() == [0, 3, 4]
    assert back.tolist() == [0, 0, 0, 1, 2, 2]


def test_slowly_changing_rows_are_merged_within_the_tolerance():
    creeping = np.linspace(0.0, 1.0, 10_001)[:, None]
    chosen, back = find_distinct_rows(creeping, 1e-2)
    assert np.abs(creeping - creeping[chosen][back]).max() < 1.001e-2
    assert 90 < len(chosen) < 110


def test_distinct_array_rows_do_not_depend_on_the_batch_size(monkeypatch):
    rows = np.random.default_rng(4).integers(0, 2, (50, 1)).astype(float)
    at_once = find_distinct_rows(rows, 0.5)
    monkeypatch.setattr(arrays, "ROWS_PER_COMPARISON", 7)
    for one, other in zip(at_once, find_distinct_rows(rows, 0.5), strict=True):
        assert np.array_equal(one, other)


def test_empty_array_has_no_distinct_rows():
    chosen, back = find_distinct_rows(np.empty((0, 3)), 1e-3)
    assert (len(chosen), len(back)) == (0, 0)


@pytest.mark.parametrize(
    ("flags", "runs"), [("", []), ("000", []), ("111", [(0, 3)]), ("1001", [(0, 1), (3, 4)]), ("0110", [(1, 3)])]
)
def test_runs_of_true_values_are_found_as_half_open_intervals(flags, runs):
    assert find_runs(np.array([flag == "1" for flag in flags], dtype=np.bool_)) == runs
