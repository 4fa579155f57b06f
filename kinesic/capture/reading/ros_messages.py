"""Readers of ROS joint states and joint trajectories (MCAP and JSON)."""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import msgspec
import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.capture.clip import JointClip
from kinesic.capture.reading.mcap_file import Message, Topic, read_messages
from kinesic.capture.reading.text import (
    MAX_FRAMES,
    MAX_JOINTS,
    CaptureError,
    check_numbers,
    check_size,
    check_times,
)

JOINT_STATE = "sensor_msgs/msg/JointState"  # message type with the positions at one time
JOINT_TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"  # message type with the positions at many times
CDR_HEADERS = {b"\x00\x00": ">", b"\x00\x01": "<"}  # byte order by the first bytes of a message
CDR_BODY = 4  # [bytes] offset of the first field, from which alignment is counted
DOUBLE_SIZE = 8  # [bytes] size of a number, and its alignment


class _Cdr:
    """Reader of the successive fields of a serialised ROS 2 message."""

    def __init__(self, data: bytes) -> None:
        order = CDR_HEADERS.get(data[:2])
        if order is None:
            raise ValueError("its first bytes are not those of CDR")
        self._data, self._order, self._position = data, order, CDR_BODY

    def _take(self, size: int, alignment: int) -> bytes:
        begin = self._position + (CDR_BODY - self._position) % alignment
        self._position = begin + size
        if self._position > len(self._data):
            raise ValueError(f"it ends within a field of {size} bytes")
        return self._data[begin : self._position]

    def count(self) -> int:
        """Return an unsigned integer of 32 bits."""
        (number,) = struct.unpack(f"{self._order}I", self._take(4, 4))
        return int(number)

    def seconds(self) -> float:
        """Return a time or duration [s]."""
        seconds, nanoseconds = struct.unpack(f"{self._order}iI", self._take(8, 4))
        return float(seconds + 1e-9 * nanoseconds)

    def text(self) -> str:
        """Return a text without its final NUL."""
        return self._take(self.count(), 1).rstrip(b"\0").decode("utf-8", "replace")

    def texts(self) -> tuple[str, ...]:
        """Return a sequence of texts, of at most `MAX_JOINTS`."""
        count = self.count()
        if count > MAX_JOINTS:
            raise ValueError(f"it has {count} joints; at most {MAX_JOINTS} are read")
        return tuple(self.text() for _ in range(count))

    def doubles(self) -> Floats:
        """Return a sequence of numbers (k,)."""
        count = self.count()
        numbers = self._take(count * DOUBLE_SIZE, DOUBLE_SIZE) if count else b""
        return np.frombuffer(numbers, f"{self._order}f8").astype(np.float64)


@dataclass(frozen=True, eq=False)
class _Frame:
    """Joint positions at one time."""

    time: float  # [s] time of the message or point
    names: tuple[str, ...]
    positions: Floats  # (n,) [rad] joint positions


class _Duration(msgspec.Struct):
    """Duration as ROS writes it in JSON."""

    sec: Annotated[int, msgspec.Meta(ge=-(2**31), lt=2**31)] = 0  # [s] whole seconds
    nanosec: Annotated[int, msgspec.Meta(ge=0, lt=2**32)] = 0  # [ns] nanoseconds


class _Point(msgspec.Struct):
    """Positions of a trajectory at one time."""

    positions: list[float]
    time_from_start: _Duration


class _Trajectory(msgspec.Struct):
    """Joint trajectory as ROS writes it in JSON."""

    joint_names: list[str]
    points: list[_Point]


def read_joint_mcap(data: bytes, source: str) -> JointClip:
    """Read joint positions from an MCAP file of ROS 2.

    The first topic of joint states or trajectories counts; of trajectories, the first message with points.

    Raises:
        CaptureError: the file has no such topic, or is damaged.
    """
    chosen: Topic | None = None
    frames: list[_Frame] = []
    left_out = 0
    for message in read_messages(data, source):
        if message.topic.schema not in (JOINT_STATE, JOINT_TRAJECTORY):
            continue
        chosen = chosen or message.topic
        if message.topic != chosen or (chosen.schema == JOINT_TRAJECTORY and frames):
            left_out += 1
            continue
        found = _read_message(message, f"{source}: topic {chosen.name[:40]}")
        if frames and found[0].names != frames[0].names:
            left_out += 1
            continue
        frames += found
        if len(frames) > MAX_FRAMES:
            raise CaptureError(f"{source}: more than {MAX_FRAMES} frames; cut the file")
    if chosen is None:
        raise CaptureError(f"{source}: no topic of type {JOINT_STATE} or {JOINT_TRAJECTORY}")
    guesses = (f"topic {chosen.name[:40]}; {left_out} messages of other joints left out",) if left_out else ()
    return _make_clip(frames, guesses, source)


def read_joint_trajectory(data: bytes, source: str) -> JointClip:
    """Read a ROS joint trajectory from JSON.

    Raises:
        CaptureError: the data is no such trajectory.
    """
    check_size(data, source)
    try:
        trajectory = msgspec.json.decode(data, type=_Trajectory)
    except (msgspec.DecodeError, RecursionError, UnicodeDecodeError) as error:
        raise CaptureError(f"{source}: not a joint trajectory: {error}") from None
    if not 0 < len(trajectory.joint_names) <= MAX_JOINTS:
        raise CaptureError(f"{source}: joint_names has {len(trajectory.joint_names)} names; it needs 1 to {MAX_JOINTS}")
    names = tuple(trajectory.joint_names)
    frames = []
    for k, point in enumerate(trajectory.points):
        if len(point.positions) != len(names):
            raise CaptureError(f"{source}: points[{k}]: {len(point.positions)} positions for {len(names)} joints")
        time = point.time_from_start
        frames.append(_Frame(time.sec + 1e-9 * time.nanosec, names, np.array(point.positions)))
    return _make_clip(frames, (), source)


def _read_message(message: Message, place: str) -> Sequence[_Frame]:
    """Return the frames of a message, at least one.

    Raises:
        CaptureError: the message is damaged, or in another encoding than CDR.
    """
    if message.topic.encoding != "cdr":
        raise CaptureError(f"{place}: its encoding is {message.topic.encoding[:20]!r}; it must be cdr (ROS 2)")
    try:
        cdr = _Cdr(message.data)
        stamp = cdr.seconds()
        cdr.text()  # frame_id
        names = cdr.texts()
        if message.topic.schema == JOINT_STATE:
            frames = [_Frame(stamp or message.time, names, cdr.doubles())]
        else:
            frames = []
            for _ in range(min(cdr.count(), MAX_FRAMES + 1)):
                positions = cdr.doubles()
                for _ in range(3):  # velocities, accelerations, efforts
                    cdr.doubles()
                frames.append(_Frame(cdr.seconds(), names, positions))
        if not names or not frames or any(len(frame.positions) != len(names) for frame in frames):
            raise ValueError(f"it needs points with a position for each of its {len(names)} names")
    except ValueError as error:
        raise CaptureError(f"{place}: message at {message.time:.3f} s: {error}") from None
    return frames


def _make_clip(frames: Sequence[_Frame], guesses: tuple[str, ...], source: str) -> JointClip:
    times = np.array([frame.time for frame in frames])
    check_times(check_numbers(times, f"{source}: times"), source)
    names = frames[0].names
    if len(set(names)) < len(names):
        raise CaptureError(f"{source}: two positions have the same joint")
    angles = check_numbers(np.array([frame.positions for frame in frames]), f"{source}: positions")
    return JointClip(sealed(times - times[0]), names, sealed(angles), guesses)
