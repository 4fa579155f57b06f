from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.hardware.protocol.servo_map import MID_TICKS, ServoMap

UPPER22 = Robot.load().path.read_text(encoding="utf-8")


@pytest.fixture
def changed(tmp_path: Path):
    """Return the default robot with one piece of its file replaced."""

    def load(*changes: tuple[str, str]) -> Robot:
        text = UPPER22
        for old, new in changes:
            assert text.count(old) == 1, old
            text = text.replace(old, new)
        path = tmp_path / "robot.toml"
        path.write_text(text, encoding="utf-8")
        return Robot.load(path)

    return load


def test_servo_map_is_in_joint_order():
    robot = Robot.load()
    wiring = ServoMap.of(robot)
    assert tuple(servos.hinge for servos in wiring.servos) == robot.skeleton.names
    assert wiring.buses[0].baud == 1_000_000
    assert sum(len(servos.ids) for servos in wiring.servos) == 23


def test_servo_map_of_a_tandem_has_two_ids_and_its_belt_reduction():
    servos = {s.hinge: s for s in ServoMap.of(Robot.load()).servos}
    assert servos["vl5_tilt"].ids == (2, 3)
    assert servos["vl5_tilt"].reduction == 2.0


def test_left_and_right_arm_servos_have_equal_ticks_in_the_rest_pose():
    robot = Robot.load()
    ticks = ServoMap.of(robot).scale.ticks(robot.skeleton.rest)
    left, right = robot.joints("l_arm"), robot.joints("r_arm")
    assert (ticks[list(left)] == ticks[list(right)]).all()


def test_servo_zero_and_direction_come_from_the_robot_file(changed):
    robot = changed(
        ("[bus.ids]", 'zero_ticks = { l_elbow_flexion = 1000 }\ninverted = ["skullbase_tilt"]\n[bus.ids]'),
    )
    ticks = ServoMap.of(robot).scale.ticks(np.full(22, 0.1))
    assert ticks[robot.skeleton.joint("l_elbow_flexion")] == 1065
    assert ticks[robot.skeleton.joint("skullbase_tilt")] == 1983
    assert ticks[robot.skeleton.joint("skullbase_roll")] == 2113


def test_order_of_hinges_in_the_robot_file_does_not_matter(changed):
    robot = changed(("vl5_torsion = 1\n", ""), ("r_wrist_pivot = 28", "r_wrist_pivot = 28\nvl5_torsion = 1"))
    assert ServoMap.of(robot) == ServoMap.of(Robot.load())


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("l_elbow_flexion = 15", "l_elbo_flexion = 15", r"no l_elbo_flexion; did you mean l_elbow_flexion\?"),
        ("l_elbow_flexion = 15\n", "", "no servo id for l_elbow_flexion"),
        ("l_elbow_flexion = 15", "l_elbow_flexion = 14", "id 14 is used by l_shoulder_twisting and l_elbow_flexion"),
        ("vl5_tilt = [2, 3]", "vl5_tilt = [2, 2]", "id 2 is used by vl5_tilt and vl5_tilt"),
        ("l_elbow_flexion = 15", "l_elbow_flexion = 253", r"l_elbow_flexion: id is 253, outside 0\.\.252"),
        ("l_elbow_flexion = 15", "l_elbow_flexion = -1", r"l_elbow_flexion: id is -1, outside 0\.\.252"),
        ("vl5_tilt = [2, 3]", "vl5_tilt = 2", "vl5_tilt: 1 ids, but the hinge has count = 2"),
        ("vl5_roll = 4", "vl5_roll = [4, 8]", "vl5_roll: 2 ids, but the hinge has count = 1"),
        ("baud = 1_000_000", "baud = 1_000_001", "baud is 1000001, must be one of 9600, 19200, 57600"),
        ("baud = 1_000_000", "baudrate = 1_000_000", r"unknown field `baudrate`.*did you mean baud\?"),
        ("baud = 1_000_000", "baud = 1_000_000\nzero_ticks = { elbow = 2048 }", "zero_ticks of bus body: no elbow"),
        ("baud = 1_000_000", 'baud = 1_000_000\ninverted = ["elbow"]', "inverted of bus body: no elbow"),
        (
            "baud = 1_000_000",
            "baud = 1_000_000\nzero_ticks = { l_elbow_flexion = 4000 }",
            r"l_elbow_flexion: 0\.\.135 deg is 4000\.\.5536 ticks, outside 0\.\.4095; move zero_ticks",
        ),
        ("l_elbow_flexion = 15", 'l_elbow_flexion = "15"', r"Expected `int \| array`, got `str`"),
    ],
)
def test_error_for_an_invalid_bus_table_names_the_wrong_entry(changed, old: str, new: str, message: str):
    robot = changed((old, new))
    with pytest.raises(ConfigError, match=message):
        ServoMap.of(robot)


def test_hinge_on_two_buses_is_refused(changed):
    second = '\n[[bus]]\nname = "arm"\nbaud = 57600\nids = { l_elbow_flexion = 1 }\n'
    with pytest.raises(ConfigError, match="l_elbow_flexion is on the buses body and arm"):
        ServoMap.of(changed(("r_wrist_pivot = 28\n", "r_wrist_pivot = 28\n" + second)))


def test_servos_on_two_buses_may_have_the_same_id(changed):
    second = '\n[[bus]]\nname = "arm"\nbaud = 57600\nids = { l_elbow_flexion = 1 }\n'
    robot = changed(("l_elbow_flexion = 15\n", ""), ("r_wrist_pivot = 28\n", "r_wrist_pivot = 28\n" + second))
    servos = ServoMap.of(robot).servos[robot.skeleton.joint("l_elbow_flexion")]
    assert (servos.bus, servos.ids) == ("arm", (1,))


def test_duplicate_bus_name_is_refused(changed):
    robot = changed(("r_wrist_pivot = 28\n", 'r_wrist_pivot = 28\n[[bus]]\nname = "body"\nbaud = 57600\nids = {}\n'))
    with pytest.raises(ConfigError, match="bus body is described twice"):
        ServoMap.of(robot)


def test_robot_without_buses_has_an_empty_servo_map(tmp_path: Path):
    path = tmp_path / "robot.toml"
    path.write_text(UPPER22[: UPPER22.index("[[bus]]")], encoding="utf-8")
    assert ServoMap.of(Robot.load(path)) == ServoMap((), ())


def test_calibration_file_overrides_zero_ticks_and_inverted_directions(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(Robot.load().path.read_text(encoding="utf-8"), encoding="utf-8")
    text = 'robot = "upper22"\n[zero_ticks]\nvl5_roll = 2100\n[inverted]\nvl5_roll = true\n'
    path.with_name("mine.calibration.toml").write_text(text, encoding="utf-8")
    rows = {row.hinge: row for row in ServoMap.of(Robot.load(path)).servos}
    assert (rows["vl5_roll"].zero_ticks, rows["vl5_roll"].inverted) == (2100, True)
    assert (rows["vl5_tilt"].zero_ticks, rows["vl5_tilt"].inverted) == (MID_TICKS, False)
    plain = {row.hinge: row for row in ServoMap.of(Robot.load(path, calibrated=False)).servos}
    assert plain["vl5_roll"].zero_ticks == MID_TICKS


@pytest.mark.parametrize("name", ["", "../body", "a/b", ".", "..", "a b", "\\u001b[31m", "x" * 65])
def test_bus_name_with_invalid_characters_is_refused(changed, name: str):
    robot = changed(
        ("r_wrist_pivot = 28\n", f'r_wrist_pivot = 28\n[[bus]]\nname = "{name}"\nbaud = 57600\nids = {{}}\n')
    )
    with pytest.raises(ConfigError, match="must consist of letters, digits, - and _"):
        ServoMap.of(robot)


def test_baud_rate_that_the_servo_family_lacks_is_refused(tmp_path):
    text = Robot.load().path.read_text(encoding="utf-8").replace("baud = 1_000_000", "baud = 500_000")
    path = tmp_path / "mine.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError, match=r"bus body: baud is 500000, but xm540_w150 of vl5_torsion has 9600, 57600"):
        ServoMap.of(Robot.load(path))
