from dataclasses import replace
from importlib import resources

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot
from kinesic.expressivity.keyframes import Turn
from kinesic.planning.torso import compute_torso_turn, find_gesture_volume, set_turn

DEFAULT_ROBOT = Robot.load()
SHUFFLED_NAMES = ("vl5_tilt", "vl5_roll", "vl5_torsion")  # another order of one body's hinges
REORDERED_ROBOT = replace(  # robot whose first three torso hinges have other names
    DEFAULT_ROBOT,
    skeleton=replace(
        DEFAULT_ROBOT.skeleton,
        hinges=tuple(
            replace(hinge, name=SHUFFLED_NAMES[k]) if k < 3 else hinge
            for k, hinge in enumerate(DEFAULT_ROBOT.skeleton.hinges)
        ),
    ),
)


def test_rotation_written_to_neck_joints_is_read_back():
    angles = np.array(DEFAULT_ROBOT.skeleton.rest)
    set_turn(DEFAULT_ROBOT, "neck", np.array([0.3, -0.2, 0.1]), angles)
    assert compute_torso_turn(DEFAULT_ROBOT, "neck", angles) == pytest.approx([0.3, -0.2, 0.1])


def test_torso_hinges_are_found_by_name():
    angles = np.array(REORDERED_ROBOT.skeleton.rest)
    set_turn(REORDERED_ROBOT, "torso", np.array([0.3, 0.2, 0.1]), angles)
    assert angles[:3] == pytest.approx([0.2, 0.1, 0.3])


def test_torso_joints_about_one_axis_divide_a_rotation_in_proportion_to_their_ranges():
    skeleton = DEFAULT_ROBOT.skeleton
    hinges = (replace(skeleton.hinges[0], name="vt1_tilt", lower=-0.2, upper=0.2), *skeleton.hinges[1:])
    robot = replace(DEFAULT_ROBOT, skeleton=replace(skeleton, hinges=hinges))
    angles = np.array(robot.skeleton.rest)
    set_turn(robot, "torso", np.array([0.5, 0.3, 0.0]), angles)
    assert angles[0] / angles[1] == pytest.approx(0.2 / skeleton.upper[1])
    assert compute_torso_turn(robot, "torso", angles) == pytest.approx([0.0, 0.3, 0.0])


def test_neck_rotation_is_clamped_to_joint_ranges():
    angles = np.array(DEFAULT_ROBOT.skeleton.rest)
    set_turn(DEFAULT_ROBOT, "neck", np.array([9.0, -9.0, 9.0]), angles)
    assert np.all(angles == DEFAULT_ROBOT.skeleton.clamp(angles))


def test_torso_rotation_of_a_robot_without_torso_chain_moves_no_joint():
    robot, angles = replace(DEFAULT_ROBOT, chains={}), np.array(DEFAULT_ROBOT.skeleton.rest)
    set_turn(robot, "torso", np.array([0.3, 0.2, 0.1]), angles)
    assert np.array_equal(angles, DEFAULT_ROBOT.skeleton.rest)
    assert compute_torso_turn(robot, "torso", angles).tolist() == [0.0, 0.0, 0.0]


UNCHANGED_ROBOT = Robot.load()
POINTING_TARGET = Reach(sealed([0.3, 0.1, 0.8]), pointing=sealed([1.0, 0.0, 0.0]))  # target of a pointing hand


def test_upright_torso_needs_no_transformed_gesture_space():
    assert find_gesture_volume(UNCHANGED_ROBOT, Turn()) is None


def test_gesture_space_turns_about_the_first_torso_joint():
    placed = find_gesture_volume(UNCHANGED_ROBOT, Turn(torsion=np.pi / 6)).placed(POINTING_TARGET)
    cosine, sine = np.cos(np.pi / 6), np.sin(np.pi / 6)
    np.testing.assert_allclose(placed.position, [0.3 * cosine - 0.1 * sine, 0.3 * sine + 0.1 * cosine, 0.8])
    np.testing.assert_allclose(placed.pointing, [cosine, sine, 0.0])


@pytest.mark.parametrize("turn", [Turn(torsion=0.5), Turn(tilt=0.4), Turn(roll=-0.3)])
def test_gesture_space_keeps_its_size_if_the_trunk_is_rigid(turn):
    assert find_gesture_volume(UNCHANGED_ROBOT, turn).scale == pytest.approx(1.0, abs=1e-12)


def test_gesture_volume_keeps_its_size_if_arms_begin_at_the_origin_of_the_torso():
    assert find_gesture_volume(Robot.load("poppy_torso"), Turn(tilt=0.3)).scale == 1.0


def test_gesture_space_of_a_bent_torso_scales_about_its_pivot():
    box = find_gesture_volume(UNCHANGED_ROBOT, Turn(tilt=0.3))
    half = type(box)(box.pivot, box.rotation, 0.5)
    np.testing.assert_allclose(
        half.placed(POINTING_TARGET).position - box.pivot,
        0.5 * (box.placed(POINTING_TARGET).position - box.pivot),
        atol=1e-12,
    )


def test_gesture_space_shrinks_when_a_spine_of_two_joints_bends(tmp_path):
    text = resources.files("kinesic").joinpath("configs/robots/upper22.toml").read_text()
    body = '[[body]]\nname = "vt10"\nparent = "vl5"\npos = [0, 0, 0.15]\nmass = 0.3\ncapsules = []\n\n'
    hinge = (
        '[[hinge]]\nname = "vt10_tilt"\nbody = "vt10"\naxis = [0, 1, 0]\nrange_deg = [-15, 35]\n'
        'servo = "xm540_w270"\nmount = { body = "vl5", at = [0, 0, 0.1] }\n\n'
    )
    trunk = '[[body]]\nname = "vt1"\nparent = "vl5"\npos = [0, 0, 0.29]'
    text = text.replace(trunk, body + trunk.replace("vl5", "vt10").replace("0.29", "0.14"))
    neck = '[[hinge]]\nname = "skullbase_torsion"'
    text = text.replace(neck, hinge + neck).replace('torso = ["vl5"]', 'torso = ["vl5", "vt10"]')
    path = tmp_path / "bending.toml"
    path.write_text(text)
    box = find_gesture_volume(Robot.load(path), Turn(tilt=0.8))
    lower, upper = 0.15, 0.14  # [m] of the spine, bent by half of the tilt where they meet
    length = np.sqrt(lower**2 + upper**2 + 2 * lower * upper * np.cos(0.4))
    assert box.scale == pytest.approx(length / (lower + upper))
    np.testing.assert_allclose(box.rotation[:, 0], [np.cos(0.8), 0.0, -np.sin(0.8)], atol=1e-12)
