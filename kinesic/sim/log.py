"""A log of servos: goals sent and angles measured, on a bus or in a twin."""

import zlib
from dataclasses import dataclass
from pathlib import Path
from zipfile import BadZipFile, ZipFile

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Measurements
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot

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
        ConfigError: it is missing, lacks an array or a hinge, or holds what is no motion.
    """
    try:
        with ZipFile(path) as whole:
            unpacked = sum(part.file_size for part in whole.infolist())
        if unpacked > LARGEST_LOG:
            raise ConfigError(f"{path}: unpacks to {unpacked / 1e6:.0f} MB, at most {LARGEST_LOG / 1e6:.0f} are read")
        with np.load(path, allow_pickle=False) as file:
            data = {name: file[name] for name in ARRAYS if name in file}
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror or error}") from None
    except ConfigError:
        raise
    except (ValueError, BadZipFile, MemoryError, zlib.error):
        raise ConfigError(f"{path}: no log; a log is {FORMAT}") from None
    missing = [name for name in ARRAYS if name not in data]
    if missing:
        raise ConfigError(f"{path}: lacks {', '.join(missing)}; a log is {FORMAT}")
    names, count = [str(name) for name in data["names"]], len(data["times"])
    lost = [name for name in robot.skeleton.names if name not in names]
    if lost:
        raise ConfigError(f"{path}: lacks {len(lost)} hinges of {robot.name}, first {lost[0]}")
    for name in ("goals", "angles"):
        if data[name].shape != (count, len(names)):
            raise ConfigError(f"{path}: {name} is {data[name].shape}, must be {(count, len(names))}")
        if not np.isfinite(data[name]).all():
            raise ConfigError(f"{path}: {name} holds a number that is not finite")
    if count < 2 or not (np.diff(data["times"]) > 0).all():
        raise ConfigError(f"{path}: times must be at least two, and increase")
    order = [names.index(name) for name in robot.skeleton.names]
    return Log(sealed(data["times"]), sealed(data["goals"][:, order]), sealed(data["angles"][:, order]))
