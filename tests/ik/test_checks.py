import numpy as np
import pytest

from kinesic.ik.checks import as_floats


def test_good_numbers_pass_as_floats():
    assert as_floats("place", [1, 2, 3], (3,)).dtype == np.float64


def test_others_are_refused_and_explained():
    with pytest.raises(ValueError, match=r"place has shape \(2,\); it needs shape \(3,\)"):
        as_floats("place", np.zeros(2), (3,))
    with pytest.raises(ValueError, match=r"place is \[inf, 0.0\]; every number must be finite"):
        as_floats("place", np.array([np.inf, 0.0]), (2,))
