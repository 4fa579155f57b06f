"""Writing of motions to npz, csv, BAP, BVH and ROS trajectory files.

All but BAP and BVH have the joint names, signs and zeros of the robot's own file.
"""

import csv
from pathlib import Path
from zipfile import BadZipFile, ZipFile

import numpy as np

from kinesic.body.command import COMMAND_RATE
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.files.output_file import new_file
from kinesic.planning.files.bap import Sampled, make_bap_heading, write_bap
from kinesic.planning.files.bvh_writer import write_bvh
from kinesic.planning.files.joint_trajectory import SampledJoints, write_trajectory_json, write_trajectory_mcap

MOTION_SUFFIXES = (".npz", ".csv", ".bap", ".bvh", ".json", ".mcap")  # suffixes of the motion files that can be written
RECOGNISED_SUFFIXES = (".npz", ".csv", ".bap")  # suffixes of files that are recognised as written by kinesic
NPZ_ARRAYS = ("times", "names", "angles", "speeds", "accelerations")  # array names in npz files
TIME_COLUMN = "time_s"  # first column of csv files
HEADER_SIZE = 512  # [bytes] beginning of a file that is read to recognise kinesic's own files


def save_motion(motion: Sampled, robot: Robot, path: Path, *, force: bool) -> Path:
    """Write a motion to a new file and return its path.

    The suffix selects the format. The file appears only when it is complete.

    Args:
        motion: planned or measured.
        robot: with the hinges.
        path: ending in one of `MOTION_SUFFIXES`.
        force: whether to replace an existing file.

    Raises:
        ConfigError: unknown suffix, or the path is a folder, a link or (without `force`) an existing file.
    """
    check_motion_file(path)
    with new_file(path, force=force) as file_path:
        write_motion(motion, robot, file_path, called=path)
    return path


def replace_motion_file(motion: Sampled, robot: Robot, path: Path, *, force: bool) -> Path:
    """Write a motion, refusing to replace foreign files unless forced.

    Raises:
        ConfigError: as for `save_motion`, or another file exists at the path.
    """
    check_motion_file(path)
    may_replace = force or is_own_motion(path)
    if not may_replace and path.is_file() and not path.is_symlink():
        raise ConfigError(f"{path} exists and is no motion written by kinesic; use force=True or another name")
    return save_motion(motion, robot, path, force=may_replace)


def is_own_motion(path: Path) -> bool:
    """Return whether a file looks like a motion file written by kinesic.

    BVH files and joint trajectories of kinesic look like those of other programs.
    """
    if not path.is_file() or path.suffix not in RECOGNISED_SUFFIXES:
        return False
    try:
        if path.suffix == ".npz":
            with ZipFile(path) as file:
                return sorted(file.namelist()) == sorted(f"{name}.npy" for name in NPZ_ARRAYS)
        with path.open("rb") as file:
            heading = file.read(HEADER_SIZE).decode("utf-8", "replace")
    except (OSError, BadZipFile):
        return False
    return heading.startswith(TIME_COLUMN if path.suffix == ".csv" else make_bap_heading(path))


def write_motion(
    trajectory: Sampled, robot: Robot, path: Path, *, rate: int = COMMAND_RATE, called: Path | None = None
) -> None:
    """Write a trajectory in the file format of the path's suffix.

    npz holds `times` [s], `names`, `angles` [rad], `speeds` [rad/s] and `accelerations` [rad/s^2]; csv holds time and
    angles; json and mcap hold a ROS joint trajectory; bvh holds the skeleton and its motion; bap is the MPEG-4 text
    format at 25 frames/s.

    Args:
        trajectory: planned or measured.
        robot: with the hinges.
        path: of the file.
        rate: [Hz] of all formats but bap.
        called: final path of the file, whose name is written in bap; None: `path`.

    Raises:
        ConfigError: unknown suffix.
    """
    check_motion_file(path)
    if path.suffix == ".bap":
        write_bap(trajectory, robot, path, called=called)
        return
    times = np.arange(int(np.ceil(trajectory.duration * rate)) + 1) / rate
    angles, speeds, accelerations = trajectory.sample(times)
    if path.suffix == ".bvh":
        write_bvh(angles, robot, path, rate=rate)
        return
    source = robot.source_joints
    joints = SampledJoints(
        times,
        source.names,
        source.joint_angles(angles),
        source.joint_rates(speeds),
        source.joint_rates(accelerations),
    )
    match path.suffix:
        case ".npz":
            _write_npz(joints, path)
        case ".csv":
            _write_csv(joints, path)
        case ".json":
            write_trajectory_json(joints, path)
        case _:
            write_trajectory_mcap(joints, path)


def _write_npz(joints: SampledJoints, path: Path) -> None:
    np.savez_compressed(
        path,
        times=joints.times,
        names=np.array(joints.names),
        angles=joints.angles,
        speeds=joints.velocities,
        accelerations=joints.accelerations,
    )


def _write_csv(joints: SampledJoints, path: Path) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow([TIME_COLUMN, *(f"{name}_rad" for name in joints.names)])
        table = zip(joints.times, joints.angles, strict=True)
        rows.writerows([f"{value:.9g}" for value in (time, *row)] for time, row in table)


def check_motion_file(path: Path, *, also: str = "") -> None:
    """Raise an error if the path's suffix is no motion format.

    Args:
        path: of the file.
        also: further allowed suffix.

    Raises:
        ConfigError: unknown suffix; the message names the known ones.
    """
    suffixes = (*MOTION_SUFFIXES, also) if also else MOTION_SUFFIXES
    if path.suffix not in suffixes:
        raise ConfigError(f"{path}: cannot write {path.suffix or 'no suffix'}; known: {', '.join(suffixes)}")
