"""Conversion of pypot's configuration files: zeros, directions and faults."""

import json
from pathlib import Path

import pytest

from kinesic.body.calibration import NO_CALIBRATION, Calibration
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.hardware.protocol.servo_map import ServoMap
from kinesic.hardware.tools.pypot_configuration import PUBLISHED_MOTORS, convert_pypot, read_pypot_motors

POPPY = Robot.load("poppy_torso", calibrated=False)


def pypot_file(folder: Path, which: int = 0, **changes: object) -> Path:
    """Write the published configuration, in which one motor differs."""
    motors = {
        f"m{number}": {
            "id": number,
            "type": "MX-28",
            "orientation": "direct" if motor.sign > 0 else "indirect",
            "offset": motor.offset,
            "angle_limit": [-90, 90],
        }
        for number, motor in PUBLISHED_MOTORS["poppy_torso"].items()
    }
    motors.get(f"m{which}", {}).update(changes)
    path = folder / "poppy.json"
    path.write_text(json.dumps({"controllers": {}, "motorgroups": {}, "motors": motors}))
    return path


def motor_angle(hinge_angle: float, calibration: Calibration, hinge: str) -> float:
    """Return the position of the servo [deg] from its middle."""
    sign = -1.0 if calibration.inverted[hinge] else 1.0
    return sign * hinge_angle + (calibration.zero_ticks[hinge] - 2048) * 360 / 4096


def test_published_configuration_gives_the_zeros_and_directions_of_the_robot_file(tmp_path: Path):
    calibration = convert_pypot(pypot_file(tmp_path), POPPY, NO_CALIBRATION)
    for servo in ServoMap.of(POPPY).servos:
        assert calibration.zero_ticks[servo.hinge] == servo.zero_ticks
        assert calibration.inverted[servo.hinge] == servo.inverted


@pytest.mark.parametrize(("id", "hinge", "sign"), [(41, "l_shoulder_flexion", 1), (51, "r_shoulder_flexion", -1)])
def test_offset_moves_the_zero_in_the_direction_of_the_motor(tmp_path: Path, id: int, hinge: str, sign: int):
    before = convert_pypot(pypot_file(tmp_path), POPPY, NO_CALIBRATION)
    after = convert_pypot(pypot_file(tmp_path, id, offset=100.0), POPPY, NO_CALIBRATION)
    assert motor_angle(0.0, after, hinge) - motor_angle(0.0, before, hinge) == pytest.approx(10.0 * sign, abs=0.05)
    assert after.inverted == before.inverted


@pytest.mark.parametrize("id", sorted(PUBLISHED_MOTORS["poppy_torso"]))
def test_motor_with_the_other_orientation_turns_to_the_mirrored_position(tmp_path: Path, id: int):
    hinge = next(servo.hinge for servo in ServoMap.of(POPPY).servos if servo.ids == (id,))
    before = convert_pypot(pypot_file(tmp_path), POPPY, NO_CALIBRATION)
    other = "indirect" if PUBLISHED_MOTORS["poppy_torso"][id].sign > 0 else "direct"
    after = convert_pypot(pypot_file(tmp_path, id, orientation=other), POPPY, NO_CALIBRATION)
    for angle in (0.0, 30.0):
        assert motor_angle(angle, after, hinge) == pytest.approx(-motor_angle(angle, before, hinge), abs=0.05)


def test_earlier_ranges_are_kept(tmp_path: Path):
    before = Calibration("poppy_torso", {"vl5_torsion": 7}, {}, {"vl5_torsion": (-10.0, 10.0)})
    after = convert_pypot(pypot_file(tmp_path), POPPY, before)
    assert after.range_deg == {"vl5_torsion": (-10.0, 10.0)}
    assert after.zero_ticks["vl5_torsion"] == 2048


def test_missing_motor_and_other_robots_are_refused(tmp_path: Path):
    with pytest.raises(ConfigError, match="no motor with id 44, which l_elbow_flexion has"):
        convert_pypot(pypot_file(tmp_path, 44, id=9), POPPY, NO_CALIBRATION)
    with pytest.raises(ConfigError, match="op3 is no robot of pypot that kinesic knows; known: poppy_torso"):
        convert_pypot(pypot_file(tmp_path), Robot.load("op3", calibrated=False), NO_CALIBRATION)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"{}", "not a configuration of pypot: Object missing required field `motors`"),
        (b"\xff", "not a configuration of pypot"),
        (b"[" * 100_000, "not a configuration of pypot"),
        (b'{"motors": {"a": {"id": 1, "orientation": "left", "offset": 0}}}', "Invalid enum value 'left'"),
        (b'{"motors": {"a": {"id": 1, "orientation": "direct", "offset": 1e9}}}', "must be -180 to 180"),
        (b" " * 1_000_001, "has more than 1000000 bytes"),
    ],
)
def test_file_that_is_no_configuration_is_refused(tmp_path: Path, content: bytes, reason: str):
    path = tmp_path / "bad.json"
    path.write_bytes(content)
    with pytest.raises(ConfigError, match=reason):
        read_pypot_motors(path)
    with pytest.raises(ConfigError, match="No such file"):
        read_pypot_motors(tmp_path / "missing.json")
