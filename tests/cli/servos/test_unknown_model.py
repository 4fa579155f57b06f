"""Robots with a servo model that the robot's own file describes."""

from pathlib import Path

import pytest

from kinesic.body.robot import Robot
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.virtual.wiring import describe_cables

SERVO = """
[servos.wrist_servo]
model = {number}
volt = 24.0
stall_nm = 3.0
stall_a = 1.2
no_load_rpm = 77
gear = 212.6
mass = 0.082
size = [0.0285, 0.0465, 0.034]
p_gain = 800
d_gain = 0
kp_divisor = 128
armature = 0.0163
frictionloss = 0.06
damping = 0.01
"""
NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" start="0.2"/></bml>'


@pytest.fixture
def robot_file(tmp_path: Path):
    def write(number: int) -> Path:
        text = Robot.load().path.read_text(encoding="utf-8").replace('servo = "xm430_w210"', 'servo = "wrist_servo"')
        path = tmp_path / "mine.toml"
        path.write_text(text + SERVO.format(number=number), encoding="utf-8")
        return path

    return write


@pytest.mark.parametrize(
    "words",
    [
        ("servos", "simulate"),
        ("servos", "show"),
        ("perform", "nod.bml", "--on", "servos", "--port", "/dev/null", "--no-film"),
    ],
    ids=lambda words: words[-1] if words[0] == "servos" else words[0],
)
def test_servo_model_without_a_control_table_is_refused(kinesic, robot_file, tmp_path, words):
    (tmp_path / "nod.bml").write_text(NOD, encoding="utf-8")
    ended = kinesic(*words, "--robot", str(robot_file(1140)))
    assert ended.code == 2
    (line,) = [line for line in ended.err.splitlines() if line.startswith("kinesic: ")]
    assert "mine.toml: " in line
    assert ": servo wrist_servo has model number 1140, which has no FactorySheet; " in line
    assert "add one to kinesic/hardware/protocol/x_series.py" in line


def test_renamed_servo_model_uses_the_control_table_of_its_model_number(robot_file):
    robot = Robot.load(robot_file(1030))
    (cable,) = describe_cables(robot)
    models = {fitting.servo: fitting.model for fitting in cable.fittings}
    assert models == {member.servo.id: member.servo.model.name for member in Manifest.of(robot).members}
    assert "xm430_w210" in models.values()
