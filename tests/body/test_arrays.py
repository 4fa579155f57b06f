import numpy as np
import pytest

from kinesic.body.arrays import sealed


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
