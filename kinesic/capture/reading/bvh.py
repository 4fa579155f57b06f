"""Reader of BVH motion files."""

from array import array
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from kinesic.body.arrays import Floats, sealed
from kinesic.capture.reading.text import (
    MAX_FRAMES,
    MAX_JOINTS,
    CaptureError,
    check_times,
    parse_count,
    parse_numbers,
    split_lines,
)
from kinesic.capture.skeleton_motion import CapturedJoint, CapturedMotion, joint_frames

NO_ROTATION = sealed(np.zeros(3))  # (3,) zero vector: rotation [rad] of BVH joints before the motion, default offset
MAX_FIRST_STEP = np.radians(30.0)  # [rad] rotation from the first to the second frame above which the first is a T-pose
CHANNEL_AXES = "XYZ"  # axis letters of channels
CHANNEL_KINDS = frozenset(f"{axis}{kind}" for axis in CHANNEL_AXES for kind in ("position", "rotation"))  # valid names
MAX_CHANNELS = 6  # largest number of channels of a joint

Channels = tuple[tuple[str, str], ...]  # joint and channel of every column, such as `Zrotation`


@dataclass
class _Words:
    """Reader of the successive words of a text, with line numbers."""

    source: str
    words: Sequence[tuple[int, str]]
    position: int = 0
    line: int = field(default=1)

    @property
    def place(self) -> str:
        """File and line of the last word read."""
        return f"{self.source}:{self.line}"

    @property
    def is_finished(self) -> bool:
        """Whether all words have been read."""
        return self.position >= len(self.words)

    def next(self, expected: str) -> str:
        """Return the next word and advance.

        Raises:
            CaptureError: there is none.
        """
        if self.is_finished:
            raise CaptureError(f"{self.place}: not a BVH file: it ends where {expected} is needed")
        self.line, word = self.words[self.position]
        self.position += 1
        return word


def read_bvh_skeleton(data: bytes, source: str) -> tuple[CapturedJoint, ...]:
    """Read the joints of a BVH file, parents first.

    Raises:
        CaptureError: the data is not BVH.
    """
    lines = split_lines(data, source)
    return _parse_hierarchy(lines[: _find_motion(lines)], source)[0]


def read_bvh(data: bytes, source: str) -> tuple[tuple[CapturedJoint, ...], CapturedMotion]:
    """Read joints and motion of a BVH file.

    The number of rows counts, not the number of frames in the header. A T-pose before the motion is dropped.

    Raises:
        CaptureError: the data is not BVH.
    """
    lines = split_lines(data, source)
    begin = _find_motion(lines)
    joints, channels = _parse_hierarchy(lines[:begin], source)
    period, first = _parse_frame_time(lines, begin, source)
    rows = _parse_rows(lines, first, len(channels), source)
    motion = _make_motion(joints, channels, rows, period)
    check_times(motion.times, source)
    return joints, _drop_first_frame(motion) if _starts_in_other_pose(joints, motion) else motion


def _find_motion(lines: Sequence[str]) -> int:
    """Return the line index of MOTION, or the line count if missing."""
    return next((k for k, line in enumerate(lines) if line.strip() == "MOTION"), len(lines))


def _parse_frame_time(lines: Sequence[str], begin: int, source: str) -> tuple[float, int]:
    """Return the frame period [s] and the first frame's line index."""
    for k in range(begin + 1, min(begin + 10, len(lines))):
        name, _, value = lines[k].partition(":")
        if name.strip() == "Frame Time":
            (period,) = parse_numbers([value], f"{source}:{k + 1}: Frame Time")
            if period <= 0.0:
                raise CaptureError(f"{source}:{k + 1}: Frame Time is {period:g} s; it must be positive")
            return float(period), k + 1
    raise CaptureError(f"{source}: not a BVH file: it needs MOTION, Frames and Frame Time")


def _parse_rows(lines: Sequence[str], first: int, width: int, source: str) -> Floats:
    """Parse the channel values (m, width) of all complete frames."""
    numbers = array("d")
    for k in range(first, len(lines)):
        numbers.frombytes(parse_numbers(lines[k].split(), f"{source}:{k + 1}").tobytes())
    if len(numbers) > MAX_FRAMES * width:
        raise CaptureError(f"{source}: it has more than {MAX_FRAMES} frames")
    values = np.array(numbers)
    return sealed(values[: len(values) - len(values) % width].reshape(-1, width))


def _make_motion(joints: Sequence[CapturedJoint], channels: Channels, rows: Floats, period: float) -> CapturedMotion:
    columns: dict[tuple[str, str], slice] = {}
    blocks: list[Floats] = []
    width = 0
    channels_of: dict[str, list[tuple[int, str]]] = {}
    for k, (name, kind) in enumerate(channels):
        channels_of.setdefault(name, []).append((k, kind))
    for joint in joints:
        order, turned = "", []
        for k, kind in channels_of.get(joint.name, ()):
            if kind.endswith("rotation"):
                order += kind[0]
                turned.append(k)
            elif joint.parent is None:  # suits also repeat the offsets of other joints
                blocks.append(rows[:, [k]])
                columns[joint.name, f"{kind[0]}Pos"] = slice(width, width := width + 1)
        if turned:
            blocks.append(Rotation.from_euler(order, rows[:, turned], degrees=True).as_rotvec())
            columns[joint.name, "Quat"] = slice(width, width := width + 3)
    frames = np.concatenate(blocks, axis=1) if blocks else np.zeros((len(rows), 0))
    return CapturedMotion(sealed(period * np.arange(len(rows))), columns, sealed(frames), {})


def _starts_in_other_pose(joints: Sequence[CapturedJoint], motion: CapturedMotion) -> bool:
    """Return whether the first frame is a calibration pose (T-pose).

    A joint then rotates by more than `MAX_FIRST_STEP` to the second frame.
    """
    start = CapturedMotion(motion.times[:2], motion.columns, motion.frames[:2], {})
    for rotations in joint_frames(joints, start).rotations.values():
        cosine = (float(np.trace(rotations[0].T @ rotations[1])) - 1.0) / 2.0
        if np.arccos(np.clip(cosine, -1.0, 1.0)) > MAX_FIRST_STEP:
            return len(motion.times) > 2
    return False


def _drop_first_frame(motion: CapturedMotion) -> CapturedMotion:
    times = sealed(motion.times[1:] - motion.times[1])
    return CapturedMotion(times, motion.columns, sealed(motion.frames[1:]), motion.syncs)


def _parse_hierarchy(lines: Sequence[str], source: str) -> tuple[tuple[CapturedJoint, ...], Channels]:
    words = _Words(
        source,
        [
            (number, word)
            for number, line in enumerate(lines, start=1)
            for word in line.replace("{", " { ").replace("}", " } ").split()
        ],
    )
    offsets: dict[str, Floats] = {}
    parents: dict[str, str | None] = {}
    channels: list[tuple[str, str]] = []
    ancestors: list[str | None] = []  # None: an end site
    name: str | None = None
    while not words.is_finished:
        word = words.next("a keyword")
        if word in ("ROOT", "JOINT"):
            name = words.next("the name of a joint")
            if name in parents or len(parents) == MAX_JOINTS:
                raise CaptureError(
                    f"{words.place}: joint {name[:40]!r} occurs twice, or is one of more than {MAX_JOINTS}"
                )
            parents[name] = next((above for above in reversed(ancestors) if above), None)
        elif word == "End":
            words.next("Site")
            name = None
        elif word == "{":
            ancestors.append(name)
        elif word == "}" and ancestors:
            ancestors.pop()
            name = ancestors[-1] if ancestors else None
        elif word == "OFFSET":
            offset = parse_numbers([words.next("a number") for _ in CHANNEL_AXES], words.place)
            if name is not None:
                offsets[name] = offset
        elif word == "CHANNELS" and name is not None:
            channels += [(name, kind) for kind in _parse_channels(words)]
        elif word != "HIERARCHY":
            raise CaptureError(f"{words.place}: not a BVH file: {word[:40]!r} is no keyword here")
    joints = tuple(
        CapturedJoint(name, parent, offsets.get(name, NO_ROTATION), NO_ROTATION) for name, parent in parents.items()
    )
    if not joints or not channels:
        raise CaptureError(f"{source}: not a BVH file: it has no joints or no channels")
    return joints, tuple(channels)


def _parse_channels(words: _Words) -> list[str]:
    count = parse_count(words.next("a number"), f"{words.place}: CHANNELS", most=MAX_CHANNELS)
    kinds = [words.next("a channel") for _ in range(count)]
    for kind in kinds:
        if kind.capitalize() not in CHANNEL_KINDS:
            raise CaptureError(f"{words.place}: channel {kind[:40]!r}; known are {', '.join(sorted(CHANNEL_KINDS))}")
        if [other.capitalize() for other in kinds].count(kind.capitalize()) > 1:
            raise CaptureError(f"{words.place}: channel {kind!r} occurs twice in one joint")
    return [kind.capitalize() for kind in kinds]
