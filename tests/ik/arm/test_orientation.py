"""Tests of hand orientations from pointing and palm directions."""

import math

import numpy as np
import pytest
from numpy.random import default_rng
from scipy.spatial.transform import Rotation

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.ik.arm.orientation import orientation_of
from kinesic.ik.scalar3 import IDENTITY_ROTATION, rotated, unit, vector

from ...reference.ik.pose import shortest_turn

LEFT_ARM = Robot.load().arms["l"]  # chain of the left arm


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.3, 3.0, math.pi])
def test_shortest_rotation_maps_one_orientation_to_the_other(angle: float):
    for axis in [*np.eye(3), *default_rng(27).normal(size=(8, 3))]:
        turn = angle * axis / np.linalg.norm(axis)
        wanted = Rotation.from_rotvec(turn).as_matrix()
        result = shortest_turn(_turn(np.eye(3)), _turn(wanted))
        assert np.linalg.norm(result) == pytest.approx(angle, abs=1e-9)
        np.testing.assert_allclose(Rotation.from_rotvec(result).as_matrix(), wanted, atol=1e-7)
    present = Rotation.from_rotvec([0.3, -0.2, 0.9])
    turn = Rotation.from_rotvec([0.1, 0.5, -0.4])
    result = shortest_turn(_turn(present.as_matrix()), _turn((turn * present).as_matrix()))
    assert result == pytest.approx([0.1, 0.5, -0.4])


def test_shortest_rotation_between_frames_half_a_turn_apart_is_pi_about_their_common_axis():
    for k in range(3):
        half = np.diag([1.0 if row == k else -1.0 for row in range(3)])
        assert np.abs(shortest_turn(IDENTITY_ROTATION, _turn(half))) == pytest.approx(np.pi * np.eye(3)[k])


def test_pointing_and_palm_directions_define_a_hand_orientation():
    random, along = default_rng(28), unit(vector(LEFT_ARM.joints[-1].bone))
    for turn in Rotation.random(20, random_state=3).as_matrix():
        pointing, palm = (unit(rotated(_turn(turn), own)) for own in (along, vector(LEFT_ARM.palm)))
        assert orientation_of(LEFT_ARM, pointing, palm) == pytest.approx(turn.ravel(), abs=1e-12)
        skewed = unit(vector(np.array(palm) + random.uniform(-2.0, 2.0) * np.array(pointing)))
        assert orientation_of(LEFT_ARM, pointing, skewed) == pytest.approx(turn.ravel(), abs=1e-12)
        assert orientation_of(LEFT_ARM, pointing, pointing) is None
        assert orientation_of(LEFT_ARM, pointing, (0.0, 0.0, 0.0)) is None


def _turn(matrix: Floats) -> tuple[float, ...]:
    a, b, c, d, e, f, g, h, i = matrix.ravel().tolist()
    return a, b, c, d, e, f, g, h, i
