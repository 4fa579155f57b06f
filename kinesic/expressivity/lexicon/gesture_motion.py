"""Captured motion of one gesture, and its .npz files.

Axes are those of `HandPose`: forward, outward (to the hand's own side) and up. The origin is that of gesture space, and
the unit is the arm length, so that the motion is independent of the actor's size.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.body.robot import SIDE_NAMES, SIDES, Side
from kinesic.expressivity.lexicon.space import MAX_COORDINATE
from kinesic.files.array_file import Array, numbers_of, unpack_arrays
from kinesic.files.input_file import read_inside

MAX_MOTION_FILE_SIZE = 8_000_000  # [bytes] largest .npz of a gesture, packed and unpacked
MAX_SAMPLES = 6000  # largest number of samples of a gesture's motion
MIN_SAMPLES = 4  # smallest number of samples of a gesture's motion
MAX_UNIT_ERROR = 0.05  # largest accepted deviation of a direction's length from 1
FINGER_COUNT = 5  # number of fingers in the arrays of finger extension


@dataclass(frozen=True, eq=False)
class HandMotion:
    """Captured motion of one hand."""

    wrist: Floats  # (m, 3) [arm lengths] positions in gesture space
    swivel: Floats  # (m,) [rad] elbow rotation about the line shoulder-wrist; 0: hanging, +: outward
    pointing: Floats | None = None  # (m, 3) unit directions from the wrist to the knuckles; None: unknown
    palm: Floats | None = None  # (m, 3) unit normals of the palm; None: unknown
    straight: Floats | None = None  # (m, 5) extension of thumb .. little finger, 0..1; None: unknown


@dataclass(frozen=True, eq=False)
class GestureMotion:
    """Captured motion of hands, head and trunk in one gesture."""

    times: Floats  # (m,) [s] increasing times of the samples, from 0
    hands: Mapping[Side, HandMotion]
    head: Floats  # (m, 3) [rad] rotation vector in the chest frame: to the right, down, to the left
    trunk: Floats  # (m, 3) [rad] rotation vector from the mean orientation: to the right, forward, to the left

    def at(self, time: float) -> int:
        """Return the index of the sample nearest to a time [s]."""
        return int(np.argmin(np.abs(self.times - time)))


def pack_motion(motion: GestureMotion) -> bytes:
    """Return the .npz file of a gesture's motion.

    Numbers are stored in single precision.
    """
    arrays = {"times": motion.times, "head": motion.head, "trunk": motion.trunk}
    for side, hand in motion.hands.items():
        for name in ("wrist", "swivel", "pointing", "palm", "straight"):
            values: Floats | None = getattr(hand, name)
            if values is not None:
                arrays[f"{SIDE_NAMES[side]}_{name}"] = values
    file = BytesIO()
    np.savez_compressed(
        file, allow_pickle=False, **{name: values.astype(np.float32) for name, values in arrays.items()}
    )
    return file.getvalue()


def read_gesture_motion(folder: Path, name: str) -> GestureMotion:
    """Read a gesture's motion from an .npz file inside a folder.

    Raises:
        ConfigError: the file is missing, outside the folder, damaged or too large, or its arrays are invalid.
    """
    path = folder / name
    try:
        data = read_inside(folder, path, max_size=MAX_MOTION_FILE_SIZE)
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror or error}") from None
    except ValueError as error:  # the name contains NUL
        raise ConfigError(f"{folder}: motion {name[:40]!r}: {error}") from None
    try:
        arrays = unpack_arrays(BytesIO(data), str(path), max_size=MAX_MOTION_FILE_SIZE)
        return _unpack(arrays)
    except (OSError, ValueError) as error:
        raise ConfigError(f"{path}: {error}") from None


def _unpack(arrays: Mapping[str, Array]) -> GestureMotion:
    """Convert the arrays of a file to a motion.

    Raises:
        ValueError: an array is missing, or has an invalid shape or value.
    """
    times = numbers_of(arrays, "times", 1).astype(np.float64)
    if not MIN_SAMPLES <= len(times) <= MAX_SAMPLES:
        raise ValueError(f"it has {len(times)} samples; {MIN_SAMPLES} to {MAX_SAMPLES} are read")
    if not (np.isfinite(times).all() and (np.diff(times) > 0.0).all()):
        raise ValueError("times must be finite and increase")
    hands = {
        side: HandMotion(
            wrist=_read_rows(arrays, f"{name}_wrist", len(times), 3, limit=MAX_COORDINATE),
            swivel=_read_rows(arrays, f"{name}_swivel", len(times), 0, limit=2.0 * np.pi),
            pointing=_read_directions(arrays, f"{name}_pointing", len(times)),
            palm=_read_directions(arrays, f"{name}_palm", len(times)),
            straight=_read_rows(arrays, f"{name}_straight", len(times), FINGER_COUNT, limit=1.0)
            if f"{name}_straight" in arrays
            else None,
        )
        for side, name in SIDE_NAMES.items()
        if side in SIDES and f"{name}_wrist" in arrays
    }
    if not hands:
        raise ValueError("it has no array left_wrist or right_wrist")
    head, trunk = (_read_rows(arrays, name, len(times), 3, limit=2.0 * np.pi) for name in ("head", "trunk"))
    return GestureMotion(sealed(times - times[0]), hands, head, trunk)


def _read_rows(arrays: Mapping[str, Array], name: str, count: int, width: int, *, limit: float) -> Floats:
    """Return an array (count, width), or (count,) if width is 0.

    Raises:
        ValueError: the array is missing, or has another shape, or a value beyond the limit.
    """
    values = numbers_of(arrays, name, 2 if width else 1).astype(np.float64)
    shape = (count, width) if width else (count,)
    if values.shape != shape:
        raise ValueError(f"{name} has shape {values.shape}, must have {shape}")
    if not bool((np.abs(values) <= limit).all()):
        raise ValueError(f"{name} has a value beyond {limit:g}")
    return sealed(values)


def _read_directions(arrays: Mapping[str, Array], name: str, count: int) -> Floats | None:
    """Return unit vectors (count, 3), or None if the file has none."""
    if name not in arrays:
        return None
    values = _read_rows(arrays, name, count, 3, limit=1.0 + MAX_UNIT_ERROR)
    lengths = np.linalg.norm(values, axis=1, keepdims=True)
    if float(np.abs(lengths - 1.0).max()) > MAX_UNIT_ERROR:
        raise ValueError(f"{name} has a direction of another length than 1")
    return sealed(values / lengths)
