from math import radians
from pathlib import Path

import pytest

from kinesic.body.calibration import NO_CALIBRATION, calibration_path, read_calibration
from kinesic.body.config import CONFIGS, ConfigError
from kinesic.body.robot import Robot


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    """Write a copy of the default robot file and return its path."""
    path = tmp_path / "mine.toml"
    path.write_text(Robot.load().path.read_text(encoding="utf-8"), encoding="utf-8")
    return path


def calibrated(robot: Path, text: str) -> None:
    calibration_path(robot).write_text(text, encoding="utf-8")


def test_calibration_is_next_to_a_user_robot_file_or_in_the_user_folder_for_a_built_in_robot(
    mine: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    assert calibration_path(mine) == tmp_path / "mine.calibration.toml"
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    packaged = calibration_path(CONFIGS / "robots" / "upper22.toml")
    assert packaged == tmp_path / "config" / "kinesic" / "upper22.calibration.toml"


def test_robot_without_a_calibration_file_has_no_calibration(mine: Path):
    assert read_calibration(mine, "upper22") is NO_CALIBRATION
    assert Robot.load(mine).calibration is NO_CALIBRATION


def test_calibration_narrows_only_the_joint_range_that_it_contains(mine: Path):
    calibrated(mine, 'robot = "upper22"\n[range_deg]\nl_elbow_flexion = [0, 101.5]\n')
    robot, plain = Robot.load(mine), Robot.load(mine, calibrated=False)
    elbow = robot.skeleton.joint("l_elbow_flexion")
    assert robot.skeleton.upper[elbow] == pytest.approx(radians(101.5))
    assert plain.skeleton.upper[elbow] == pytest.approx(radians(135))
    assert (robot.skeleton.upper != plain.skeleton.upper).sum() == 1
    assert (robot.skeleton.lower == plain.skeleton.lower).all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('robot = "other"', "mine.calibration.toml: calibrates other, not upper22; remove or rename it"),
        ("", "calibrates no robot"),
        ('robot = "upper22"\n[zero_ticks]\nl_elbow = 5', "no hinge l_elbow; did you mean"),
        ('robot = "upper22"\n[range_deg]\nl_elbow_flexion = [-5, 100]', "outside [0.0, 135.0]"),
        ('robot = "upper22"\n[range_deg]\nl_elbow_flexion = [50, 50]', "range_deg of l_elbow_flexion is [50.0, 50.0]"),
        ('robot = "upper22"\n[range_deg]\nl_elbow_flexion = [30, 100]', "[rest] l_elbow_flexion is 18.0 deg, outside"),
        ('robot = "upper22"\nzero = 5', "unknown field `zero`"),
    ],
)
def test_invalid_calibration_file_is_refused(mine: Path, text: str, message: str):
    calibrated(mine, text)
    with pytest.raises(ConfigError) as refused:
        Robot.load(mine)
    assert message in str(refused.value)
