"""Logs of setpoints sent to servos and measured angles.

They come from a bus or a twin.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Measurements
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.files.array_file import numbers_of, read_arrays, text_of

LOG_FORMAT = (
    "npz with times (m,) [s], names (n,) of the hinges, goals (m, n) [rad] sent at these times, and angles (m, n) "
    "[rad] measured just before them; it begins at rest"
)
MAX_LOG_SIZE = 500_000_000  # [bytes] largest unpacked log; an hour of 22 hinges at 100 Hz has 130 MB
LOG_ARRAYS = ("times", "names", "goals", "angles")  # arrays of a log file


@dataclass(frozen=True, eq=False)
class Log:
    """Setpoints sent to servos and measured angles, starting at rest."""

    times: Floats  # (m,) [s] increasing
    setpoints: Floats  # (m, n) [rad] sent at these times
    angles: Floats  # (m, n) [rad] measured just before these times


def make_log(measured: Measurements) -> Log:
    """Return the log of a performance from its measurements."""
    return Log(measured.times, measured.setpoints, measured.angles)


def write_log(measured: "Measurements | Log", robot: Robot, path: Path) -> None:
    """Write measurements as a log file that `read_log` reads."""
    names = np.array(robot.skeleton.names)
    np.savez_compressed(path, times=measured.times, names=names, goals=measured.setpoints, angles=measured.angles)


def read_log(path: Path, robot: Robot) -> Log:
    """Read a log file, with hinges in the robot's joint order.

    Raises:
        ConfigError: the file is missing, lacks an array or a hinge, or contains no motion.
    """
    arrays = read_arrays(path, max_size=MAX_LOG_SIZE, kind=f"log; a log is {LOG_FORMAT}")
    missing = [name for name in LOG_ARRAYS if name not in arrays]
    if missing:
        raise ConfigError(f"{path}: lacks {', '.join(missing)}; a log is {LOG_FORMAT}")
    try:
        names = [str(name) for name in text_of(arrays, "names", 1)]
        times = numbers_of(arrays, "times", 1).astype(np.float64)
        data = {name: numbers_of(arrays, name, 2).astype(np.float64) for name in ("goals", "angles")}
    except ValueError as error:
        raise ConfigError(f"{path}: {error}; a log is {LOG_FORMAT}") from None
    missing_hinges = [name for name in robot.skeleton.names if name not in names]
    if missing_hinges:
        raise ConfigError(f"{path}: lacks {len(missing_hinges)} hinges of {robot.name}, first {missing_hinges[0]}")
    for name, rows in data.items():
        if rows.shape != (len(times), len(names)):
            raise ConfigError(f"{path}: {name} is {rows.shape}, must be {(len(times), len(names))}")
        if not np.isfinite(rows).all():
            raise ConfigError(f"{path}: {name} holds a number that is not finite")
    if len(times) < 2 or not np.isfinite(times).all() or not (np.diff(times) > 0).all():
        raise ConfigError(f"{path}: times must be at least two, and increase")
    order = [names.index(name) for name in robot.skeleton.names]
    return Log(sealed(times), sealed(data["goals"][:, order]), sealed(data["angles"][:, order]))
