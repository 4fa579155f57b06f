"""Writes a motion to a file: npz and csv of the reference, or MPEG-4 body animation parameters."""

import csv
from pathlib import Path

import numpy as np

from kinesic.body.command import RATE
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.files.output_file import new_file
from kinesic.planning.bap import Sampled, write_bap

SUFFIXES = (".npz", ".csv", ".bap")


def save_motion(motion: Sampled, robot: Robot, path: Path, *, force: bool) -> Path:
    """Writes a motion to a file, as a whole, and returns its path; the suffix names the format.

    Args:
        motion: planned or measured.
        robot: whose it is.
        path: ending in .npz, .csv or .bap.
        force: whether a file that is there may be replaced.

    Raises:
        ConfigError: the suffix is not known, or the path is a folder's, a link's or, unless forced, a file's.
    """
    check_motion_file(path)
    with new_file(path, force=force) as fresh:
        write_motion(motion, robot, fresh)
    return path


def write_motion(trajectory: Sampled, robot: Robot, path: Path, *, rate: int = RATE) -> None:
    """Writes a trajectory, sampled at a rate [Hz]; the suffix names the format.

    npz holds `times` [s], `names`, `angles` [rad], `speeds` [rad/s] and `accelerations` [rad/s^2]; csv holds time and
    angles; bap is the MPEG-4 text format at 25 frames/s.

    Raises:
        ConfigError: the suffix is not known.
    """
    check_motion_file(path)
    if path.suffix == ".bap":
        write_bap(trajectory, robot, path)
        return
    times = np.arange(int(np.ceil(trajectory.duration * rate)) + 1) / rate
    angles, speeds, accelerations = trajectory.sample(times)
    names = robot.skeleton.names
    if path.suffix == ".npz":
        np.savez_compressed(
            path, times=times, names=np.array(names), angles=angles, speeds=speeds, accelerations=accelerations
        )
    else:
        with path.open("w", newline="", encoding="utf-8") as file:
            rows = csv.writer(file)
            rows.writerow(["time_s", *(f"{name}_rad" for name in names)])
            rows.writerows([f"{value:.9g}" for value in (time, *row)] for time, row in zip(times, angles, strict=True))


def check_motion_file(path: Path, *, also: str = "") -> None:
    """Refuses a path whose suffix names no format of motions.

    Args:
        path: of the file.
        also: a suffix that somebody else writes.

    Raises:
        ConfigError: it does not; names those that do.
    """
    known = (*SUFFIXES, also) if also else SUFFIXES
    if path.suffix not in known:
        raise ConfigError(f"{path}: cannot write {path.suffix or 'no suffix'}; known: {', '.join(known)}")
