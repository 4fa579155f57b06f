"""Reads skeletons (.sk) and motions (.skm) as SmartBody writes them, and finds where joints are in each frame."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError

WIDTHS: Mapping[str, int] = {"XPos": 1, "YPos": 1, "ZPos": 1, "Quat": 3}  # numbers of a channel in a frame
SYNCS: Mapping[str, str] = {  # BML's sync points by the names of a motion's times
    "ready": "ready",
    "strokeStart": "strokeStart",
    "emphasis": "stroke",
    "stroke": "strokeEnd",
    "relax": "relax",
}
LARGEST = 64_000_000  # [bytes]

_NUMBER = r"\s+([-+\d.eE]+)"
_JOINT = re.compile(
    rf"(?P<end>\}})|(?:root|joint)\s+(?P<name>\S+)\s*\{{\s*offset{3 * _NUMBER}"
    rf"(?:\s+prerot\s+axis{3 * _NUMBER}\s+ang{_NUMBER})?"
)
_CHANNELS = re.compile(r"^channels\s+(\d+)\s*$", re.MULTILINE)
_FRAME = re.compile(r"^kt\s+(\S+)\s+fr\s+(.*)$", re.MULTILINE)
_TIME = re.compile(r"^(\w+) time:\s*(\S+)", re.MULTILINE)


@dataclass(frozen=True, eq=False)
class CapturedJoint:
    """One joint of an actor, as it is before any motion."""

    name: str
    parent: str | None
    offset: Floats  # (3,) [m] from the parent, in the parent's axes
    turn: Floats  # (3,) [rad] rotation vector, before that of the motion


@dataclass(frozen=True, eq=False)
class CapturedMotion:
    """What an actor did."""

    times: Floats  # (m,) [s]
    columns: Mapping[tuple[str, str], slice]  # of the frames, by joint and kind of channel
    frames: Floats  # (m, k) [m] of shifts, [rad] of rotation vectors
    syncs: Mapping[str, float]  # [s] sync points by their names in BML


def read_skeleton(path: Path) -> tuple[CapturedJoint, ...]:
    """Reads the joints of an actor, parents first.

    Raises:
        ConfigError: the file is missing, or no skeleton.
    """
    joints: list[CapturedJoint] = []
    above: list[str] = []
    for found in _JOINT.finditer(re.sub(r"#.*", "", _read(path))):
        if found["end"]:
            above = above[:-1]
            continue
        numbers = _numbers(found.groups(default="0")[2:], path)
        turn = np.radians(numbers[6]) * numbers[3:6]  # the axis is a unit vector, or zero
        joints.append(CapturedJoint(found["name"], above[-1] if above else None, numbers[:3], sealed(turn)))
        above.append(found["name"])
    if not joints:
        raise ConfigError(f"{path}: no skeleton: it has no joints")
    return tuple(joints)


def read_motion(path: Path) -> CapturedMotion:
    """Reads a motion.

    Raises:
        ConfigError: the file is missing, or no motion.
    """
    text = _read(path)
    head, frames = _CHANNELS.search(text), _FRAME.findall(text)
    if head is None or len(frames) < 2:
        raise ConfigError(f"{path}: no motion: it needs channels and two frames")
    columns, width = {}, 0
    for line in text[head.end() :].split("\n")[1 : int(head[1]) + 1]:
        name, _, kind = line.strip().partition(" ")
        if kind not in WIDTHS:
            raise ConfigError(f"{path}: channel {line.strip()!r}; it must be a joint and one of {', '.join(WIDTHS)}")
        columns[name, kind] = slice(width, width := width + WIDTHS[kind])
    rows = [_numbers(row.split(), path) for _, row in frames]
    if {len(row) for row in rows} != {width}:
        raise ConfigError(f"{path}: its channels ask for {width} numbers in every frame")
    times = _numbers([time for time, _ in frames], path)
    if (np.diff(times) <= 0.0).any():
        raise ConfigError(f"{path}: its frames are not in the order of their times")
    syncs = {SYNCS[name]: float(_numbers([time], path)[0]) for name, time in _TIME.findall(text) if name in SYNCS}
    return CapturedMotion(times, columns, sealed(rows), syncs)


def joint_positions(skeleton: Sequence[CapturedJoint], motion: CapturedMotion) -> Mapping[str, Floats]:
    """Finds the place of every joint in every frame (m, 3) [m]: y up, in the axes of the world.

    A joint turns by its own turn and then by the motion's; the next one lies at its offset in the axes of both.
    """
    still = np.zeros((len(motion.frames), 3))
    places: dict[str, Floats] = {}
    turns: dict[str | None, Rotation] = {None: Rotation.identity()}
    for joint in skeleton:
        shift = still + joint.offset
        for axis, kind in enumerate(("XPos", "YPos", "ZPos")):
            if (joint.name, kind) in motion.columns:
                shift[:, axis] += motion.frames[:, motion.columns[joint.name, kind]][:, 0]
        moved = (
            motion.frames[:, motion.columns[joint.name, "Quat"]] if (joint.name, "Quat") in motion.columns else still
        )
        base = places[joint.parent] if joint.parent else still
        places[joint.name] = sealed(base + turns[joint.parent].apply(shift))
        turns[joint.name] = turns[joint.parent] * _rotation(joint.turn) * _rotation(moved)
    return places


def _rotation(vectors: Floats) -> Rotation:
    """One rotation, or one for each frame; SciPy takes no read-only array."""
    return Rotation.from_rotvec(vectors.copy())


def _read(path: Path) -> str:
    try:
        if path.stat().st_size > LARGEST:
            raise ConfigError(f"{path}: more than {LARGEST // 1_000_000} MB")
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from None


def _numbers(words: Sequence[str], path: Path) -> Floats:
    """(k,) finite numbers."""
    try:
        found = sealed([float(word) for word in words])
    except ValueError as error:
        raise ConfigError(f"{path}: {error}") from None
    if not np.isfinite(found).all():
        raise ConfigError(f"{path}: a number is not finite")
    return found
