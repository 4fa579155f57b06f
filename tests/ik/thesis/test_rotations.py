import numpy as np
import pytest
from numpy.random import default_rng
from scipy.spatial.transform import Rotation

from kinesic.ik.thesis.chain import BallChain
from kinesic.ik.thesis.rotations import Carrier, aim_bones, stance_of, swivel_chain, transport_up

CURVED_CHAIN = BallChain.curved([0.2, 0.3, 0.25, 0.1])  # chain of four bones, slightly bent at each joint
FIXED_BASE = Carrier.at_rest(CURVED_CHAIN)  # unrotated base at the chain's first joint
ZERO_ROTATIONS = np.tile(np.eye(3), (4, 1, 1))  # rotation matrices of an angle of zero, one per joint


def _turns(seed: int, most: float = 1.2):
    return Rotation.from_rotvec(default_rng(seed).uniform(-most, most, (4, 3))).as_matrix()


def test_ball_joint_chain_without_rotations_is_in_its_rest_posture():
    stance = stance_of(CURVED_CHAIN, ZERO_ROTATIONS, FIXED_BASE)
    assert stance.points == pytest.approx(CURVED_CHAIN.points)
    assert stance.frames == pytest.approx(CURVED_CHAIN.frames)
    assert stance.end.rotation == pytest.approx(np.eye(3))


def test_bones_aimed_at_the_points_of_a_posture_reproduce_its_joint_positions():
    for seed in range(20):
        wished = stance_of(CURVED_CHAIN, _turns(seed), FIXED_BASE)
        stance = aim_bones(CURVED_CHAIN, ZERO_ROTATIONS, wished.points, FIXED_BASE)
        assert stance.points == pytest.approx(wished.points, abs=1e-12)
        assert stance.frames @ stance.frames.transpose(0, 2, 1) == pytest.approx(ZERO_ROTATIONS, abs=1e-12)
        assert np.linalg.det(stance.rotations) == pytest.approx(np.ones(4))


def test_aiming_a_bone_does_not_twist_it():
    stance = aim_bones(CURVED_CHAIN, ZERO_ROTATIONS, stance_of(CURVED_CHAIN, _turns(3), FIXED_BASE).points, FIXED_BASE)
    twists = Rotation.from_matrix(stance.rotations).as_rotvec()[:, 0]
    assert twists == pytest.approx(np.zeros(4), abs=1e-12)


def test_ball_joint_chain_aimed_at_its_current_joint_positions_keeps_its_rotations():
    rotations = _turns(5)
    stance = aim_bones(CURVED_CHAIN, rotations, stance_of(CURVED_CHAIN, rotations, FIXED_BASE).points, FIXED_BASE)
    assert stance.rotations == pytest.approx(rotations, abs=1e-12)


def test_moving_the_base_moves_the_whole_ball_joint_chain():
    turn = Rotation.from_rotvec([0.3, -0.4, 0.5]).as_matrix()
    carried = stance_of(CURVED_CHAIN, _turns(2), Carrier(np.array([1.0, 2.0, 3.0]), turn))
    alone = stance_of(CURVED_CHAIN, _turns(2), FIXED_BASE)
    assert carried.points == pytest.approx(np.array([1.0, 2.0, 3.0]) + alone.points @ turn.T)
    assert carried.end.rotation == pytest.approx(turn @ alone.end.rotation)


def test_bone_between_coincident_spring_masses_keeps_its_direction():
    points = CURVED_CHAIN.points.copy()
    points[2] = points[1]
    stance = aim_bones(CURVED_CHAIN, ZERO_ROTATIONS, points, FIXED_BASE)
    assert stance.rotations[1] == pytest.approx(np.eye(3))
    assert np.isfinite(stance.points).all()


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_up_vector_stays_perpendicular_to_its_bone(sign: float):
    up, bone = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    assert transport_up(up, bone, sign * bone).tolist() == up.tolist()
    steep = np.array([0.6, 0.0, 0.8])
    assert transport_up(up, bone, steep) == pytest.approx([-0.8, 0.0, 0.6])


def test_swivelled_chain_keeps_ends_and_lengths_and_bends_towards_the_up_vector():
    points, up = CURVED_CHAIN.points, np.array([0.1, 1.0, -0.2])
    turned = swivel_chain(points, up)
    assert turned[[0, -1]] == pytest.approx(points[[0, -1]])
    assert np.linalg.norm(np.diff(turned, axis=0), axis=1) == pytest.approx(CURVED_CHAIN.lengths)
    axis = (points[-1] - points[0]) / np.linalg.norm(points[-1] - points[0])
    bend, wish = (v - (v @ axis) * axis for v in ((turned - turned[0]).mean(axis=0), up))
    assert bend @ wish == pytest.approx(np.linalg.norm(bend) * np.linalg.norm(wish))


@pytest.mark.parametrize(
    ("points", "up"),
    [
        ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [0, 0, 1]),
        ([[0, 0, 0], [1, 0, 0], [0, 0, 0]], [0, 0, 1]),
        ([[0, 0, 0], [1, 1, 0], [2, 0, 0]], [1, 0, 0]),
    ],
)
def test_chain_with_undefined_swivel_direction_is_unchanged(points, up):
    given = np.array(points, dtype=float)
    assert swivel_chain(given, np.array(up, dtype=float)) is given
