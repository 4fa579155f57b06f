"""Motion from the measured position of a ROS robot to the first position of a performance."""

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.hardware.ros.approach import approach_duration, read_positions, sample_approach
from kinesic.hardware.ros.joints import RosJoints
from kinesic.hardware.ros.rosbridge import Rosbridge

from .rosbridge import Robot

START, END = np.array([0.0, 1.0]), np.array([2.0, 0.5])


def test_positions_are_joined_from_messages_of_single_joints(joints: RosJoints, robot: Robot, address: str):
    bridge = Rosbridge(address)
    assert read_positions(bridge, joints.names).tolist() == list(robot.joints.values())
    bridge.close()
    assert [each["topic"] for each in robot.operations_of("unsubscribe")] == ["/joint_states"]


def test_joint_that_no_message_reports_is_named(joints: RosJoints, robot: Robot, address: str):
    del robot.joints["head_pan"]
    bridge = Rosbridge(address)
    with pytest.raises(ConfigError, match=r"/joint_states: reports l_elbow.* within 0.05 s; 'head_pan' is missing"):
        read_positions(bridge, joints.names, timeout=0.05)
    bridge.close()


@pytest.mark.parametrize("value", [float("nan"), float("inf"), "0.5", None, True, []])
def test_position_that_is_no_finite_number_counts_as_missing(robot: Robot, address: str, value: object):
    robot.joints = {"a": value}
    bridge = Rosbridge(address)
    with pytest.raises(ConfigError, match=r"reports no joint within 0\.05 s; 'a' is missing"):
        read_positions(bridge, ["a"], timeout=0.05)
    bridge.close()


def test_approach_begins_and_ends_at_rest_and_stays_below_its_velocity():
    samples = sample_approach(START, END, 0.01)
    times, positions, velocities = (np.array(column) for column in zip(*samples, strict=True))
    assert positions[0].tolist() == START.tolist()
    assert positions[-1] == pytest.approx(END)
    assert velocities[[0, -1]] == pytest.approx(np.zeros((2, 2)))
    assert np.abs(velocities).max() == pytest.approx(0.5, rel=1e-3)
    assert np.gradient(positions[:, 0], times) == pytest.approx(velocities[:, 0], abs=1e-3)
    assert np.diff(times).max() <= 0.01 + 1e-9


def test_short_approach_takes_one_second():
    assert approach_duration(START, START + 0.01) == 1.0
    assert approach_duration(START, END) == pytest.approx(1.875 * 2.0 / 0.5)
