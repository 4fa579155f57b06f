"""Robots of kinesic for LeRobot."""

from lerobot_robot_kinesic.config_kinesic_robot import KinesicRobotConfig
from lerobot_robot_kinesic.kinesic_robot import KinesicRobot

__all__ = ["KinesicRobot", "KinesicRobotConfig"]
