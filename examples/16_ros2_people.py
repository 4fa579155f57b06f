"""Let a robot converse with the people whom ROS4HRI sees and hears, through rosbridge."""

import sys

from kinesic.body.config import ConfigError
from kinesic.client import Client
from kinesic.hardware.ros.people import PeopleBridge
from kinesic.hardware.ros.rosbridge import DEFAULT_ADDRESS, Rosbridge

address = sys.argv[1] if len(sys.argv) > 1 else DEFAULT_ADDRESS
try:
    ros = Rosbridge(address)
    robot = Client()  # kinesic serve
except (ConfigError, OSError) as error:
    print(f"skipped: {error}")
else:
    robot.converse()
    people = PeopleBridge(ros, robot)
    while True:
        people.step()
        if message := robot.receive(timeout=0.0):
            print(message)
