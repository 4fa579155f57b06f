from pathlib import Path

import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.body.config import ConfigError
from kinesic.body.robot import SIDES, Robot, Side


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load()


def test_robot_is_loaded_by_name_or_file(robot: Robot, tmp_path: Path):
    copy = tmp_path / "mine.toml"
    copy.write_text(robot.path.read_text(encoding="utf-8"), encoding="utf-8")
    assert Robot.load("upper22").skeleton.names == Robot.load(copy).skeleton.names == robot.skeleton.names


def test_built_in_robot_is_loaded_once_until_it_has_a_calibration(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    robot = Robot.load("upper22")
    assert Robot.load("upper22") is Robot.load("upper22", calibrated=False) is robot
    assert Robot.load("upper36") is not robot
    (tmp_path / "kinesic").mkdir()
    hinge = robot.skeleton.names[0]
    file = tmp_path / "kinesic" / "upper22.calibration.toml"
    file.write_text(f'robot = "upper22"\n[zero_ticks]\n{hinge} = 2100\n')
    assert Robot.load("upper22").calibration.zero_ticks == {hinge: 2100}
    assert Robot.load("upper22", calibrated=False) is robot


def test_unknown_robot_error_suggests_a_name():
    with pytest.raises(ConfigError, match=r"no robot uper22; did you mean upper22\? \(or give a \.toml file\)"):
        Robot.load("uper22")


def test_error_names_a_missing_robot_file():
    with pytest.raises(ConfigError, match=r"nowhere/nobody\.toml: no such file"):
        Robot.load("nowhere/nobody.toml")


def test_velocity_limits_of_five_upper22_joints_have_their_expected_values(robot: Robot):
    limits = dict(zip(robot.skeleton.names, robot.velocity_limits, strict=True))
    expected = {"vl5_torsion": 4.44, "vl5_tilt": 1.26, "vl5_roll": 1.01, "l_elbow_flexion": 6.45, "r_wrist_pivot": 5.95}
    assert {name: round(limits[name], 2) for name in expected} == expected


def test_torso_neck_and_arm_chains_contain_each_joint_once(robot: Robot):
    joints = [robot.joints(chain) for chain in ("torso", "neck", "l_arm", "r_arm")]
    assert [len(indices) for indices in joints] == [3, 3, 8, 8]
    assert sorted(k for indices in joints for k in indices) == list(range(22))
    assert robot.joints("tail") == ()


def test_gesture_origin_is_at_elbow_height_in_the_midline(robot: Robot):
    np.testing.assert_allclose(robot.gesture_origin, (0, 0, 0.705), atol=1e-12)


def test_collision_check_skips_adjacent_and_excluded_pairs(robot: Robot):
    pairs = {frozenset(pair) for pair in robot.counted_pairs}
    segments = robot.skeleton.segments
    assert len(pairs) == len(robot.counted_pairs)
    assert not pairs & {exclusion.pair for exclusion in robot.exclusions}
    assert not pairs & {frozenset((s.name, s.parent)) for s in segments}
    assert frozenset(("l_wrist", "r_wrist")) in pairs
    assert frozenset(("skullbase", "l_wrist")) in pairs


def test_collision_exclusions_are_mirrored_and_have_a_reason(robot: Robot):
    pairs = [exclusion.pair for exclusion in robot.exclusions]
    assert len(set(pairs)) == len(pairs)
    assert frozenset(("l_sternoclavicular", "r_shoulder")) in pairs
    assert frozenset(("r_sternoclavicular", "l_shoulder")) in pairs
    assert all(exclusion.why for exclusion in robot.exclusions)


def test_gaze_targets_of_the_robot_file_are_in_front_of_the_robot(robot: Robot):
    assert {"audience", "user", "camera", "left", "right"} <= set(robot.targets)
    assert all(target[0] > 0 for target in robot.targets.values())
    assert robot.targets["left"][1] > 0 > robot.targets["right"][1]


def test_robot_arrays_are_read_only(robot: Robot):
    for array in (robot.velocity_limits, robot.gesture_origin, robot.sites["eyes"].facing, *robot.targets.values()):
        assert not array.flags.writeable


@pytest.mark.parametrize("side", SIDES)
def test_arm_of_a_robot_is_returned_by_side(robot: Robot, side: Side):
    arm, names = robot.arm(side), [segment.name for segment in robot.skeleton.segments]
    assert arm.segments == robot.chains[f"{side}_arm"]
    assert arm.joints == robot.joints(f"{side}_arm")
    parts = [names[k] for k in (arm.shoulder, arm.elbow, arm.wrist)]
    assert parts == [f"{side}_shoulder", f"{side}_elbow", f"{side}_wrist"]
    assert arm.palm is robot.sites[f"{side}_palm"]


def test_drive_properties_are_cached_read_only_arrays(robot: Robot):
    drives = robot.drives
    assert drives == tuple(mount.drive for mount in robot.mounts)
    for name in ("stall", "no_load", "gain", "rate_gain", "armature", "frictionloss", "damping", "tick"):
        figures: Floats = getattr(drives, name)
        assert figures.tolist() == [getattr(drive, name) for drive in drives]
        assert figures is getattr(drives, name)
        assert not figures.flags.writeable
    assert drives.idle_current.tolist() == [drive.count * drive.servo.idle_a for drive in drives]
