import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.body.muscle import make_muscle
from kinesic.body.robot import Robot
from kinesic.body.robot_file import read_description
from kinesic.hardware.supervisor.manifest import Manifest


def test_muscle_drive_has_the_given_velocity_acceleration_and_torque_limits():
    drive = make_muscle(speed=5.0, acceleration=100.0, torque=60.0)
    assert drive.speed == pytest.approx(5.0)
    assert drive.stall / drive.armature == pytest.approx(100.0)
    assert drive.stall == 60.0
    assert drive.no_load > drive.speed
    assert drive.gain == pytest.approx(5.0)


def test_human_model_has_the_velocity_and_torque_limits_of_its_robot_file():
    human = Robot.load("human")
    elbow = human.skeleton.joint("l_elbow_flexion")
    assert human.velocity_limits[elbow] == pytest.approx(np.radians(405))
    assert human.drives[elbow].stall == 60
    assert human.drives[human.skeleton.joint("r_elbow_flexion")] == human.drives[elbow]


def test_human_model_cannot_run_on_servos():
    with pytest.raises(ConfigError, match="human has no servos, as it exists only in simulation; leave servos out"):
        Manifest.of(Robot.load("human"))


LIMITS_LINE = "limits = { speed_deg = 405, acceleration_deg = 15_000, torque = 60 }"
MOUNT_LINE = 'mount = { body = "l_shoulder", at = [0, 0, 0] }'


@pytest.mark.parametrize(
    ("new", "message"),
    [
        ("", "hinge l_elbow_flexion: give servo and mount, or limits where no servo turns it"),
        ('servo = "xm430_w210"', "hinge l_elbow_flexion: give servo and mount"),
        (f'{LIMITS_LINE}\nservo = "xm430_w210"', "l_elbow_flexion has limits and servo: limits are for hinges without"),
        (f"{LIMITS_LINE}\n{MOUNT_LINE}", "l_elbow_flexion has limits and mount"),
        (f"{LIMITS_LINE}\nreduction = 2.0", "l_elbow_flexion has limits and reduction"),
        (LIMITS_LINE.replace("405", "0"), "hinge l_elbow_flexion: limits.speed_deg is 0, must be above 0"),
        (LIMITS_LINE.replace("speed_deg", "speeddeg"), r"unknown field `speeddeg`.*did you mean speed_deg\?"),
        (f'servo = "xm430_w210"\n{MOUNT_LINE}', "l_elbow_flexion has a servo and vl5_torsion has limits: give all"),
    ],
)
def test_invalid_hinge_of_the_human_model_is_refused_with_its_cause(tmp_path, new: str, message: str):
    text = Robot.load("human").path.read_text(encoding="utf-8")
    assert text.count(LIMITS_LINE) == 1
    path = tmp_path / "robot.toml"
    path.write_text(text.replace(LIMITS_LINE, new), encoding="utf-8")
    with pytest.raises(ConfigError, match=message):
        read_description(path)


def test_bus_table_in_a_robot_file_without_servos_is_refused_with_a_remedy(tmp_path):
    path = tmp_path / "robot.toml"
    text = Robot.load("human").path.read_text(encoding="utf-8")
    path.write_text(f'{text}\n[[bus]]\nname = "body"\nbaud = 1_000_000\n', encoding="utf-8")
    with pytest.raises(ConfigError, match=r"\[\[bus\]\], but no hinge has a servo: remove it, or give servos"):
        read_description(path)
