"""Readers of tables of joint angles over time (CSV and NPZ)."""

import csv
from collections.abc import Mapping, Sequence
from io import BytesIO

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.capture.clip import JointClip
from kinesic.capture.reading.text import (
    MAX_FILE_SIZE,
    MAX_JOINTS,
    CaptureError,
    check_numbers,
    check_times,
    parse_numbers,
    split_lines,
)
from kinesic.files.array_file import Array, numbers_of, text_of, unpack_arrays
from kinesic.planning.files.motion_files import NPZ_ARRAYS

TIME_NAMES = ("time_s", "time", "t", "timestamp", "times")  # accepted names of the column of times [s]
NAME_ARRAYS = ("names", "joint_names")  # accepted names of the npz array with joint names
ANGLE_ARRAYS = ("angles", "positions", "joint_positions", "q")  # accepted names of the npz array with angles
RATE_ARRAYS = ("fps", "frame_rate", "rate")  # accepted names of the npz array with the frame rate [Hz]
UNIT_SUFFIXES: Mapping[str, float] = {  # factor to radians by the end of a column's name
    "_rad": 1.0,
    " [rad]": 1.0,
    " (rad)": 1.0,
    "_deg": np.pi / 180.0,
    " [deg]": np.pi / 180.0,
    " (deg)": np.pi / 180.0,
}
COLUMN_DELIMITERS = ",;\t"  # characters that may separate columns
MAX_RADIANS = 2.0 * np.pi  # [rad] any larger angle makes all columns without unit count as degrees


def read_joint_csv(data: bytes, source: str) -> JointClip:
    """Read joint angles from CSV with a header.

    One column is the time [s]; the others are joints, with a unit at the end of the name such as `_deg`. Without a
    unit, angles beyond 2 pi count as degrees.

    Raises:
        CaptureError: the data is not such a table.
    """
    lines = split_lines(data, source)
    delimiter = max(COLUMN_DELIMITERS, key=lines[0].count)
    try:
        header = [name.strip() for name in next(csv.reader(lines[:1], delimiter=delimiter), [])]
    except csv.Error as error:
        raise CaptureError(f"{source}:1: {error}") from None
    column = next((header.index(name) for name in TIME_NAMES if name in header), None)
    if column is None or not 2 <= len(header) <= MAX_JOINTS:
        raise CaptureError(f"{source}:1: it needs a header with a column {TIME_NAMES[0]!r} and columns of joints")
    rows = []
    for number, line in enumerate(lines[1:], start=2):
        if not line.strip():
            continue
        row = parse_numbers(line.split(delimiter), f"{source}:{number}")
        if len(row) != len(header):
            raise CaptureError(f"{source}:{number}: it has {len(row)} columns, the header {len(header)}")
        rows.append(row)
    table = np.array(rows).reshape(-1, len(header))
    names = [name for k, name in enumerate(header) if k != column]
    return _make_clip(table[:, column], names, np.delete(table, column, axis=1), source)


def read_joint_npz(arrays: Mapping[str, Array], source: str) -> JointClip:
    """Read joint angles from NPZ arrays of times, names and angles.

    A frame rate may replace the times.

    Raises:
        CaptureError: there are no such arrays.
    """
    try:
        names = [str(name) for name in text_of(arrays, _choose(arrays, NAME_ARRAYS), 1)]
        angles = numbers_of(arrays, _choose(arrays, ANGLE_ARRAYS), 2).astype(np.float64)
        time_array = next((name for name in TIME_NAMES if name in arrays), None)
        if time_array is not None:
            times = numbers_of(arrays, time_array, 1).astype(np.float64)
        else:
            rate = float(numbers_of(arrays, _choose(arrays, RATE_ARRAYS), 0))
            times = np.arange(len(angles)) / rate if rate > 0.0 else np.zeros(0)
    except ValueError as error:
        raise CaptureError(f"{source}: {error}") from None
    if angles.shape != (len(times), len(names)):
        raise CaptureError(f"{source}: angles have shape {angles.shape} for {len(times)} times and {len(names)} names")
    check_numbers(angles, f"{source}: angles")
    check_numbers(times, f"{source}: times")
    has_radians = set(NPZ_ARRAYS) <= arrays.keys()  # exported by kinesic
    return _make_clip(times, [f"{name}_rad" for name in names] if has_radians else names, angles, source)


def read_npz(data: bytes, source: str) -> Mapping[str, Array]:
    """Unpack the arrays of an NPZ file.

    Raises:
        CaptureError: the data is damaged or too large.
    """
    try:
        return unpack_arrays(BytesIO(data), source, max_size=MAX_FILE_SIZE)
    except ConfigError as error:
        raise CaptureError(str(error)) from None
    except OSError as error:
        raise CaptureError(f"{source}: {error}") from None


def _choose(arrays: Mapping[str, Array], names: Sequence[str]) -> str:
    return next((name for name in names if name in arrays), names[0])


def _make_clip(times: Floats, columns: Sequence[str], values: Floats, source: str) -> JointClip:
    check_times(times, source)
    suffixes = [next((suffix for suffix in UNIT_SUFFIXES if name.endswith(suffix)), "") for name in columns]
    names = tuple(name.removesuffix(suffix) for name, suffix in zip(columns, suffixes, strict=True))
    if len(set(names)) < len(names):
        raise CaptureError(f"{source}: two columns have the same joint")
    factors = np.array([UNIT_SUFFIXES.get(suffix, 1.0) for suffix in suffixes])
    has_no_unit = np.array([not suffix for suffix in suffixes])
    guesses: tuple[str, ...] = ()
    if has_no_unit.any():
        is_degrees = bool(np.abs(values[:, has_no_unit]).max() > MAX_RADIANS)
        factors[has_no_unit] = np.pi / 180.0 if is_degrees else 1.0
        guesses = (f"columns without unit read as {'degrees' if is_degrees else 'radians'}",)
    return JointClip(sealed(times - times[0]), names, sealed(values * factors), guesses)
