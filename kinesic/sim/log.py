"""A log of servos: goals sent and angles measured, on a bus or in a twin."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Measurements
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.files.array_file import numbers_of, read_arrays, text_of

FORMAT = (
    "npz with times (m,) [s], names (n,) of the hinges, goals (m, n) [rad] sent at these times, and angles (m, n) "
    "[rad] measured there just before; it begins at rest"
)
LARGEST_LOG = 500_000_000  # [bytes] unpacked: an hour of 22 hinges at 100 Hz is 130 MB
ARRAYS = ("times", "names", "goals", "angles")


@dataclass(frozen=True, eq=False)
class Log:
    """Goals sent and angles measured, in joint order; it begins at rest."""

    times: Floats  # (m,) [s] increasing
    goals: Floats  # (m, n) [rad] sent at these times
    angles: Floats  # (m, n) [rad] measured just before


def log_of(measured: Measurements) -> Log:
    """Takes goals and angles of what a sink measured."""
    return Log(measured.times, measured.goals, measured.angles)


def write_log(measured: "Measurements | Log", robot: Robot, path: Path) -> None:
    """Writes what a sink saw, in the format that `read_log` reads."""
    names = np.array(robot.skeleton.names)
    np.savez_compressed(path, times=measured.times, names=names, goals=measured.goals, angles=measured.angles)


def read_log(path: Path, robot: Robot) -> Log:
    """Reads a log.

    Raises:
        ConfigError: it is missing, lacks an array or a hinge, or holds no motion.
    """
    arrays = read_arrays(path, max_size=LARGEST_LOG, kind=f"log; a log is {FORMAT}")
    missing = [name for name in ARRAYS if name not in arrays]
    if missing:
        raise ConfigError(f"{path}: lacks {', '.join(missing)}; a log is {FORMAT}")
    try:
        names = [str(name) for name in text_of(arrays, "names", 1)]
        times = numbers_of(arrays, "times", 1).astype(np.float64)
        data = {name: numbers_of(arrays, name, 2).astype(np.float64) for name in ("goals", "angles")}
    except ValueError as error:
        raise ConfigError(f"{path}: {error}; a log is {FORMAT}") from None
    lost = [name for name in robot.skeleton.names if name not in names]
    if lost:
        raise ConfigError(f"{path}: lacks {len(lost)} hinges of {robot.name}, first {lost[0]}")
    for name, rows in data.items():
        if rows.shape != (len(times), len(names)):
            raise ConfigError(f"{path}: {name} is {rows.shape}, must be {(len(times), len(names))}")
        if not np.isfinite(rows).all():
            raise ConfigError(f"{path}: {name} holds a number that is not finite")
    if len(times) < 2 or not np.isfinite(times).all() or not (np.diff(times) > 0).all():
        raise ConfigError(f"{path}: times must be at least two, and increase")
    order = [names.index(name) for name in robot.skeleton.names]
    return Log(sealed(times), sealed(data["goals"][:, order]), sealed(data["angles"][:, order]))
