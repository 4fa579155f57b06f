import numpy as np
import pytest

from kinesic.body.rotation import rotation_about

X, Y, Z = np.eye(3)


@pytest.mark.parametrize(("axis", "before", "after"), [(X, Y, Z), (Y, Z, X), (Z, X, Y)])
def test_positive_rotation_follows_the_right_hand_rule(axis, before, after):
    np.testing.assert_allclose(rotation_about(axis, np.pi / 2) @ before, after, atol=1e-15)


def test_rotation_by_zero_is_the_identity():
    np.testing.assert_array_equal(rotation_about(Z, 0.0), np.eye(3))
