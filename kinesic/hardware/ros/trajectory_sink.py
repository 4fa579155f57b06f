"""Sink that sends a whole performance to a joint trajectory controller."""

import time
from collections.abc import Callable
from typing import Literal

import numpy as np

from kinesic.body.command import Command
from kinesic.body.config import ConfigError
from kinesic.hardware.ros.approach import STATE_TOPIC, approach_duration, read_positions
from kinesic.hardware.ros.goal import perform_goal
from kinesic.hardware.ros.joints import TRAJECTORY_TYPE, RosJoints, joint_trajectory, trajectory_point
from kinesic.hardware.ros.rosbridge import DEFAULT_ADDRESS, Message, Rosbridge

DEFAULT_CONTROLLER = "/joint_trajectory_controller"  # usual name of the controller in ros2_control
POINT_PERIOD = 0.05  # [s] between points, which the controller joins by quintics
TIME_TOLERANCE = 1e-9  # [s] by which a command may come before the next point is due
MAX_DURATION = 600.0  # [s] longest performance in one message
REST_VELOCITY = 0.01  # [rad/s] largest joint velocity at the end of a whole performance
DISCOVERY_DURATION = 0.5  # [s] in which ROS connects publisher and subscriber
RESULT_MARGIN = 10.0  # [s] longest wait for the result after the end of the motion

SentAs = Literal["goal", "topic"]  # FollowJointTrajectory action, or JointTrajectory message


class TrajectorySink:
    """Sink that collects a performance and sends it when it is closed.

    The controller moves the robot from its measured position to the first point. `close` returns when the motion has
    ended. A performance that another error cuts off is not sent.
    """

    def __init__(
        self,
        joints: RosJoints,
        address: str = DEFAULT_ADDRESS,
        *,
        controller: str = DEFAULT_CONTROLLER,
        sent_as: SentAs = "goal",
        state_topic: str = STATE_TOPIC,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        """Connect to rosbridge.

        Args:
            joints: joints of the controller.
            address: address of rosbridge.
            controller: name of the controller.
            sent_as: a goal reports whether the controller has performed the motion; a topic does not.
            state_topic: topic of the robot's measured positions.
            sleep: function that waits [s].

        Raises:
            ConfigError: no rosbridge answers.
        """
        self._joints, self._controller, self._sent_as = joints, controller.rstrip("/"), sent_as
        self._state_topic, self._sleep = state_topic, sleep
        self._commands: list[Command] = []  # one for each point
        self._last: Command | None = None
        self._bridge = Rosbridge(address)

    def write(self, command: Command, /) -> None:
        """Collect a command.

        Raises:
            ConfigError: the performance is too long for one message.
        """
        if command.time > MAX_DURATION:
            raise ConfigError(f"the performance lasts more than {MAX_DURATION:g} s; divide the document")
        self._last = command
        if not self._commands or command.time > self._commands[-1].time + POINT_PERIOD - TIME_TOLERANCE:
            self._commands.append(command)

    def close(self) -> None:
        """Send the performance, wait until the robot has performed it, and disconnect.

        Raises:
            ConfigError: the measured position is not reported, or the controller refuses or fails.
        """
        try:
            if self._last is not None and np.max(np.abs(self._last.velocities)) <= REST_VELOCITY:
                self._perform()
        finally:
            self._bridge.close()

    def _perform(self) -> None:
        names = self._joints.names
        measured = read_positions(self._bridge, names, topic=self._state_topic)
        delay = approach_duration(measured, self._joints.positions(self._commands[0].angles))
        commands = self._commands + ([self._last] if self._last and self._last is not self._commands[-1] else [])
        points = [self._point(command, delay) for command in commands]
        trajectory = joint_trajectory(names, points)
        total = delay + commands[-1].time
        if self._sent_as == "goal":
            action = f"{self._controller}/follow_joint_trajectory"
            perform_goal(self._bridge, action, trajectory, timeout=total + RESULT_MARGIN)
            return
        topic = f"{self._controller}/joint_trajectory"
        self._bridge.send("advertise", topic=topic, type=TRAJECTORY_TYPE)
        self._sleep(DISCOVERY_DURATION)
        self._bridge.send("publish", topic=topic, msg=trajectory)
        self._sleep(total)
        while self._bridge.receive(0.0) is not None:
            pass
        if self._bridge.errors:
            raise ConfigError(f"{topic}: rosbridge refuses the trajectory: {self._bridge.errors[-1]}")

    def _point(self, command: Command, delay: float) -> Message:
        joints = self._joints
        return trajectory_point(
            command.time + delay,
            joints.positions(command.angles),
            joints.rates(command.velocities),
            joints.rates(command.accelerations),
        )
