"""A robot from tables that are not written yet."""

from dataclasses import fields
from pathlib import Path

from kinesic.body.robot import Robot
from kinesic.body.robot_file import robot_from_tables
from kinesic.body.robot_schema import RobotFile


def robot_of(file: RobotFile, path: Path) -> Robot:
    """The robot that these tables describe."""
    found = robot_from_tables(file, path)
    return Robot(**{field.name: getattr(found, field.name) for field in fields(found)})
