"""A ROS 2 topic as a sink: goals go out as sensor_msgs/JointState, and whatever listens there moves."""

import time

from kinesic.body.command import RATE, Command
from kinesic.body.config import CONFIGS
from kinesic.controller.feedforward import lead
from kinesic.controller.perform import facts, plan
from kinesic.controller.play import command_times, commands, play

try:
    import rclpy
    from sensor_msgs.msg import JointState
except ImportError:
    rclpy = None


class Topic:
    """Publishes goals when they are due."""

    def __init__(self, names: tuple[str, ...]) -> None:
        rclpy.init()
        self.names, self.node, self.began = names, rclpy.create_node("kinesic"), time.monotonic()
        self.publisher = self.node.create_publisher(JointState, "joint_commands", 10)

    def write(self, command: Command, /) -> None:
        time.sleep(max(0.0, self.began + command.time - time.monotonic()))  # whoever listens lives in real time
        self.publisher.publish(JointState(name=self.names, position=command.goals.tolist()))

    def close(self) -> None:
        rclpy.shutdown()


if rclpy is None:
    print("skipped: no rclpy here; source ROS 2's setup.bash first")
else:
    planned = plan((CONFIGS / "bml" / "welcome.bml").read_bytes(), known := facts())
    setpoints = lead(
        planned.trajectory, times := command_times(planned.duration), known.robot, known.dynamics, period=1 / RATE
    )
    play(commands(planned.trajectory, times, setpoints), Topic(known.robot.skeleton.names))
