"""Reader of episodes of LeRobot datasets (version 3, .parquet)."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from kinesic.body.arrays import sealed
from kinesic.capture.clip import JointClip
from kinesic.capture.reading.text import (
    MAX_JOINTS,
    CaptureError,
    check_numbers,
    check_regular,
    check_times,
    read_file,
)
from kinesic.extras import install_extra

if TYPE_CHECKING:
    from duckdb import DuckDBPyConnection

DESCRIPTION_PATH = ("meta", "info.json")  # folder and name of a dataset's description, below the dataset
FOLDERS_BELOW = 3  # number of levels from the dataset down to its data files
POSITION_FEATURES = ("action", "observation.state")  # columns with joint positions, the preferred first
POSITION_SUFFIX = ".pos"  # suffix of the names of joint positions
MAX_VALUES = 2_000_000  # largest number of frames x joints
MEMORY_LIMIT = "400MB"  # largest memory of a query
DEGREE_ROBOTS = "kinesic_"  # beginning of robot types whose positions are in degrees, as kinesic exports them
MAX_RADIANS = 2.0 * np.pi  # [rad] any larger value makes all positions count as degrees


class _Feature(msgspec.Struct):
    """Column of a dataset."""

    names: list[str] | dict[str, list[str]] | None = None


class _Dataset(msgspec.Struct):
    """Content of a dataset's description file."""

    features: dict[str, _Feature]
    robot_type: str | None = None


def read_lerobot(path: Path) -> JointClip:
    """Read the first episode of a data file of a LeRobot dataset.

    Actions are preferred to measured states. The unit is not in the file: values beyond 2 pi count as degrees, and all
    values that kinesic has exported are degrees.

    Raises:
        CaptureError: DuckDB is missing, the file or its dataset's description is invalid, or no column has joints.
    """
    try:
        import duckdb  # noqa: PLC0415 - an extra
    except ModuleNotFoundError:
        raise CaptureError(f"{path}: .parquet needs DuckDB: {install_extra('store')}") from None
    feature, names, is_exported = _find_joints(path)
    check_regular(path)
    settings: dict[str, str | bool | int | float | list[str]] = {
        "threads": "1",
        "memory_limit": MEMORY_LIMIT,
        "autoinstall_known_extensions": "false",
    }
    try:
        with duckdb.connect(config=settings) as connection:
            episode, episodes, rows = _query(connection, path, feature, len(names))
    except (duckdb.Error, UnicodeDecodeError) as error:
        reason, *_ = str(error).splitlines() or ["it is damaged"]  # some errors of DuckDB have no text
        raise CaptureError(f"{path}: {reason}") from None
    if len(rows) * len(names) > MAX_VALUES:
        raise CaptureError(f"{path}: episode {episode} has more than {MAX_VALUES} values; cut it")
    if any(time is None or values is None or len(values) != len(names) or None in values for time, values in rows):
        raise CaptureError(f"{path}: each row needs a timestamp and {len(names)} values of {feature}")
    times = check_numbers(np.array([time for time, _ in rows], dtype=np.float64), f"{path}: timestamp")
    check_times(times, str(path))
    values = check_numbers(np.array([values for _, values in rows], dtype=np.float64), f"{path}: {feature}")
    in_degrees = is_exported or bool(np.abs(values).max() > MAX_RADIANS)
    unit_guess = f"{feature} read as {'degrees' if in_degrees else 'radians'}; the dataset does not state its unit"
    guesses = (
        *([f"episode {episode}, the first of {episodes}"] if episodes > 1 else []),
        *([] if is_exported else [unit_guess]),
    )
    return JointClip(sealed(times - times[0]), names, sealed(np.radians(values) if in_degrees else values), guesses)


def _find_joints(path: Path) -> tuple[str, tuple[str, ...], bool]:
    """Find the position column and the joint names.

    The third value is whether kinesic wrote the dataset.

    Raises:
        CaptureError: the dataset has no description, or no such column.
    """
    description = (
        path.absolute().parents[min(FOLDERS_BELOW, len(path.absolute().parents)) - 1].joinpath(*DESCRIPTION_PATH)
    )
    try:
        dataset = msgspec.json.decode(read_file(description), type=_Dataset)
    except (msgspec.DecodeError, RecursionError, UnicodeDecodeError) as error:
        raise CaptureError(f"{description}: not the description of a LeRobot dataset: {error}") from None
    for name in POSITION_FEATURES:
        joints = _joint_names(dataset.features, name)
        if joints:
            return name, joints, (dataset.robot_type or "").startswith(DEGREE_ROBOTS)
    raise CaptureError(f"{description}: it names the joints of neither {' nor '.join(POSITION_FEATURES)}")


def _joint_names(features: Mapping[str, _Feature], name: str) -> tuple[str, ...]:
    """Return the joint names of a column without suffixes, or ()."""
    listed = features[name].names if name in features else None
    if isinstance(listed, dict):
        listed = [joint for part in listed.values() for joint in part]
    joints = tuple(joint.removesuffix(POSITION_SUFFIX) for joint in listed or ())
    return joints if len(set(joints)) == len(joints) <= MAX_JOINTS else ()


def _query(
    connection: "DuckDBPyConnection", path: Path, feature: str, width: int
) -> tuple[int, int, Sequence[tuple[float | None, Sequence[float | None] | None]]]:
    """Return the first episode's index, the episode count, and times with values.

    One value more than the width is read of each row, and one row more than `MAX_VALUES` allow.
    """
    connection.execute("SET enable_progress_bar_print = false")  # it would mix with printed notes
    found = connection.execute(
        "SELECT min(episode_index)::BIGINT, count(DISTINCT episode_index)::BIGINT FROM read_parquet(?)", [str(path)]
    ).fetchone()
    if found is None or found[0] is None:
        raise CaptureError(f"{path}: it has no episode")
    rows = connection.execute(
        f'SELECT "timestamp"::DOUBLE, list_slice("{feature}"::DOUBLE[], 1, ?) FROM read_parquet(?) '
        "WHERE episode_index = ? ORDER BY frame_index LIMIT ?",
        [width + 1, str(path), found[0], MAX_VALUES // width + 1],
    ).fetchall()
    return int(found[0]), int(found[1]), rows
