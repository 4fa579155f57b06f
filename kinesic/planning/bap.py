"""Reads and writes MPEG-4 body animation parameters as text (the BAP file format, ISO/IEC 14496-2 annex C).

A header `version name rate frames`, then two lines per frame: a mask of 296 flags, and the frame's number with one
whole number for each flag that is set. A parameter whose flag is not set stays as it was.
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

SUFFIX = ".bap"
FRAME_RATE = 25  # [frames/s]
PARAMETERS = 296
OLDER = 186  # parameters of files without extensions
PER_RADIAN = 1e5  # the unit of angles is 1e-5 rad
VERSION = "3.2"
FASTEST = 1000.0  # [frames/s]

_PAIRS = (
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
_SPINE = (
    "skullbase",
    *(f"vc{k}" for k in range(1, 8)),
    *(f"vt{k}" for k in range(1, 13)),
    *(f"vl{k}" for k in range(1, 6)),
)

# Number of each parameter, from 1: pairs left then right, then the spine from the skull down (roll, torsion, tilt).
NUMBERS = (
    {f"l_{name}": number for name, number in _PAIRS}
    | {f"r_{name}": number + 1 for name, number in _PAIRS}
    | {
        f"{bone}_{turn}": 48 + 3 * k + j
        for k, bone in enumerate(_SPINE)
        for j, turn in enumerate(("roll", "torsion", "tilt"))
    }
)

# What a positive angle turns about, in the robot's axes (x forward, y left, z up) with the arms hanging; both sides
# alike, so that mirror images differ in sign where the axis is not lateral.
_AXES: Mapping[str, tuple[float, float, float]] = {
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
    """A motion as a function of time, planned or measured."""

    @property
    def duration(self) -> float:
        """[s]."""

    def sample(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Angles, speeds and accelerations, each (m, n), at (m,) times."""


@dataclass(frozen=True, eq=False)
class BapFrames:
    """A motion as a BAP file has it, for the hinges of one robot."""

    times: Floats  # (m,) [s] from the start of the file's clock
    angles: Floats  # (m, n) [rad] in joint order, with the robot's signs; beyond its ranges where the file is
    given: tuple[str, ...]  # hinges that the file speaks of, the others rest
    strangers: tuple[int, ...]  # numbers of parameters that no hinge of the robot has


@dataclass(frozen=True)
class _Column:
    """A parameter and the hinge that it turns."""

    number: int
    hinge: int
    sign: float


@lru_cache(maxsize=8)
def _columns(robot: Robot) -> tuple[_Column, ...]:
    found = []
    for k, hinge in enumerate(robot.skeleton.hinges):
        if hinge.name in NUMBERS:
            axis = next(axis for kind, axis in _AXES.items() if hinge.name.endswith(kind))
            found.append(_Column(NUMBERS[hinge.name], k, -1.0 if float(np.dot(hinge.axis, axis)) < 0.0 else 1.0))
    return tuple(sorted(found, key=lambda column: column.number))


def write_bap(trajectory: Sampled, robot: Robot, path: Path, *, called: Path | None = None) -> None:
    """Writes a motion frame by frame, with the signs of the standard; hinges without a BAP name are left out.

    Args:
        trajectory: planned or measured.
        robot: whose it is.
        path: of the file.
        called: the path that it will have, whose name stands in it; None: the same.
    """
    columns = _columns(robot)
    numbers = {column.number for column in columns}
    mask = " ".join("1" if number in numbers else "0" for number in range(1, PARAMETERS + 1))
    count = int(np.ceil(trajectory.duration * FRAME_RATE)) + 1
    angles = trajectory.sample(np.arange(count) / FRAME_RATE)[0]
    turned = angles[:, [column.hinge for column in columns]] * [column.sign for column in columns]
    lines = [f"{bap_heading(called or path)}{count}"]
    for frame, row in enumerate(np.rint(turned * PER_RADIAN).astype(int).tolist()):
        lines += [mask, " ".join(str(value) for value in (frame, *row))]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def bap_heading(path: Path) -> str:
    """Gives what a file of this name begins with, up to the number of its frames."""
    return f"{VERSION} {_name(path)} {FRAME_RATE} "


def read_bap(path: Path, robot: Robot) -> BapFrames:
    """Reads a motion as far as the robot has the hinges for it.

    Angles are those of the file, exactly. A parameter that no frame has set yet is at rest.

    Raises:
        ConfigError: no such file, or a line of it is wrong; named with its number.
    """
    try:
        lines = path.read_text(encoding="ascii", errors="replace").splitlines()
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from None
    rate, count = _header(path, lines[0] if lines else "")
    columns = {column.number: column for column in _columns(robot)}
    times, rows, row = [], [], robot.skeleton.rest.copy()
    seen: set[int] = set()
    for number, values in _frames(path, lines):
        for parameter, value in values.items():
            if parameter in columns:
                row[columns[parameter].hinge] = columns[parameter].sign * value / PER_RADIAN
        seen |= values.keys()
        times.append(number / rate)
        rows.append(row.copy())
    if len(rows) < max(1, count):
        raise ConfigError(f"{path}:{len(lines)}: ends after {len(rows)} of {max(1, count)} frames")
    given = tuple(robot.skeleton.names[columns[number].hinge] for number in sorted(seen & columns.keys()))
    return BapFrames(sealed(times), sealed(rows), given, tuple(sorted(seen - columns.keys())))


def _name(path: Path) -> str:
    """The animation's name: one word of ASCII."""
    word = "".join(letter if letter.isascii() and letter.isprintable() else "_" for letter in path.stem)
    return "_".join(word.split()) or "motion"


def _header(path: Path, line: str) -> tuple[float, int]:
    """Rate [frames/s] and number of frames; the name between may have blanks."""
    words = line.split()
    try:
        rate, count = float(words[-2]), int(words[-1])
    except (ValueError, IndexError):
        raise ConfigError(
            f"{path}:1: {line[:40]!r} is no header; write VERSION NAME RATE FRAMES: 3.2 wave 25 100"
        ) from None
    if not 0.0 < rate <= FASTEST:
        raise ConfigError(f"{path}:1: {words[-2]} frames/s; must be above 0 and at most {FASTEST:g}, such as 25")
    return rate, count


def _frames(path: Path, lines: Sequence[str]) -> Iterator[tuple[int, dict[int, int]]]:
    """Frame numbers, increasing, and what each sets: parameter -> value."""
    last = -1
    numbered = [(number, line) for number, line in enumerate(lines[1:], start=2) if line.strip()]
    for (at, mask), (below, values) in zip(numbered[::2], numbered[1::2], strict=False):
        flags = mask.split()
        if len(flags) not in (OLDER, PARAMETERS) or not set(flags) <= {"0", "1"}:
            raise ConfigError(f"{path}:{at}: a mask of {len(flags)} words; must be {PARAMETERS} flags, each 0 or 1")
        set_here = [number for number, flag in enumerate(flags, start=1) if flag == "1"]
        try:
            frame, *found = (int(word) for word in values.split())
        except ValueError:
            raise ConfigError(f"{path}:{below}: only whole numbers may stand here (angles in 1e-5 rad)") from None
        if len(found) != len(set_here):
            raise ConfigError(f"{path}:{below}: {len(found)} values for {len(set_here)} parameters of the mask above")
        if frame <= last:
            raise ConfigError(f"{path}:{below}: frame {frame} after frame {last}; numbers must increase, from 0")
        last = frame
        yield frame, dict(zip(set_here, found, strict=True))
    if len(numbered) % 2:
        raise ConfigError(f"{path}:{numbered[-1][0]}: a mask without a frame below it")
