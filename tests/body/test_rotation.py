import numpy as np
import pytest

from kinesic.body.rotation import about

X, Y, Z = np.eye(3)


@pytest.mark.parametrize(("axis", "before", "after"), [(X, Y, Z), (Y, Z, X), (Z, X, Y)])
def test_a_quarter_turn_follows_the_right_hand(axis, before, after):
    np.testing.assert_allclose(about(axis, np.pi / 2) @ before, after, atol=1e-15)


def test_no_turn_is_the_identity():
    np.testing.assert_array_equal(about(Z, 0.0), np.eye(3))
