"""Tests of joint names, signs and zeros of an imported robot's file."""

from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot

# TOML tables that name joints of captured motion
SOURCE_TABLES = """
[[hinge]]
name = "l_elbow_flexion"
source = { joint = "left_elbow", sign = -1, zero_deg = 90 }
[[coupling]]
name = "l_tip"
body = "l_wrist"
axis = [0, 0, 1]
range_deg = [-20, 140]
driver = "l_elbow_flexion"
ratio = 0.5
offset_deg = 10
source = { joint = "left_tip", sign = -1, zero_deg = 30 }
[[coupling]]
name = "l_end"
body = "l_wrist"
axis = [0, 0, 1]
range_deg = [-20, 140]
driver = "l_elbow_flexion"
"""


def load(folder: Path, lines: str = SOURCE_TABLES) -> Robot:
    """Return the default robot with additional TOML tables."""
    path = folder / "robot.toml"
    path.write_text(f'[robot]\nname = "mine"\nextends = "upper22"\n{lines}', encoding="utf-8")
    return Robot.load(path)


def test_joint_angles_have_the_sign_and_zero_of_the_imported_file(tmp_path):
    robot = load(tmp_path)
    joints, elbow = robot.source_joints, robot.skeleton.joint("l_elbow_flexion")
    angles = np.random.default_rng(0).uniform(-1.0, 1.0, (5, 22))
    expected = angles.copy()
    expected[:, elbow] = np.pi / 2 - angles[:, elbow]
    np.testing.assert_allclose(joints.joint_angles(angles)[:, :22], expected, atol=1e-12)
    assert joints.names[elbow] == "left_elbow"
    assert joints.names[:elbow] == robot.skeleton.names[:elbow]


def test_coupled_joint_of_the_imported_file_follows_its_driver(tmp_path):
    robot = load(tmp_path)
    joints, elbow = robot.source_joints, robot.skeleton.joint("l_elbow_flexion")
    angles = np.zeros((2, 22))
    angles[1, elbow] = 1.0
    assert joints.names[22:] == ("left_tip",)
    tip = np.radians(30.0) - (np.radians(10.0) + 0.5 * angles[:, elbow])
    np.testing.assert_allclose(joints.joint_angles(angles)[:, 22], tip, atol=1e-12)
    np.testing.assert_allclose(joints.joint_rates(angles)[1, [elbow, 22]], [-1.0, -0.5], atol=1e-12)


def test_column_of_a_hinge_is_found_by_the_joint_name_of_the_imported_file_before_its_own_name(tmp_path):
    joints = load(tmp_path).source_joints
    elbow = joints.hinges.index("l_elbow_flexion")
    names = ("l_elbow_flexion", "left_elbow", "left_tip", "skullbase_tilt")
    assert joints.find_hinges(names) == {elbow: 1, joints.hinges.index("skullbase_tilt"): 3}
    assert joints.find_hinges(names[:1]) == {elbow: 0}
    values = np.array([0.0, 0.5])
    np.testing.assert_allclose(joints.hinge_angles(elbow, "left_elbow", values), np.pi / 2 - values)
    np.testing.assert_array_equal(joints.hinge_angles(elbow, "l_elbow_flexion", values), values)


def test_robot_without_imported_file_has_the_names_and_angles_of_its_hinges():
    robot = Robot.load("upper22")
    angles = np.random.default_rng(0).uniform(-1.0, 1.0, (3, 22))
    assert robot.source_joints.names == robot.skeleton.names
    np.testing.assert_array_equal(robot.source_joints.joint_angles(angles), angles)


@pytest.mark.parametrize("joint", ["r_elbow_flexion", "left_tip"])
def test_two_hinges_with_the_same_joint_of_the_imported_file_are_refused(tmp_path, joint):
    with pytest.raises(ConfigError, match=f"another hinge has the joint {joint} of the imported file"):
        load(tmp_path, SOURCE_TABLES.replace("left_elbow", joint))
