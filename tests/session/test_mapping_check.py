"""Imported robots with a doubtful joint mapping."""

from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.session.mapping_check import describe_mapping_doubt
from kinesic.session.setup import set_up

EXTENSION = '[robot]\nname = "own"\nextends = "upper22"\n[robot.imported]\nfrom = "x.urdf"\nconfidence = {}\n'


def robot_with(confidence: float, folder: Path) -> Robot:
    path = folder / "own.toml"
    path.write_text(EXTENSION.format(confidence), encoding="utf-8")
    return Robot.load(path)


def test_imported_robot_with_a_doubtful_joint_mapping_is_refused_unless_the_option_mapping_is_any(tmp_path: Path):
    robot = robot_with(0.59, tmp_path)
    with pytest.raises(ConfigError, match=r"confidence 0\.59 of its joint mapping is below 0\.6.*--mapping any"):
        set_up(robot)
    assert set_up(robot, mapping="any").robot.name == "own"
    assert describe_mapping_doubt(robot) is not None


@pytest.mark.parametrize("confidence", [0.6, 1.0])
def test_imported_robot_with_a_confident_joint_mapping_performs(confidence, tmp_path: Path):
    robot = robot_with(confidence, tmp_path)
    assert describe_mapping_doubt(robot) is None
    assert set_up(robot).robot.mapping_confidence == confidence


def test_robot_that_was_not_imported_needs_no_mapping_confidence():
    assert describe_mapping_doubt(Robot.load()) is None
