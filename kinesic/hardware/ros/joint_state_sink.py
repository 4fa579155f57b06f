"""Sink that publishes joint positions in real time."""

import time
from collections.abc import Callable
from contextlib import ExitStack

from kinesic.body.arrays import Floats
from kinesic.body.command import Command
from kinesic.hardware.ros.approach import STATE_TOPIC, read_positions, sample_approach
from kinesic.hardware.ros.joints import JOINT_STATE_TYPE, RosJoints, joint_state
from kinesic.hardware.ros.rosbridge import DEFAULT_ADDRESS, Rosbridge

COMMAND_TOPIC = "/joint_commands"  # default topic of the published positions
APPROACH_PERIOD = 0.01  # [s] between two positions of the approach


class JointStateSink:
    """Sink that publishes joint states 100 times per second.

    It waits for the time of each command, so a performance takes its duration. The robot first moves from its measured
    position to that of the first command.
    """

    def __init__(
        self,
        joints: RosJoints,
        address: str = DEFAULT_ADDRESS,
        *,
        topic: str = COMMAND_TOPIC,
        state_topic: str | None = STATE_TOPIC,
        now: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        """Connect to rosbridge and read the robot's position.

        Args:
            joints: joints to publish.
            address: address of rosbridge.
            topic: topic of the published positions.
            state_topic: topic of the robot's measured positions; None: the robot must already be in its rest posture.
            now: clock [s].
            sleep: function that waits [s].

        Raises:
            ConfigError: no rosbridge answers, or the positions are not reported.
        """
        self._joints, self._topic, self._now, self._sleep = joints, topic, now, sleep
        self._start: float | None = None  # [s] clock at performance time 0
        self._bridge = Rosbridge(address)
        self._measured: Floats | None = None  # (j,) [rad] positions before the first command
        with ExitStack() as ending:
            ending.callback(self._bridge.close)
            self._bridge.send("advertise", topic=topic, type=JOINT_STATE_TYPE)
            if state_topic is not None:
                self._measured = read_positions(self._bridge, joints.names, topic=state_topic)
            ending.pop_all()  # The connection stays open for commands.

    @property
    def errors(self) -> tuple[str, ...]:
        """Latest error messages of rosbridge."""
        return self._bridge.errors

    def write(self, command: Command, /) -> None:
        """Publish the positions of a command at its time."""
        positions, velocities = self._joints.positions(command.angles), self._joints.rates(command.velocities)
        if self._measured is not None:
            begin = self._now()
            for place, point, rates in sample_approach(self._measured, positions, APPROACH_PERIOD):
                self._publish(begin + place, point, rates)
            self._measured = None
        if self._start is None:
            self._start = self._now() - command.time
        self._publish(self._start + command.time, positions, velocities)

    def close(self) -> None:
        """Close the connection."""
        self._bridge.close()

    def _publish(self, due: float, positions: Floats, velocities: Floats) -> None:
        """Publish positions at a clock time [s], and read error messages."""
        self._sleep(max(0.0, due - self._now()))
        self._bridge.send("publish", topic=self._topic, msg=joint_state(self._joints.names, positions, velocities))
        self._bridge.receive(0.0)
