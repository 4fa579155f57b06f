"""Loads a robot whole: its body and its servo map, so that every table of its file is checked."""

from pathlib import Path

from kinesic.body.robot import Robot
from kinesic.hardware.protocol.servo_map import ServoMap


def load_robot(name: str | Path = "upper22") -> Robot:
    """Reads a robot and checks its buses too.

    Raises:
        ConfigError: the file is missing or wrong.
    """
    robot = Robot.load(name)
    ServoMap.of(robot)
    return robot
