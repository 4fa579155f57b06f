import numpy as np
import pytest

from kinesic.body import arrays
from kinesic.body.arrays import distinct_rows, sealed


def test_a_sealed_array_cannot_be_written():
    array = sealed([1, 2, 3])
    assert array.dtype == np.float64
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 5.0


def test_sealing_copies():
    source = np.zeros(2)
    array = sealed(source)
    source[0] = 1.0
    assert array[0] == 0.0
    assert source.flags.writeable


def test_rows_that_do_not_change_are_one():
    rows = np.array([[0.0, 1.0], [0.0, 1.0], [0.0, 1.0 + 4e-4], [0.5, 1.0], [0.0, 1.0], [0.0, 1.0]])
    chosen, back = distinct_rows(rows, 1e-3)
    assert chosen.tolist() == [0, 3, 4]
    assert back.tolist() == [0, 0, 0, 1, 2, 2]


def test_what_creeps_is_not_taken_for_still():
    creeping = np.linspace(0.0, 1.0, 10_001)[:, None]
    chosen, back = distinct_rows(creeping, 1e-2)
    assert np.abs(creeping - creeping[chosen][back]).max() < 1.001e-2
    assert 90 < len(chosen) < 110


def test_rows_are_the_same_however_many_are_compared_together(monkeypatch):
    rows = np.random.default_rng(4).integers(0, 2, (50, 1)).astype(float)
    at_once = distinct_rows(rows, 0.5)
    monkeypatch.setattr(arrays, "ROWS_PER_COMPARISON", 7)
    for one, other in zip(at_once, distinct_rows(rows, 0.5), strict=True):
        assert np.array_equal(one, other)


def test_no_rows_are_none():
    chosen, back = distinct_rows(np.empty((0, 3)), 1e-3)
    assert (len(chosen), len(back)) == (0, 0)
