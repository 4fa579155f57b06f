"""Reader of SmartBody skeletons (.sk) and motions (.skm), with forward kinematics."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError

CHANNEL_WIDTHS: Mapping[str, int] = {"XPos": 1, "YPos": 1, "ZPos": 1, "Quat": 3}  # kind of channel -> numbers per frame
SYNC_NAMES: Mapping[str, str] = {  # BML sync points by the time's name in a motion file
    "ready": "ready",
    "strokeStart": "strokeStart",
    "emphasis": "stroke",
    "stroke": "strokeEnd",
    "relax": "relax",
}
MAX_FILE_SIZE = 64_000_000  # [bytes] largest accepted SmartBody file

_NUMBER_PATTERN = r"\s+([-+\d.eE]+)"
_JOINT_PATTERN = re.compile(
    rf"(?P<end>\}})|(?:root|joint)\s+(?P<name>\S+)\s*\{{\s*offset{3 * _NUMBER_PATTERN}"
    rf"(?:\s+prerot\s+axis{3 * _NUMBER_PATTERN}\s+ang{_NUMBER_PATTERN})?"
)
_CHANNELS_PATTERN = re.compile(r"^channels\s+(\d+)\s*$", re.MULTILINE)
_FRAME_PATTERN = re.compile(r"^kt\s+(\S+)\s+fr\s+(.*)$", re.MULTILINE)
_TIME_PATTERN = re.compile(r"^(\w+) time:\s*(\S+)", re.MULTILINE)


@dataclass(frozen=True, eq=False)
class CapturedJoint:
    """One joint of a SmartBody skeleton before any motion."""

    name: str
    parent: str | None
    offset: Floats  # (3,) [m] from the parent, in the parent's axes
    turn: Floats  # (3,) [rad] rotation vector applied before that of the motion


@dataclass(frozen=True, eq=False)
class CapturedMotion:
    """Captured motion of one actor."""

    times: Floats  # (m,) [s]
    columns: Mapping[tuple[str, str], slice]  # columns of the frames, by joint and kind of channel
    frames: Floats  # (m, k) translations [m] and rotation vectors [rad]
    syncs: Mapping[str, float]  # [s] BML sync points


def read_skeleton(path: Path) -> tuple[CapturedJoint, ...]:
    """Read the joints of an actor, parents first.

    Raises:
        ConfigError: the file is missing or not a skeleton.
    """
    joints: list[CapturedJoint] = []
    ancestors: list[str] = []
    for match in _JOINT_PATTERN.finditer(re.sub(r"#.*", "", _read(path))):
        if match["end"]:
            ancestors = ancestors[:-1]
            continue
        numbers = _parse_numbers(match.groups(default="0")[2:], path)
        turn = np.radians(numbers[6]) * numbers[3:6]  # the axis is a unit vector or zero
        joints.append(CapturedJoint(match["name"], ancestors[-1] if ancestors else None, numbers[:3], sealed(turn)))
        ancestors.append(match["name"])
    if not joints:
        raise ConfigError(f"{path}: not a skeleton: it has no joints")
    return tuple(joints)


def read_motion(path: Path) -> CapturedMotion:
    """Read a SmartBody motion file (.skm).

    Raises:
        ConfigError: the file is missing or not a motion.
    """
    text = _read(path)
    head, frames = _CHANNELS_PATTERN.search(text), _FRAME_PATTERN.findall(text)
    if head is None or len(frames) < 2:
        raise ConfigError(f"{path}: not a motion: it needs channels and at least two frames")
    columns, width = {}, 0
    for line in text[head.end() :].split("\n")[1 : int(head[1]) + 1]:
        name, _, kind = line.strip().partition(" ")
        if kind not in CHANNEL_WIDTHS:
            raise ConfigError(
                f"{path}: channel {line.strip()!r}; it must be a joint and one of {', '.join(CHANNEL_WIDTHS)}"
            )
        columns[name, kind] = slice(width, width := width + CHANNEL_WIDTHS[kind])
    rows = [_parse_numbers(row.split(), path) for _, row in frames]
    if {len(row) for row in rows} != {width}:
        raise ConfigError(f"{path}: its channels require {width} numbers in each frame")
    times = _parse_numbers([time for time, _ in frames], path)
    if (np.diff(times) <= 0.0).any():
        raise ConfigError(f"{path}: its frames are not in order of time")
    syncs = {
        SYNC_NAMES[name]: float(_parse_numbers([time], path)[0])
        for name, time in _TIME_PATTERN.findall(text)
        if name in SYNC_NAMES
    }
    return CapturedMotion(times, columns, sealed(rows), syncs)


@dataclass(frozen=True, eq=False)
class JointFrames:
    """Positions and rotations of all joints in every captured frame, y up."""

    positions: Mapping[str, Floats]  # (m, 3) in the unit of the skeleton
    rotations: Mapping[str, Floats]  # (m, 3, 3) from joint axes to the world


def joint_positions(skeleton: Sequence[CapturedJoint], motion: CapturedMotion) -> Mapping[str, Floats]:
    """Return joint positions (m, 3) [m] in every captured frame, y up."""
    return joint_frames(skeleton, motion).positions


def joint_frames(skeleton: Sequence[CapturedJoint], motion: CapturedMotion) -> JointFrames:
    """Return positions and rotations of joints in every captured frame, y up.

    A joint rotates by its own rotation and then by the motion's; its child lies at an offset in the rotated axes.
    """
    zeros = np.zeros((len(motion.frames), 3))
    positions: dict[str, Floats] = {}
    rotations: dict[str | None, Rotation] = {None: Rotation.from_rotvec(zeros)}
    for joint in skeleton:
        offset = zeros + joint.offset
        for axis, kind in enumerate(("XPos", "YPos", "ZPos")):
            if (joint.name, kind) in motion.columns:
                offset[:, axis] += motion.frames[:, motion.columns[joint.name, kind]][:, 0]
        vectors = (
            motion.frames[:, motion.columns[joint.name, "Quat"]] if (joint.name, "Quat") in motion.columns else zeros
        )
        base = positions[joint.parent] if joint.parent else zeros
        positions[joint.name] = sealed(base + rotations[joint.parent].apply(offset))
        rotations[joint.name] = rotations[joint.parent] * _make_rotation(joint.turn) * _make_rotation(vectors)
    matrices = {name: sealed(rotation.as_matrix()) for name, rotation in rotations.items() if name}
    return JointFrames(positions, matrices)


def _make_rotation(vectors: Floats) -> Rotation:
    """Convert one or more rotation vectors to SciPy rotations.

    SciPy does not accept read-only arrays.
    """
    return Rotation.from_rotvec(vectors.copy())


def _read(path: Path) -> str:
    try:
        if path.stat().st_size > MAX_FILE_SIZE:
            raise ConfigError(f"{path}: more than {MAX_FILE_SIZE // 1_000_000} MB")
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from None


def _parse_numbers(words: Sequence[str], path: Path) -> Floats:
    """Parse words as finite numbers (k,)."""
    try:
        numbers = sealed([float(word) for word in words])
    except ValueError as error:
        raise ConfigError(f"{path}: {error}") from None
    if not np.isfinite(numbers).all():
        raise ConfigError(f"{path}: a number is not finite")
    return numbers
