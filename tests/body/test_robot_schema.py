import tomllib

import msgspec
import pytest

from kinesic.body.config import ConfigError, read_toml
from kinesic.body.robot import Robot
from kinesic.body.robot_file import robot_from_tables
from kinesic.body.robot_schema import (
    CouplingTable,
    HingeTable,
    LimitsTable,
    RobotFile,
    ServoTable,
    changes_text,
    robot_text,
)


@pytest.fixture(scope="module")
def file():
    """Return the default robot file with a servo model, without buses."""
    own = read_toml(Robot.load().path, RobotFile)
    servo = ServoTable(0, 48.0, 10.0, 2.0, 30.0, 1.0, 0.0, (0.01, 0.01, 0.01), 800.0, 0.0, 128.0, 0.1, 0.2, 0.3)
    hinges = [msgspec.structs.replace(own.hinge[0], servo="mine", at=(0.01, 0.0, -0.02)), *own.hinge[1:]]
    return msgspec.structs.replace(own, hinge=hinges, servos={"mine": servo}, bus=[])


def test_written_robot_file_is_read_back(file, tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(robot_text(file, heading=["one", ""], remarks={}), encoding="utf-8")
    again = read_toml(path, RobotFile)
    plain = msgspec.structs.replace(file, robot=msgspec.structs.replace(file.robot, mirror=None), supply=None)
    assert again == plain


def test_heading_and_remarks_of_a_written_robot_are_toml_comments(file):
    text = robot_text(file, heading=["look here"], remarks={"vl5_torsion": "was waist", "mine": "guessed"})
    assert text.startswith("# look here\n")
    assert 'name = "vl5_torsion"  # was waist' in text
    assert "[servos.mine]  # guessed" in text
    assert tomllib.loads(text)["servos"]["mine"]["stall_nm"] == 10.0


def test_robot_file_can_define_its_own_servo_model(file, tmp_path):
    description = robot_from_tables(file, tmp_path / "robot.toml")
    assert description.mounts[0].drive.servo.stall_nm == 10.0
    assert description.skeleton.hinges[0].at.tolist() == [0.01, 0.0, -0.02]


def with_drives(file, drives):
    """Return the file with the drive fields of its first hinges replaced."""
    hinges = [msgspec.structs.replace(hinge, **drive) for hinge, drive in zip(file.hinge, drives, strict=False)]
    return msgspec.structs.replace(file, hinge=[*hinges, *file.hinge[len(hinges) :]])


LIMITS_DRIVE = {"servo": None, "mount": None, "limits": LimitsTable(90.0, 900.0, 5.0), "count": 1, "reduction": 1.0}


def test_robot_with_servos_on_only_some_hinges_is_refused(file, tmp_path):
    mixed = with_drives(file, [LIMITS_DRIVE])
    first, second = (hinge.name for hinge in file.hinge[:2])
    with pytest.raises(ConfigError, match=f"{second} has a servo and {first} has limits: give all hinges servos"):
        robot_from_tables(mixed, tmp_path / "robot.toml")


def test_robot_without_servos_may_not_have_a_bus(file, tmp_path):
    limited = with_drives(file, [LIMITS_DRIVE] * len(file.hinge))
    assert len(robot_from_tables(limited, tmp_path / "robot.toml").mounts) > 0
    with pytest.raises(ConfigError, match=r"\[\[bus\]\], but no hinge has a servo"):
        robot_from_tables(msgspec.structs.replace(limited, bus=[{}]), tmp_path / "robot.toml")


@pytest.mark.parametrize(
    ("drive", "said"),
    [
        ({"servo": None}, "give servo and mount, or limits"),
        ({"mount": None}, "give servo and mount, or limits"),
        (LIMITS_DRIVE | {"count": 2}, "has limits and count"),
        (LIMITS_DRIVE | {"reduction": 2.0}, "has limits and reduction"),
        ({"limits": LimitsTable(90.0, 900.0, 5.0), "count": 1, "reduction": 1.0}, "has limits and servo"),
        (LIMITS_DRIVE | {"limits": LimitsTable(90.0, 0.0, 5.0)}, "limits.acceleration_deg is 0, must be above 0"),
    ],
)
def test_hinge_needs_either_servo_and_mount_or_limits(file, tmp_path, drive, said):
    with pytest.raises(ConfigError, match=said):
        robot_from_tables(with_drives(file, [drive]), tmp_path / "robot.toml")


def test_hinge_and_coupling_tables_default_to_unit_reduction_and_ratio_and_zero_offsets():
    hinge = HingeTable("h", "b", (1.0, 0.0, 0.0), (0.0, 90.0))
    assert (hinge.count, hinge.reduction, hinge.at) == (1, 1.0, (0.0, 0.0, 0.0))
    coupling = CouplingTable("c", "b", (1.0, 0.0, 0.0), (0.0, 90.0), "h")
    assert (coupling.ratio, coupling.offset_deg) == (1.0, 0.0)


def test_robot_extension_file_contains_servo_count_and_gear_reduction(file):
    text = changes_text([], file.hinge[:1], {}, robot={"name": "own", "extends": "upper22"}, heading=["mine"])
    read = tomllib.loads(text)
    assert text.startswith("# mine\n")
    assert read["robot"] == {"name": "own", "extends": "upper22"}
    assert (read["hinge"][0]["count"], read["hinge"][0]["reduction"]) == (file.hinge[0].count, file.hinge[0].reduction)
    assert "sites" not in read
