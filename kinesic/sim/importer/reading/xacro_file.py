"""Expansion of xacro files, where the package xacro is installed."""

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

from kinesic.body.config import ConfigError
from kinesic.extras import install_extra
from kinesic.sim.importer.reading.mesh_folders import find_ros_package

XACRO_NAMESPACE = b"xmlns:xacro="  # attribute of the root element of files with macros
MACRO_MARKS = (b"<xacro:", b"${", b"$(")  # beginnings of macros and expressions
XACRO_MODULE = "kinesic.sim.importer.reading.xacro_process"  # module of the process that expands a file
EXPANSION_TIMEOUT = 60.0  # [s] longest expansion
MAX_REASON_LENGTH = 500  # [characters] longest printed reason


def is_xacro(data: bytes) -> bool:
    """Return whether a robot file has macros."""
    return XACRO_NAMESPACE in data and any(mark in data for mark in MACRO_MARKS)


def expand_xacro(path: Path) -> bytes:
    """Return the URDF of a xacro file.

    The macros may read files in the ROS package of the file and in packages next to it, else in the file's folder.

    Raises:
        ConfigError: the package xacro is not installed, or it refuses the file.
    """
    if find_spec("xacro") is None:
        raise ConfigError(
            f"{path}: it has xacro macros. Expand it: xacro {path.name} > robot.urdf. Or install "
            f"kinesic's extra: {install_extra('xacro')}"
        )
    folder = path.parent.resolve()
    package = find_ros_package(folder)
    home = folder if package is None else package.parent
    try:
        ended = subprocess.run(
            [sys.executable, "-P", "-m", XACRO_MODULE, str(folder / path.name), str(home)],
            capture_output=True,
            check=False,
            timeout=EXPANSION_TIMEOUT,
        )
    except subprocess.TimeoutExpired:
        raise ConfigError(f"{path}: its xacro macros take more than {EXPANSION_TIMEOUT:.0f} s") from None
    if ended.returncode:
        lines = ended.stderr.decode(errors="replace").strip().splitlines() or [f"exit code {ended.returncode}"]
        raise ConfigError(f"{path}: xacro cannot expand it: {lines[-1][:MAX_REASON_LENGTH]}")
    return ended.stdout
