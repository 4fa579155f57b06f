import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kinesic.body.rotation import (
    mean_rotation,
    quaternion_to_rotation,
    rotation_about,
    rotation_to_quaternion,
    rotation_to_vector,
    shortest_rotation,
    vector_to_rotation,
)

X, Y, Z = np.eye(3)
RANDOM_AXES = Rotation.random(200, random_state=3).apply(X)  # (200, 3) random unit vectors
# Rotations of every size: random, half turns about the axes, almost half turns, tiny, and none.
ROTATION_VECTORS = np.concatenate(
    [
        np.linspace(0.0, 3.1, 200)[:, None] * RANDOM_AXES,
        np.pi * np.eye(3),
        (np.pi - 1e-9) * RANDOM_AXES,
        1e-9 * RANDOM_AXES,
        1e-200 * RANDOM_AXES,
        np.zeros((1, 3)),
    ]
)


@pytest.mark.parametrize(("axis", "before", "after"), [(X, Y, Z), (Y, Z, X), (Z, X, Y)])
def test_positive_rotation_follows_the_right_hand_rule(axis, before, after):
    np.testing.assert_allclose(rotation_about(axis, np.pi / 2) @ before, after, atol=1e-15)
    np.testing.assert_allclose(vector_to_rotation(np.pi / 2 * axis) @ before, after, atol=1e-15)


def test_rotation_by_zero_angle_is_the_identity():
    np.testing.assert_array_equal(rotation_about(Z, 0.0), np.eye(3))
    np.testing.assert_array_equal(vector_to_rotation(np.zeros(3)), np.eye(3))


def test_rotation_vectors_and_quaternions_match_scipy():
    rotations = Rotation.from_rotvec(ROTATION_VECTORS)
    matrices = rotations.as_matrix()
    np.testing.assert_allclose(vector_to_rotation(ROTATION_VECTORS), matrices, atol=1e-14)
    np.testing.assert_allclose(quaternion_to_rotation(3.0 * rotations.as_quat()), matrices, atol=1e-14)
    np.testing.assert_allclose(rotation_to_quaternion(matrices), Rotation.from_matrix(matrices).as_quat(), atol=1e-14)
    vectors = rotation_to_vector(matrices)
    np.testing.assert_allclose(vectors[:200], ROTATION_VECTORS[:200], atol=1e-12)
    np.testing.assert_allclose(vectors[403:603], ROTATION_VECTORS[403:603], atol=1e-16)
    assert (rotations.inv() * Rotation.from_rotvec(vectors)).magnitude().max() < 1e-14


def test_rotation_vector_conversion_keeps_leading_dimensions():
    vectors = ROTATION_VECTORS[:12].reshape(2, 6, 3)
    matrices = vector_to_rotation(vectors)
    assert matrices.shape == (2, 6, 3, 3)
    np.testing.assert_allclose(rotation_to_vector(matrices), vectors, atol=1e-14)
    assert rotation_to_vector(np.zeros((0, 3, 3))).shape == (0, 3)


def test_shortest_rotation_between_two_directions_matches_scipy():
    for start, end in zip(2.0 * RANDOM_AXES[:100], 0.5 * RANDOM_AXES[100:], strict=True):
        rotation = shortest_rotation(start, end)
        expected = Rotation.align_vectors(end[None], start[None])[0].as_matrix()
        np.testing.assert_allclose(rotation, expected, atol=1e-12)


@pytest.mark.parametrize("start", [X, -2.0 * Z, RANDOM_AXES[7]])
def test_shortest_rotation_is_identity_for_parallel_and_a_half_turn_for_opposite_directions(start):
    np.testing.assert_allclose(shortest_rotation(start, 3.0 * start), np.eye(3), atol=1e-12)
    half_turn = shortest_rotation(start, -0.5 * start)
    np.testing.assert_allclose(half_turn @ start, -start, atol=1e-12)
    np.testing.assert_allclose(half_turn @ half_turn, np.eye(3), atol=1e-12)
    assert np.linalg.det(half_turn) == pytest.approx(1.0)


def test_mean_rotation_matches_scipy():
    rotations, weights = Rotation.random(6, random_state=5), np.array([0.1, 2.0, 0.0, 1.0, 3.0, 0.5])
    np.testing.assert_allclose(
        mean_rotation(rotations.as_matrix(), weights), rotations.mean(weights).as_matrix(), atol=1e-12
    )
