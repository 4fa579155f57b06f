"""Writes a motion to a file: npz and csv of the reference, or MPEG-4 body animation parameters."""

import csv
from pathlib import Path
from zipfile import BadZipFile, ZipFile

import numpy as np

from kinesic.body.command import RATE
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.files.output_file import new_file
from kinesic.planning.bap import Sampled, bap_heading, write_bap

SUFFIXES = (".npz", ".csv", ".bap")
ARRAYS = ("times", "names", "angles", "speeds", "accelerations")  # of npz
COLUMN = "time_s"  # first of csv
HEADER = 512  # [bytes] in which a file says what it is


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
        write_motion(motion, robot, fresh, called=path)
    return path


def replace_motion(motion: Sampled, robot: Robot, path: Path, *, force: bool) -> Path:
    """Writes a motion as `save_motion` does; one that was written so before is replaced without being forced.

    Raises:
        ConfigError: as `save_motion`; what is there and no such motion is somebody's.
    """
    check_motion_file(path)
    may_replace = force or is_own_motion(path)
    if not may_replace and path.is_file() and not path.is_symlink():
        raise ConfigError(f"{path} is there, and no motion that kinesic wrote; force=True replaces it, or name another")
    return save_motion(motion, robot, path, force=may_replace)


def is_own_motion(path: Path) -> bool:
    """Says whether a file begins as `write_motion` writes one of its suffix."""
    if not path.is_file():
        return False
    try:
        if path.suffix == ".npz":
            with ZipFile(path) as file:
                return sorted(file.namelist()) == sorted(f"{name}.npy" for name in ARRAYS)
        with path.open("rb") as file:
            head = file.read(HEADER).decode("utf-8", "replace")
    except (OSError, BadZipFile):
        return False
    return head.startswith(COLUMN if path.suffix == ".csv" else bap_heading(path))


def write_motion(
    trajectory: Sampled, robot: Robot, path: Path, *, rate: int = RATE, called: Path | None = None
) -> None:
    """Writes a trajectory, sampled at a rate [Hz]; the suffix names the format.

    npz holds `times` [s], `names`, `angles` [rad], `speeds` [rad/s] and `accelerations` [rad/s^2]; csv holds time and
    angles; bap is the MPEG-4 text format at 25 frames/s.

    Args:
        trajectory: planned or measured.
        robot: whose it is.
        path: of the file.
        rate: [Hz] of npz and csv.
        called: the path that it will have; bap has its name inside.

    Raises:
        ConfigError: the suffix is not known.
    """
    check_motion_file(path)
    if path.suffix == ".bap":
        write_bap(trajectory, robot, path, called=called)
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
            rows.writerow([COLUMN, *(f"{name}_rad" for name in names)])
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
