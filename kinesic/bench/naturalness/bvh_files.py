"""Reader of BVH motion files into the types of `smartbody_files`."""

import re
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from kinesic.bench.naturalness.smartbody_files import (
    MAX_FILE_SIZE,
    CapturedJoint,
    CapturedMotion,
    joint_frames,
)
from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError

NO_ROTATION = sealed(np.zeros(3))  # (3,) [rad] rotation vector of a BVH joint before the motion
MAX_FIRST_STEP = np.radians(30.0)  # [rad] joint rotation after the first frame, above which this frame is a T-pose

_FRAME_BLOCK = re.compile(r"MOTION\s+Frames:\s*\d+\s+Frame Time:\s*(\S+)\s*\n(.*)", re.DOTALL)
_HIERARCHY_WORD = re.compile(r"End\s+Site|[{}]|[^\s{}]+")

Channels = tuple[tuple[str, str], ...]  # joint and channel of every column, as `Zrotation`


def read_bvh_skeleton(path: Path) -> tuple[CapturedJoint, ...]:
    """Read the joints of a BVH file, parents first.

    Raises:
        ConfigError: the file is missing or not BVH.
    """
    return _parse_hierarchy(_read_text(path), path)[0]


def read_bvh(path: Path) -> tuple[tuple[CapturedJoint, ...], CapturedMotion]:
    """Read joints and motion of a BVH file.

    The number of rows counts, not the number of frames in the header. A T-pose before the motion is dropped.

    Raises:
        ConfigError: the file is missing or not BVH.
    """
    text = _read_text(path)
    joints, channels = _parse_hierarchy(text, path)
    match = _FRAME_BLOCK.search(text)
    if match is None:
        raise ConfigError(f"{path}: not a BVH file: it needs MOTION, Frames and Frame Time")
    try:
        period = float(match[1])
        numbers = np.array(match[2].split(), dtype=np.float64)
    except ValueError as error:
        raise ConfigError(f"{path}: {error}") from None
    rows = numbers[: len(numbers) - len(numbers) % len(channels)].reshape(-1, len(channels))
    if len(rows) < 2 or period <= 0.0 or not np.isfinite(rows).all():
        raise ConfigError(f"{path}: it needs at least two frames of finite numbers and a positive frame time")
    motion = _make_motion(joints, channels, rows, period)
    return joints, _drop_first_frame(motion) if _starts_in_other_pose(joints, motion) else motion


def _make_motion(joints: Sequence[CapturedJoint], channels: Channels, rows: Floats, period: float) -> CapturedMotion:
    columns: dict[tuple[str, str], slice] = {}
    blocks: list[Floats] = []
    width = 0
    for joint in joints:
        own = [(k, kind) for k, (name, kind) in enumerate(channels) if name == joint.name]
        turns = [(k, kind[0]) for k, kind in own if kind.endswith("rotation")]
        if turns:
            order = "".join(axis for _, axis in turns)
            rotation = Rotation.from_euler(order, rows[:, [k for k, _ in turns]], degrees=True)
            blocks.append(rotation.as_rotvec())
            columns[joint.name, "Quat"] = slice(width, width := width + 3)
        if joint.parent is None:
            for k, kind in own:
                if kind.endswith("position"):
                    blocks.append(rows[:, [k]])
                    columns[joint.name, f"{kind[0]}Pos"] = slice(width, width := width + 1)
    return CapturedMotion(sealed(period * np.arange(len(rows))), columns, sealed(np.concatenate(blocks, axis=1)), {})


def _starts_in_other_pose(joints: Sequence[CapturedJoint], motion: CapturedMotion) -> bool:
    """Return whether the first frame shows a T-pose before the motion.

    A joint then rotates by more than `MAX_FIRST_STEP` to the second frame.
    """
    start = CapturedMotion(motion.times[:2], motion.columns, motion.frames[:2], {})
    for rotations in joint_frames(joints, start).rotations.values():
        cosine = (float(np.trace(rotations[0].T @ rotations[1])) - 1.0) / 2.0
        if np.arccos(np.clip(cosine, -1.0, 1.0)) > MAX_FIRST_STEP:
            return True
    return False


def _drop_first_frame(motion: CapturedMotion) -> CapturedMotion:
    times = sealed(motion.times[1:] - motion.times[1])
    return CapturedMotion(times, motion.columns, sealed(motion.frames[1:]), motion.syncs)


def _parse_hierarchy(text: str, path: Path) -> tuple[tuple[CapturedJoint, ...], Channels]:
    joints: list[CapturedJoint] = []
    channels: list[tuple[str, str]] = []
    ancestors: list[str | None] = []
    words = list(_HIERARCHY_WORD.findall(text.partition("MOTION")[0]))
    name: str | None = None
    for k, word in _commands(words):
        if word in ("ROOT", "JOINT"):
            name = words[k + 1]
        elif word.startswith("End"):
            name = None
        elif word == "{":
            ancestors.append(name)
        elif word == "}" and ancestors:
            ancestors.pop()
        elif word == "OFFSET" and name is not None and ancestors:
            offset = _parse_numbers(words[k + 1 : k + 4], path)
            parent = ancestors[-2] if len(ancestors) > 1 else None
            joints.append(CapturedJoint(name, parent, offset, NO_ROTATION))
        elif word == "CHANNELS" and name is not None:
            channels += [(name, kind) for kind in words[k + 2 : k + 2 + int(words[k + 1])]]
    if not joints or not channels:
        raise ConfigError(f"{path}: not a BVH file: it has no joints or no channels")
    return tuple(joints), tuple(channels)


def _commands(words: Sequence[str]) -> Iterator[tuple[int, str]]:
    """Yield all words of a BVH file except joint names, with indices."""
    yield from ((0, word) for word in words[:1])
    for k, (before, word) in enumerate(pairwise(words), start=1):
        if before not in ("ROOT", "JOINT"):
            yield k, word


def _parse_numbers(words: Sequence[str], path: Path) -> Floats:
    try:
        numbers = sealed([float(word) for word in words])
    except ValueError as error:
        raise ConfigError(f"{path}: {error}") from None
    if numbers.shape != (3,) or not np.isfinite(numbers).all():
        raise ConfigError(f"{path}: an offset needs three finite numbers")
    return numbers


def _read_text(path: Path) -> str:
    try:
        if path.stat().st_size > MAX_FILE_SIZE:
            raise ConfigError(f"{path}: more than {MAX_FILE_SIZE // 1_000_000} MB")
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from None
