import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.face.assets.mesh import load_head
from kinesic.face.render.camera import PIVOT, Camera, head_rotation
from kinesic.face.render.head_pose import HEAD_ENDS, SHOULDERS_BEGIN, steady_shoulders, turns


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("upper22")


def test_a_head_stands_as_the_skeleton_has_it(robot: Robot):
    chance = np.random.default_rng(0)
    skeleton = robot.skeleton
    angles = chance.uniform(skeleton.lower, skeleton.upper, (40, len(skeleton.hinges))) * 0.6
    head = skeleton.segment(robot.chains["neck"][-1])
    wanted = skeleton.frames(angles).rotations[:, head]
    for turn, stands in zip(turns(robot, angles).tolist(), wanted, strict=True):
        np.testing.assert_allclose(head_rotation(*turn), stands, atol=1e-9)


def test_at_rest_it_is_upright(robot: Robot):
    np.testing.assert_allclose(turns(robot, robot.skeleton.rest), 0.0, atol=1e-9)


def test_a_head_that_turns_is_seen_as_by_a_camera_that_goes_the_other_way():
    np.testing.assert_allclose(Camera(turn=(0.4, 0.0, 0.0)).view(), Camera(yaw_deg=-np.degrees(0.4)).view(), atol=1e-12)


def test_a_head_that_is_raised_shows_its_chin():
    chin, crown = (0.03, 0.0, -0.1, 1.0), (0.0, 0.0, 0.12, 1.0)
    up, ahead = Camera(turn=(0.0, 0.4, 0.0)).view(), Camera().view()
    assert (up @ chin)[2] > (ahead @ chin)[2]  # nearer
    assert (up @ crown)[2] < (ahead @ crown)[2]
    over = Camera(turn=(0.0, 0.0, 0.4)).view() @ crown
    assert over[0] < -0.01  # the head's right is to the left of the picture


def test_shoulders_stay_while_the_head_turns_and_the_neck_is_bent_between():
    mesh = load_head()
    rest, turn = mesh.positions, (0.5, -0.3, 0.1)
    seen = steady_shoulders(rest, rest, turn)
    head, shoulders = rest[:, 2] > HEAD_ENDS, rest[:, 2] < SHOULDERS_BEGIN
    np.testing.assert_array_equal(seen[head], rest[head])
    stands = (seen - PIVOT) @ head_rotation(*turn).T + PIVOT
    np.testing.assert_allclose(stands[shoulders], rest[shoulders], atol=1e-12)
    whole = (rest - PIVOT) @ head_rotation(*turn).T + PIVOT
    neck = ~(head | shoulders)
    reach = np.linalg.norm(whole - rest, axis=1)[neck]
    assert np.all(np.linalg.norm(stands - rest, axis=1)[neck] <= reach + 1e-9)
    np.testing.assert_array_equal(steady_shoulders(rest, rest, (0.0, 0.0, 0.0)), rest)
