"""Robots of other makers that the benchmark of captured motion imports."""

import os
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.body.robot_file import robot_from_tables
from kinesic.extras import install_extra
from kinesic.sim.importer.convert import import_humanoid

WHEEL_NAME = "playground"  # distribution with the robots' MJCF files, in the extra `robots`
ROBOT_FILES: Mapping[str, str] = {  # robot -> end of the path of its MJCF file in the wheel
    "g1": "g1/xmls/g1_mjx_feetonly.xml",
    "h1": "h1/xmls/h1_mjx_feetonly.xml",
    "op3": "op3/xmls/op3_mjx_feetonly.xml",
    "t1": "t1/xmls/t1_mjx_feetonly.xml",
    "apollo": "apollo/xmls/apollo_mjx_feetonly.xml",
}


def load_imported(name: str) -> Robot:
    """Import a robot from the wheel of the extra `robots`.

    Raises:
        ConfigError: the wheel is not installed, or has no such file.
    """
    try:
        listed = files(WHEEL_NAME) or []
    except PackageNotFoundError:
        listed = []
    found = next((file for file in listed if str(file).endswith(ROBOT_FILES[name])), None)
    if found is None:
        raise ConfigError(f"no MJCF file of {name}: {install_extra('robots')}")
    path = Path(os.fspath(found.locate()))
    return Robot.of(robot_from_tables(import_humanoid(path).file, path))
