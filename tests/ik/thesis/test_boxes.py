from typing import get_args

import numpy as np
import pytest
from numpy.random import default_rng
from scipy.spatial.transform import Rotation

from kinesic.ik.thesis.boxes import EulerBoxes, EulerOrder, angles_of, rotation_of

ROTATION_ORDERS = get_args(EulerOrder)  # all orders of Euler angles


@pytest.mark.parametrize("order", ROTATION_ORDERS)
def test_euler_angles_match_scipy(order: EulerOrder):
    random = default_rng(1)
    columns = ["xyz".index(axis) for axis in order]
    for matrix in Rotation.random(50, random_state=random).as_matrix():
        angles = angles_of(matrix, order)
        assert angles[columns] == pytest.approx(Rotation.from_matrix(matrix).as_euler(order), abs=1e-9)
        assert rotation_of(angles, order) == pytest.approx(matrix, abs=1e-12)


@pytest.mark.parametrize("order", ROTATION_ORDERS)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_euler_angles_in_gimbal_lock_reproduce_the_rotation(order: EulerOrder, sign: float):
    angles = np.array([0.4, 0.4, 0.4])
    angles["xyz".index(order[1])] = sign * np.pi / 2.0
    matrix = rotation_of(angles, order)
    assert rotation_of(angles_of(matrix, order), order) == pytest.approx(matrix, abs=1e-9)


def test_default_euler_angles_have_the_published_rotation_matrix():
    phi, theta, psi = 0.3, -0.5, 0.7
    matrix = rotation_of(np.array([phi, theta, psi]), "xyz")
    assert matrix[2, 0] == pytest.approx(-np.sin(theta))
    assert matrix[0, 0] == pytest.approx(np.cos(theta) * np.cos(psi))
    assert matrix[2, 1] == pytest.approx(np.sin(phi) * np.cos(theta))


def test_rotation_is_clipped_to_euler_angle_limits():
    boxes = EulerBoxes.of([-0.2, -0.5, -1.0], [0.2, 0.5, 1.0], joints=1)
    inside = rotation_of(np.array([0.1, -0.4, 0.9]), "xyz")
    assert boxes.clamp(inside, 0) is inside
    outside = rotation_of(np.array([0.9, -0.4, -1.4]), "xyz")
    assert angles_of(boxes.clamp(outside, 0), "xyz") == pytest.approx([0.2, -0.4, -1.0])
    assert boxes.excess(outside[None]) == pytest.approx(0.7)
    assert boxes.excess(inside[None]) == 0.0


def test_euler_angle_outside_its_limits_is_clipped_to_the_nearer_limit_on_the_circle():
    boxes = EulerBoxes.of([0.0, -0.5, -0.5], [3.0, 0.5, 0.5], joints=1)
    held = boxes.clamp(rotation_of(np.array([-3.1, 0.0, 0.0]), "xyz"), 0)
    assert angles_of(held, "xyz")[0] == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("lower", "upper", "lesson"),
    [
        ([0.2, 0.0, 0.0], [0.1, 0.5, 0.5], r"joint 0 about x are \[0.2, 0.1\] rad; swap them"),
        ([-1.0, -2.0, -1.0], [1.0, 1.0, 1.0], r"about y .* in the order xyz that angle lies in \[-1.571, 1.571\]"),
        ([-1.0, -1.0, -1.0], [1.0, 1.0, 4.0], r"about z .* lies in \[-3.142, 3.142\]"),
        ([np.nan, -1.0, -1.0], [1.0, 1.0, 1.0], "about x"),
    ],
)
def test_invalid_euler_angle_limits_raise_clear_errors(lower, upper, lesson):
    with pytest.raises(ValueError, match=lesson):
        EulerBoxes.of(lower, upper, joints=2)
