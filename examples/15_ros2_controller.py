"""Perform on a ROS 2 robot through rosbridge, by the action of its trajectory controller."""

import sys

from kinesic import Performer
from kinesic.body.config import ConfigError
from kinesic.hardware.ros.joints import RosJoints
from kinesic.hardware.ros.rosbridge import DEFAULT_ADDRESS
from kinesic.hardware.ros.trajectory_sink import DEFAULT_CONTROLLER, TrajectorySink

defaults = ("welcome", "op3", DEFAULT_ADDRESS, DEFAULT_CONTROLLER)
document, robot, address, controller = (*sys.argv[1:], *defaults[len(sys.argv) - 1 :])
performer = Performer(robot)
try:
    sink = TrajectorySink(RosJoints.of(performer.robot), address, controller=controller)
    performer.perform(document, sinks=[sink])
except ConfigError as error:
    print(f"skipped: {error}")
else:
    print(f"{robot} has performed {document}")
