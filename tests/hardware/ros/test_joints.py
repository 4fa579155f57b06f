"""Joints of ROS messages: names, directions and zeros of the robot's own file."""

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.hardware.ros.joints import RosJoints, duration, joint_state, joint_trajectory, trajectory_point

from .rosbridge import find_mismatch

PAIR = np.array([0.123456789, -2.0])


def test_positions_have_the_name_direction_and_zero_of_the_robots_own_file(joints: RosJoints):
    angles = np.zeros(8)
    angles[0] = 0.3
    assert joints.names[:2] == ("head_pan", "skullbase_tilt")
    assert joints.positions(angles)[0] == pytest.approx(np.pi / 2 - 0.3)
    assert joints.rates(angles)[0] == pytest.approx(-0.3)
    assert joints.positions(angles)[1:] == pytest.approx(np.zeros(7))


def test_chosen_joints_keep_the_order_of_the_caller(joints: RosJoints):
    chosen = RosJoints.of(joints.robot, ["l_elbow_flexion", "head_pan"])
    assert chosen.positions(np.arange(8.0)) == pytest.approx([4.0, np.pi / 2])
    assert chosen.rates(np.arange(8.0)) == pytest.approx([4.0, 0.0])


@pytest.mark.parametrize(
    ("names", "reason"),
    [
        (["skullbase_torsion"], "mine has no joint 'skullbase_torsion'; its joints: head_pan"),
        (["head_pan", "head_pan"], "must be one or more different names"),
        ([], "must be one or more different names"),
    ],
)
def test_unknown_repeated_or_missing_joints_are_refused(joints: RosJoints, names: list[str], reason: str):
    with pytest.raises(ConfigError, match=reason):
        RosJoints.of(joints.robot, names)


def test_messages_have_the_fields_and_kinds_of_their_ros_types():
    state = joint_state(("a", "b"), PAIR, PAIR)
    trajectory = joint_trajectory(("a", "b"), [trajectory_point(1.5, PAIR, PAIR, PAIR)])
    assert find_mismatch(state, "sensor_msgs/msg/JointState") is None
    assert find_mismatch(trajectory, "trajectory_msgs/msg/JointTrajectory") is None
    assert state["position"] == [0.1234568, -2.0]
    assert trajectory["header"]["stamp"] == {"sec": 0, "nanosec": 0}


@pytest.mark.parametrize(
    ("seconds", "whole", "rest"), [(0.0, 0, 0), (1.25, 1, 250_000_000), (2.9999999999, 3, 0), (600.05, 600, 50_000_000)]
)
def test_durations_are_whole_seconds_and_nanoseconds(seconds: float, whole: int, rest: int):
    assert duration(seconds) == {"sec": whole, "nanosec": rest}
