"""Reader and writer of MPEG-4 body animation parameters (ISO/IEC 14496-2 annex C).

A header `version name rate frames`, then two lines per frame: a mask of 296 flags, and the frame number with one
integer for each set flag. A parameter whose flag is not set keeps its value.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Protocol

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot

BAP_SUFFIX = ".bap"  # suffix of MPEG-4 body animation files
FRAME_RATE = 25  # [frames/s] frame rate of written BAP files
PARAMETER_COUNT = 296  # parameters per BAP frame in the standard, with extensions
BASE_PARAMETER_COUNT = 186  # parameters per BAP frame without extensions
UNITS_PER_RADIAN = 1e5  # BAP angle units per radian
FORMAT_VERSION = "3.2"  # BAP version in the header of written files
MAX_FRAME_RATE = 1000.0  # [frames/s] highest accepted frame rate of a BAP file

_LEFT_NUMBERS = (  # hinge and parameter number of the left side; the right side has the next number
    ("sternoclavicular_abduct", 24),
    ("sternoclavicular_rotate", 26),
    ("acromioclavicular_abduct", 28),
    ("acromioclavicular_rotate", 30),
    ("shoulder_flexion", 32),
    ("shoulder_abduct", 34),
    ("shoulder_twisting", 36),
    ("elbow_flexion", 38),
    ("elbow_twisting", 40),
    ("wrist_flexion", 42),
    ("wrist_pivot", 44),
    ("wrist_twisting", 46),
)
_SPINE_BONES = (  # BAP names of skull and vertebrae, from the skull down
    "skullbase",
    *(f"vc{k}" for k in range(1, 8)),
    *(f"vt{k}" for k in range(1, 13)),
    *(f"vl{k}" for k in range(1, 6)),
)

# Number of each parameter, from 1: pairs left then right, then the spine from the skull down (roll, torsion, tilt).
PARAMETER_NUMBERS = (
    {f"l_{name}": number for name, number in _LEFT_NUMBERS}
    | {f"r_{name}": number + 1 for name, number in _LEFT_NUMBERS}
    | {
        f"{bone}_{turn}": 48 + 3 * k + j
        for k, bone in enumerate(_SPINE_BONES)
        for j, turn in enumerate(("roll", "torsion", "tilt"))
    }
)

# Axis of a positive angle, in the robot's axes (x forward, y left, z up) with the arms hanging. Both sides have the
# same axes, so that mirror images differ in sign unless the axis is lateral.
_ROTATION_AXES: Mapping[str, tuple[float, float, float]] = {
    "wrist_flexion": (-1.0, 0.0, 0.0),
    "flexion": (0.0, -1.0, 0.0),
    "pivot": (0.0, -1.0, 0.0),
    "tilt": (0.0, -1.0, 0.0),
    "twisting": (0.0, 0.0, -1.0),
    "torsion": (0.0, 0.0, 1.0),
    "rotate": (0.0, 0.0, 1.0),
    "abduct": (1.0, 0.0, 0.0),
    "roll": (1.0, 0.0, 0.0),
}


class Sampled(Protocol):
    """Planned or measured motion as a function of time."""

    @property
    def duration(self) -> float:
        """Duration of the motion [s]."""

    def sample(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Return angles [rad], velocities and accelerations, each (m, n), at times [s]."""


@dataclass(frozen=True, eq=False)
class BapFrames:
    """Motion of a BAP file for the hinges of one robot."""

    times: Floats  # (m,) [s] from the start of the file
    angles: Floats  # (m, n) [rad] in joint order, with the signs of the robot; not clipped to its ranges
    given: tuple[str, ...]  # hinges with a parameter in the file; other hinges stay at rest
    strangers: tuple[int, ...]  # numbers of parameters without a hinge of the robot


@dataclass(frozen=True)
class _Column:
    """BAP parameter and the hinge that it drives."""

    number: int
    hinge: int
    sign: float


@lru_cache(maxsize=8)
def _columns(robot: Robot) -> tuple[_Column, ...]:
    parameters = []
    for k, hinge in enumerate(robot.skeleton.hinges):
        if hinge.name in PARAMETER_NUMBERS:
            axis = next(axis for kind, axis in _ROTATION_AXES.items() if hinge.name.endswith(kind))
            parameters.append(
                _Column(PARAMETER_NUMBERS[hinge.name], k, -1.0 if float(np.dot(hinge.axis, axis)) < 0.0 else 1.0)
            )
    return tuple(sorted(parameters, key=lambda column: column.number))


def write_bap(trajectory: Sampled, robot: Robot, path: Path, *, called: Path | None = None) -> None:
    """Write a motion as BAP text at 25 frames/s.

    Angles have the signs of the standard. Hinges without a BAP name are left out.

    Args:
        trajectory: planned or measured.
        robot: with the hinges.
        path: of the file.
        called: final path of the file, whose name is in the header; None: `path`.
    """
    columns = _columns(robot)
    numbers = {column.number for column in columns}
    mask = " ".join("1" if number in numbers else "0" for number in range(1, PARAMETER_COUNT + 1))
    count = int(np.ceil(trajectory.duration * FRAME_RATE)) + 1
    angles = trajectory.sample(np.arange(count) / FRAME_RATE)[0]
    signed_angles = angles[:, [column.hinge for column in columns]] * [column.sign for column in columns]
    lines = [f"{make_bap_heading(called or path)}{count}"]
    for frame, row in enumerate(np.rint(signed_angles * UNITS_PER_RADIAN).astype(int).tolist()):
        lines += [mask, " ".join(str(value) for value in (frame, *row))]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def make_bap_heading(path: Path) -> str:
    """Return the BAP file header without its last number, the frame count."""
    return f"{FORMAT_VERSION} {_name(path)} {FRAME_RATE} "


def read_bap(path: Path, robot: Robot) -> BapFrames:
    """Read a BAP file's motion for the robot's hinges.

    Angles are those of the file, exactly. A parameter is at rest until a frame sets it.

    Raises:
        ConfigError: the file is missing or a line is invalid; the message names the line.
    """
    try:
        lines = path.read_text(encoding="ascii", errors="replace").splitlines()
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from None
    rate, count = _header(path, lines[0] if lines else "")
    columns = {column.number: column for column in _columns(robot)}
    times, rows, row = [], [], robot.skeleton.rest.copy()
    used_parameters: set[int] = set()
    for number, values in _frames(path, lines):
        for parameter, value in values.items():
            if parameter in columns:
                row[columns[parameter].hinge] = columns[parameter].sign * value / UNITS_PER_RADIAN
        used_parameters |= values.keys()
        times.append(number / rate)
        rows.append(row.copy())
    if len(rows) < max(1, count):
        raise ConfigError(f"{path}:{len(lines)}: ends after {len(rows)} of {max(1, count)} frames")
    given_hinges = tuple(
        robot.skeleton.names[columns[number].hinge] for number in sorted(used_parameters & columns.keys())
    )
    return BapFrames(sealed(times), sealed(rows), given_hinges, tuple(sorted(used_parameters - columns.keys())))


def _name(path: Path) -> str:
    """Convert a path's stem to a motion name of one ASCII word."""
    word = "".join(letter if letter.isascii() and letter.isprintable() else "_" for letter in path.stem)
    return "_".join(word.split()) or "motion"


def _header(path: Path, line: str) -> tuple[float, int]:
    """Parse the frame rate and frame count of a BAP file.

    The name between may have blanks.
    """
    words = line.split()
    try:
        rate, count = float(words[-2]), int(words[-1])
    except (ValueError, IndexError):
        raise ConfigError(
            f"{path}:1: {line[:40]!r} is no header; write VERSION NAME RATE FRAMES: 3.2 wave 25 100"
        ) from None
    if not 0.0 < rate <= MAX_FRAME_RATE:
        raise ConfigError(f"{path}:1: {words[-2]} frames/s; must be above 0 and at most {MAX_FRAME_RATE:g}, such as 25")
    return rate, count


def _frames(path: Path, lines: Sequence[str]) -> Iterator[tuple[int, dict[int, int]]]:
    """Yield frame numbers with the parameters that each frame sets.

    Raises:
        ConfigError: a line is invalid; the message names it.
    """
    last = -1
    numbered = [(number, line) for number, line in enumerate(lines[1:], start=2) if line.strip()]
    for (at, mask), (below, values) in zip(numbered[::2], numbered[1::2], strict=False):
        flags = mask.split()
        if len(flags) not in (BASE_PARAMETER_COUNT, PARAMETER_COUNT) or not set(flags) <= {"0", "1"}:
            raise ConfigError(
                f"{path}:{at}: a mask of {len(flags)} words; must be {PARAMETER_COUNT} flags, each 0 or 1"
            )
        set_numbers = [number for number, flag in enumerate(flags, start=1) if flag == "1"]
        try:
            frame, *parameters = (int(word) for word in values.split())
        except ValueError:
            raise ConfigError(f"{path}:{below}: only whole numbers may stand here (angles in 1e-5 rad)") from None
        if len(parameters) != len(set_numbers):
            raise ConfigError(
                f"{path}:{below}: {len(parameters)} values for {len(set_numbers)} parameters of the mask above"
            )
        if frame <= last:
            raise ConfigError(f"{path}:{below}: frame {frame} after frame {last}; numbers must increase, from 0")
        last = frame
        yield frame, dict(zip(set_numbers, parameters, strict=True))
    if len(numbered) % 2:
        raise ConfigError(f"{path}:{numbered[-1][0]}: a mask without a frame below it")
