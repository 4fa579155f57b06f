import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.face.assets.mesh import load_head
from kinesic.face.render.camera import HEAD_CENTRE, Camera, compute_head_rotation
from kinesic.face.render.head_pose import NECK_BOTTOM, NECK_TOP, compute_head_turns, keep_shoulders_still


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("upper22")


def test_rotation_of_the_drawn_head_matches_the_skeleton(robot: Robot):
    chance = np.random.default_rng(0)
    skeleton = robot.skeleton
    angles = chance.uniform(skeleton.lower, skeleton.upper, (40, len(skeleton.hinges))) * 0.6
    head = skeleton.segment(robot.chains["neck"][-1])
    expected = skeleton.frames(angles).rotations[:, head]
    for turn, stands in zip(compute_head_turns(robot, angles).tolist(), expected, strict=True):
        np.testing.assert_allclose(compute_head_rotation(*turn), stands, atol=1e-9)


def test_drawn_head_is_upright_at_rest(robot: Robot):
    np.testing.assert_allclose(compute_head_turns(robot, robot.skeleton.rest), 0.0, atol=1e-9)


def test_head_turned_to_one_side_is_drawn_like_a_camera_turned_to_the_other_side():
    np.testing.assert_allclose(Camera(turn=(0.4, 0.0, 0.0)).view(), Camera(yaw_deg=-np.degrees(0.4)).view(), atol=1e-12)


def test_raised_head_brings_the_chin_nearer_to_the_camera():
    chin, crown = (0.03, 0.0, -0.1, 1.0), (0.0, 0.0, 0.12, 1.0)
    up, ahead = Camera(turn=(0.0, 0.4, 0.0)).view(), Camera().view()
    assert (up @ chin)[2] > (ahead @ chin)[2]  # nearer
    assert (up @ crown)[2] < (ahead @ crown)[2]
    over = Camera(turn=(0.0, 0.0, 0.4)).view() @ crown
    assert over[0] < -0.01  # the head's right is to the left of the picture


def test_shoulders_stay_and_neck_bends_while_the_head_turns():
    mesh = load_head()
    rest, turn = mesh.positions, (0.5, -0.3, 0.1)
    seen = keep_shoulders_still(rest, rest, turn)
    head, shoulders = rest[:, 2] > NECK_TOP, rest[:, 2] < NECK_BOTTOM
    np.testing.assert_array_equal(seen[head], rest[head])
    stands = (seen - HEAD_CENTRE) @ compute_head_rotation(*turn).T + HEAD_CENTRE
    np.testing.assert_allclose(stands[shoulders], rest[shoulders], atol=1e-12)
    whole = (rest - HEAD_CENTRE) @ compute_head_rotation(*turn).T + HEAD_CENTRE
    neck = ~(head | shoulders)
    reach = np.linalg.norm(whole - rest, axis=1)[neck]
    assert np.all(np.linalg.norm(stands - rest, axis=1)[neck] <= reach + 1e-9)
    np.testing.assert_array_equal(keep_shoulders_still(rest, rest, (0.0, 0.0, 0.0)), rest)
