"""Certification of motion files for a robot that is chosen by name."""

from pathlib import Path

from kinesic.body.robot import Robot
from kinesic.capture.certification import Certification, certify_clip
from kinesic.capture.read import read_clip
from kinesic.planning.setup import Setup
from kinesic.session.setup import set_up


def certify(path: str | Path, robot: Robot | str | Path | Setup = "upper22") -> Certification:
    """Find a motion file's limit violations and the nearest motion within limits.

    Args:
        path: of the motion (.bvh, .amc, .skm, .glb, .csv, .npz, .mcap, .parquet or .json).
        robot: name of the robot, path of its TOML file, the robot, or a setup.

    Raises:
        ConfigError: the file cannot be read, or the robot is unknown.
    """
    setup = robot if isinstance(robot, Setup) else set_up(robot)
    return certify_clip(read_clip(Path(path)), setup, str(path))
