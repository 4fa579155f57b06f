"""Reader of recorded moves of the Reachy Mini robot (JSON)."""

import msgspec
import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.rotation import rotation_about, rotation_to_vector
from kinesic.capture.clip import BodyClip
from kinesic.capture.reading.text import CaptureError, check_size, check_times

MATRIX_SIZE = 4  # number of rows and of columns of a pose matrix
MAX_ROTATION_ERROR = 0.01  # largest accepted entry of |R^T R - 1| for a rotation matrix R
UP_AXIS = sealed([0.0, 0.0, 1.0])  # axis of the body's yaw


class _Target(msgspec.Struct):
    """One setpoint of a recorded move."""

    head: list[list[float] | float] | None = None  # 4 x 4 pose matrix in the world frame [m], or its 16 numbers by rows
    body_yaw: float | None = None  # [rad] rotation of the body about the vertical axis


class _Move(msgspec.Struct):
    """Times and setpoints of a recorded Reachy Mini move."""

    time: list[float | None]  # [s] time of each setpoint
    set_target_data: list[_Target | None]


def read_reachy_move(data: bytes, source: str) -> BodyClip:
    """Read head rotations relative to the body from a Reachy Mini move.

    Setpoints without a pose are left out. Antennas have no counterpart on other robots.

    Raises:
        CaptureError: the data is no such move.
    """
    check_size(data, source)
    try:
        move = msgspec.json.decode(data, type=_Move)
    except (msgspec.DecodeError, RecursionError, UnicodeDecodeError) as error:
        raise CaptureError(f"{source}: not a move of Reachy Mini: {error}") from None
    if len(move.time) != len(move.set_target_data):
        raise CaptureError(f"{source}: it has {len(move.time)} times and {len(move.set_target_data)} setpoints")
    times, vectors = [], []
    for k, (time, target) in enumerate(zip(move.time, move.set_target_data, strict=True)):
        if time is None or target is None or target.head is None:
            continue
        place = f"{source}: set_target_data[{k}]"
        yaw = rotation_about(UP_AXIS, _finite(target.body_yaw or 0.0, place))
        times.append(_finite(time, place))
        vectors.append(rotation_to_vector(yaw.T @ _rotation_of(target.head, place)))
    check_times(sealed(times), source)
    skipped = len(move.time) - len(times)
    guesses = ("antennas have no counterpart", *((f"{skipped} setpoints without pose left out",) if skipped else ()))
    return BodyClip(sealed(np.array(times) - times[0]), {}, sealed(vectors), {}, guesses)


def _finite(value: float, place: str) -> float:
    if not np.isfinite(value):
        raise CaptureError(f"{place}: a number is not finite")
    return value


def _rotation_of(head: list[list[float] | float], place: str) -> Floats:
    """Return the rotation matrix (3, 3) of a 4 x 4 pose."""
    rows = [row if isinstance(row, list) else [row] for row in head]
    numbers = np.array([value for row in rows for value in row], dtype=np.float64)
    if numbers.size != MATRIX_SIZE**2:
        raise CaptureError(f"{place}: head has {numbers.size} numbers; a pose has 16")
    rotation: Floats = numbers.reshape(MATRIX_SIZE, MATRIX_SIZE)[:3, :3]
    with np.errstate(all="ignore"):
        error = np.abs(rotation.T @ rotation - np.eye(3)).max()
    if not error < MAX_ROTATION_ERROR or np.linalg.det(rotation) < 0.0:
        raise CaptureError(f"{place}: head is no rotation")
    return rotation
