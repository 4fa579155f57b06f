import tomllib

import msgspec
import pytest

from kinesic.body.config import read_toml
from kinesic.body.robot import Robot
from kinesic.body.robot_file import robot_from_tables
from kinesic.body.robot_schema import RobotFile, ServoTable, robot_text


@pytest.fixture(scope="module")
def file():
    """The default robot's left and middle, with the right side named anew so that no mirror is needed."""
    own = read_toml(Robot.load().path, RobotFile)
    servo = ServoTable(0, 48.0, 10.0, 2.0, 30.0, 1.0, 0.0, (0.01, 0.01, 0.01), 800.0, 0.0, 128.0, 0.1, 0.2, 0.3)
    hinges = [msgspec.structs.replace(own.hinge[0], servo="mine", at=(0.01, 0.0, -0.02)), *own.hinge[1:]]
    return msgspec.structs.replace(own, hinge=hinges, servos={"mine": servo}, bus=[])


def test_what_is_written_is_read_back(file, tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(robot_text(file, heading=["one", ""], remarks={}), encoding="utf-8")
    again = read_toml(path, RobotFile)
    plain = msgspec.structs.replace(file, robot=msgspec.structs.replace(file.robot, mirror=None), supply=None)
    assert again == plain


def test_heading_and_remarks_are_comments(file):
    text = robot_text(file, heading=["look here"], remarks={"vl5_torsion": "was waist", "mine": "guessed"})
    assert text.startswith("# look here\n")
    assert 'name = "vl5_torsion"  # was waist' in text
    assert "[servos.mine]  # guessed" in text
    assert tomllib.loads(text)["servos"]["mine"]["stall_nm"] == 10.0


def test_a_robots_own_servos_win(file, tmp_path):
    description = robot_from_tables(file, tmp_path / "robot.toml")
    assert description.mounts[0].drive.servo.stall_nm == 10.0
    assert description.skeleton.hinges[0].at.tolist() == [0.01, 0.0, -0.02]
