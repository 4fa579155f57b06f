"""Publish setpoints to ROS 2 as sensor_msgs/JointState."""

import time

from kinesic import Performer
from kinesic.body.command import Command
from kinesic.body.config import CONFIGS

try:
    import rclpy
    from sensor_msgs.msg import JointState
except ImportError:
    rclpy = None


class Topic:
    """Sink that publishes setpoints in real time."""

    def __init__(self, names: tuple[str, ...]) -> None:
        rclpy.init()
        self.names, self.node, self.start = names, rclpy.create_node("kinesic"), time.monotonic()
        self.publisher = self.node.create_publisher(JointState, "joint_commands", 10)

    def write(self, command: Command, /) -> None:
        time.sleep(max(0.0, self.start + command.time - time.monotonic()))  # Subscribers need setpoints in real time.
        self.publisher.publish(JointState(name=self.names, position=command.setpoints.tolist()))

    def close(self) -> None:
        rclpy.shutdown()


if rclpy is None:
    print("skipped: no rclpy here; source ROS 2's setup.bash first")
else:
    performer = Performer()
    performer.perform(CONFIGS / "bml" / "welcome.bml", sinks=[Topic(performer.robot.skeleton.names)])
