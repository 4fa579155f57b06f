"""Conversion of lerobot's calibration files: zeros, directions, ranges and faults."""

import json
from pathlib import Path

import pytest

from kinesic.body.calibration import NO_CALIBRATION, Calibration
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.hardware.tools.lerobot_calibration import convert_lerobot, read_lerobot_motors

PAIR = Robot.load("so101_pair", calibrated=False)


def lerobot_file(folder: Path, **changes: int) -> Path:
    """Write the file of an arm whose second motor, the shoulder lift, differs."""
    motor = {"drive_mode": 0, "homing_offset": 0, "range_min": 100, "range_max": 4000}
    motors = {f"motor{k}": motor | {"id": k} for k in range(1, 7)}
    motors["motor2"] |= changes
    path = folder / "arm.json"
    path.write_text(json.dumps(motors))
    return path


def converted(path: Path, before: Calibration = NO_CALIBRATION) -> Calibration:
    return convert_lerobot({"left": path}, PAIR, before)


@pytest.mark.parametrize("offset", [-200, 0, 150])
def test_homing_offset_of_a_feetech_servo_is_added_to_the_zero_of_its_hinge(tmp_path: Path, offset: int):
    zeros = converted(lerobot_file(tmp_path, homing_offset=offset)).zero_ticks
    assert zeros["l_shoulder_flexion"] == 1889 + offset
    assert zeros["l_elbow_flexion"] == 1208


def test_homing_offset_of_a_dynamixel_servo_is_subtracted_from_the_zero_of_its_hinge(tmp_path: Path):
    op3 = Robot.load("op3", calibrated=False)
    motor = {"homing_offset": 100, "range_min": 0, "range_max": 4095}
    path = tmp_path / "op3.json"
    path.write_text(json.dumps({f"m{k}": motor | {"id": k} for k in (*range(1, 7), 19, 20)}))
    assert convert_lerobot({"body": path}, op3, NO_CALIBRATION).zero_ticks["skullbase_torsion"] == 2048 - 100


@pytest.mark.parametrize(("mode", "is_inverted"), [(0, False), (1, True)])
def test_drive_mode_inverts_the_direction_of_a_hinge(tmp_path: Path, mode: int, is_inverted: bool):
    assert converted(lerobot_file(tmp_path, drive_mode=mode)).inverted["l_shoulder_flexion"] is is_inverted


def test_measured_range_is_rounded_inward_and_limited_to_that_of_the_robot_file(tmp_path: Path):
    path = lerobot_file(tmp_path, range_min=1889 - 300, range_max=4000)
    assert converted(path).range_deg["l_shoulder_flexion"] == (-26.3, 113.0)


def test_calibration_of_the_other_arm_is_kept(tmp_path: Path):
    before = Calibration("so101_pair", {"r_elbow_flexion": 7, "l_elbow_flexion": 8}, {"r_elbow_flexion": True})
    after = converted(lerobot_file(tmp_path), before)
    assert (after.zero_ticks["r_elbow_flexion"], after.zero_ticks["l_elbow_flexion"]) == (7, 1208)
    assert after.inverted["r_elbow_flexion"] is True


def test_range_without_the_rest_posture_is_refused_with_the_servo(tmp_path: Path):
    path = lerobot_file(tmp_path, range_min=2048, range_max=3000)
    with pytest.raises(ConfigError, match=r"servo 2 lets l_shoulder_flexion go 14\..* excludes its rest of -10 deg"):
        converted(path)


def test_missing_motor_is_named(tmp_path: Path):
    with pytest.raises(ConfigError, match="no motor with id 2, which l_shoulder_flexion has"):
        converted(lerobot_file(tmp_path, id=9))


@pytest.mark.parametrize("text", ["", "[1]", '{"a": {"id": 1}}', '{"a": {"id": "x"}}', "\udcff"])
def test_file_that_is_no_calibration_of_lerobot_is_refused(tmp_path: Path, text: str):
    (tmp_path / "a.json").write_bytes(text.encode(errors="surrogateescape"))
    with pytest.raises(ConfigError, match=r"a\.json: not a calibration of lerobot"):
        read_lerobot_motors(tmp_path / "a.json")


def test_missing_calibration_file_is_reported(tmp_path: Path):
    with pytest.raises(ConfigError, match="No such file"):
        read_lerobot_motors(tmp_path / "a.json")
