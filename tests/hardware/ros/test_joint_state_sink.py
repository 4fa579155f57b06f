"""Publishing of joint states on a stand-in for rosbridge, with a clock that does not wait."""

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.config import ConfigError
from kinesic.hardware.ros import joint_state_sink
from kinesic.hardware.ros.approach import read_positions
from kinesic.hardware.ros.joint_state_sink import JointStateSink
from kinesic.hardware.ros.joints import RosJoints

from .conftest import Clock
from .rosbridge import Robot

Commands = Callable[..., Command]


def test_robot_moves_from_its_measured_position_to_the_first_command(
    joints: RosJoints, robot: Robot, address: str, command: Commands
):
    robot.joints["head_pan"] += 0.1
    clock = Clock()
    sink = JointStateSink(joints, address, now=clock.now, sleep=clock.sleep)
    sink.write(command(0.0))
    sink.close()
    pan = [message["position"][0] for message in robot.published]
    assert pan[0] == pytest.approx(robot.joints["head_pan"])
    assert pan[-1] == pytest.approx(joints.positions(joints.robot.skeleton.rest)[0], abs=1e-6)
    assert np.abs(np.diff(pan)).max() < 0.01
    assert clock.time == pytest.approx(5.0 + 1.0)


def test_commands_are_published_at_their_times_with_names_of_the_robot(
    joints: RosJoints, robot: Robot, address: str, command: Commands
):
    clock = Clock()
    sink = JointStateSink(joints, address, topic="/arms", state_topic=None, now=clock.now, sleep=clock.sleep)
    for k in range(50):
        sink.write(command(k / 100, turn=0.01 * k, velocity=1.0))
    sink.close()
    assert sink.errors == ()
    assert robot.operations_of("subscribe") == []
    assert clock.time == pytest.approx(5.49)
    assert {operation["topic"] for operation in robot.operations_of("publish")} == {"/arms"}
    assert {tuple(message["name"]) for message in robot.published} == {joints.names}
    rest = joints.positions(joints.robot.skeleton.rest)[0]
    assert [message["position"][0] for message in robot.published] == pytest.approx(rest - 0.01 * np.arange(50))
    assert robot.published[9]["velocity"][0] == -1.0


def test_robot_that_does_not_report_its_position_is_not_moved(
    joints: RosJoints, robot: Robot, address: str, monkeypatch: pytest.MonkeyPatch
):
    robot.joints.clear()
    monkeypatch.setattr(joint_state_sink, "read_positions", partial(read_positions, timeout=0.02))
    with pytest.raises(ConfigError, match="reports no joint"):
        JointStateSink(joints, address)
    assert robot.published == []


def test_messages_that_rosbridge_refuses_are_reported(joints: RosJoints, address: str, command: Commands):
    sink = JointStateSink(joints, address, state_topic=None, sleep=lambda _: None)
    sink.write(command(0.0, turn=float("nan")))
    while not sink.errors:
        sink.write(command(0.1))
    sink.close()
    assert sink.errors == ("None is no float64",)
