"""Performance by a joint trajectory controller behind a stand-in for rosbridge."""

from collections.abc import Callable

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.config import ConfigError
from kinesic.hardware.ros import trajectory_sink
from kinesic.hardware.ros.goal import perform_goal
from kinesic.hardware.ros.joints import RosJoints
from kinesic.hardware.ros.rosbridge import Rosbridge
from kinesic.hardware.ros.trajectory_sink import TrajectorySink

from .conftest import Clock
from .rosbridge import Robot

Commands = Callable[..., Command]


def perform(sink: TrajectorySink, command: Commands, *, count: int = 23) -> None:
    """Write commands of a motion at 100 Hz that ends at rest, and close the sink."""
    for k in range(count):
        sink.write(command(k / 100, turn=0.01 * k, velocity=0.0 if k == count - 1 else 1.0))
    sink.close()


def times(trajectory: dict) -> list[float]:
    stamps = [point["time_from_start"] for point in trajectory["points"]]
    return [stamp["sec"] + 1e-9 * stamp["nanosec"] for stamp in stamps]


def test_goal_has_points_every_50_ms_after_the_approach_and_the_last_command(
    joints: RosJoints, robot: Robot, address: str, command: Commands
):
    perform(TrajectorySink(joints, address, controller="/arms/"), command)
    (goal,) = robot.operations_of("send_action_goal")
    assert goal["action"] == "/arms/follow_joint_trajectory"
    assert goal["action_type"] == "control_msgs/action/FollowJointTrajectory"
    trajectory = goal["args"]["trajectory"]
    assert times(trajectory) == pytest.approx([1.0, 1.05, 1.1, 1.15, 1.2, 1.22])
    assert trajectory["joint_names"] == list(joints.names)
    rest = joints.positions(joints.robot.skeleton.rest)[0]
    assert trajectory["points"][-1]["positions"][0] == pytest.approx(rest - 0.22)
    assert trajectory["points"][1]["velocities"][0] == -1.0
    assert trajectory["points"][1]["accelerations"][0] == -3.0
    assert robot.operations_of("cancel_action_goal") == []


def test_distant_robot_gets_more_time_for_the_approach(
    joints: RosJoints, robot: Robot, address: str, command: Commands
):
    robot.joints["head_pan"] += 2.0
    perform(TrajectorySink(joints, address), command)
    assert times(robot.operations_of("send_action_goal")[0]["args"]["trajectory"])[0] == pytest.approx(7.5, abs=1e-6)


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        ({"error_code": -5, "error_string": "head_pan"}, "the goal failed: goal tolerance exceeded: head_pan"),
        ({"error_code": -4, "error_string": ""}, "the goal failed: path tolerance exceeded$"),
        ({"error_code": 9, "error_string": ""}, "the goal failed: error 9, status 6"),
    ],
)
def test_failed_goal_is_reported_with_the_reason_of_the_controller(
    joints: RosJoints, robot: Robot, address: str, command: Commands, fault: dict, reason: str
):
    robot.fault = fault
    with pytest.raises(ConfigError, match=reason):
        perform(TrajectorySink(joints, address), command)


def test_goal_with_other_joints_than_those_of_the_controller_fails(joints: RosJoints, address: str, command: Commands):
    some = RosJoints.of(joints.robot, joints.names[:3])
    with pytest.raises(ConfigError, match="invalid joints: joints differ"):
        perform(TrajectorySink(some, address), command)


def test_goal_that_rosbridge_refuses_fails_at_once(joints: RosJoints, robot: Robot, address: str):
    bridge = Rosbridge(address)
    with pytest.raises(ConfigError, match="has no field name"):
        perform_goal(bridge, "/arms", {"name": "a"}, timeout=5.0)
    bridge.close()


@pytest.mark.parametrize("interruption", [KeyboardInterrupt, None])
def test_goal_without_result_or_with_ctrl_c_is_cancelled(
    robot: Robot, address: str, monkeypatch: pytest.MonkeyPatch, interruption: type[BaseException] | None
):
    robot.performs_goals = False
    bridge = Rosbridge(address)

    def receive(timeout: float) -> None:
        if interruption is not None:
            raise interruption

    monkeypatch.setattr(bridge, "receive", receive)
    with pytest.raises(interruption or ConfigError):
        perform_goal(bridge, "/arms", {}, timeout=5.0)
    bridge.close()
    assert [each["id"] for each in robot.operations_of("cancel_action_goal")] == ["kinesic"]


def test_topic_gets_the_trajectory_and_the_sink_waits_for_its_end(
    joints: RosJoints, robot: Robot, address: str, command: Commands
):
    clock = Clock()
    perform(TrajectorySink(joints, address, sent_as="topic", sleep=clock.sleep), command)
    (advertised,), (operation,) = (robot.operations_of(kind) for kind in ("advertise", "publish"))
    assert advertised["topic"] == operation["topic"] == "/joint_trajectory_controller/joint_trajectory"
    assert advertised["type"] == "trajectory_msgs/msg/JointTrajectory"
    assert times(operation["msg"])[-1] == pytest.approx(1.22)
    assert clock.time == pytest.approx(5.0 + 0.5 + 1.22)


def test_motion_that_is_cut_off_is_not_sent(joints: RosJoints, robot: Robot, address: str, command: Commands):
    sink = TrajectorySink(joints, address)
    sink.write(command(0.0, velocity=1.0))
    sink.close()
    TrajectorySink(joints, address).close()
    assert robot.operations == []


def test_performance_that_is_too_long_for_one_message_is_refused(
    joints: RosJoints, address: str, command: Commands, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(trajectory_sink, "MAX_DURATION", 0.1)
    sink = TrajectorySink(joints, address)
    with pytest.raises(ConfigError, match=r"lasts more than 0\.1 s; divide the document"):
        perform(sink, command)
    sink.close()


def test_quintics_between_points_stay_within_a_tenth_of_a_degree_of_a_fast_motion():
    period, frequency = trajectory_sink.POINT_PERIOD, 2 * np.pi * 2.0  # [rad/s] 2 Hz, 0.3 rad
    angles, rates, turns = 0.3, 0.3 * frequency, 0.3 * frequency**2
    ends = np.array([0.0, period])
    position, velocity, acceleration = (
        angles * np.sin(frequency * ends),
        rates * np.cos(frequency * ends),
        -turns * np.sin(frequency * ends),
    )
    powers = np.arange(6)
    rows = [[time**k for k in powers] for time in ends]
    first = [[k * time ** max(k - 1, 0) for k in powers] for time in ends]
    second = [[k * (k - 1) * time ** max(k - 2, 0) for k in powers] for time in ends]
    weights = np.linalg.solve(np.array(rows + first + second), np.concatenate([position, velocity, acceleration]))
    inside = np.linspace(0.0, period, 20)
    error = inside[:, None] ** powers @ weights - angles * np.sin(frequency * inside)
    assert np.degrees(np.abs(error).max()) < 0.1
