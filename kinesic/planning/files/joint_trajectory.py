"""Motions as ROS joint trajectories: JSON text and MCAP files.

Joints have the names and zeros of the robot's own file. JSON is also valid YAML for `ros2 topic pub`.
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec
import numpy as np

from kinesic.body.arrays import Floats
from kinesic.version import __version__

NANOSECONDS_PER_SECOND = 1_000_000_000  # nanoseconds per second
FILE_MAGIC = b"\x89MCAP0\r\n"  # first and last bytes of an MCAP file
OPCODE_HEADER = 0x01  # MCAP code of the record with the file's profile and program
OPCODE_FOOTER = 0x02  # MCAP code of the last record of the file
OPCODE_SCHEMA = 0x03  # MCAP code of a record with a message type
OPCODE_CHANNEL = 0x04  # MCAP code of a record with a topic
OPCODE_MESSAGE = 0x05  # MCAP code of a record with one message
OPCODE_DATA_END = 0x0F  # MCAP code of the record after the last message
TRAJECTORY_TOPIC = "/joint_trajectory"  # topic of the message in MCAP files
TRAJECTORY_TYPE = "trajectory_msgs/msg/JointTrajectory"  # ROS 2 type of the message
CDR_HEADER = b"\x00\x01\x00\x00"  # marks a serialised message as little-endian CDR
TYPE_SEPARATOR = "=" * 80  # line between the definitions of nested message types
TYPE_DEFINITION = "\n".join(  # ROS 2 definition of the message with its nested types
    [
        "std_msgs/Header header",
        "string[] joint_names",
        "trajectory_msgs/JointTrajectoryPoint[] points",
        TYPE_SEPARATOR,
        "MSG: std_msgs/Header",
        "builtin_interfaces/Time stamp",
        "string frame_id",
        TYPE_SEPARATOR,
        "MSG: builtin_interfaces/Time",
        "int32 sec",
        "uint32 nanosec",
        TYPE_SEPARATOR,
        "MSG: trajectory_msgs/JointTrajectoryPoint",
        "float64[] positions",
        "float64[] velocities",
        "float64[] accelerations",
        "float64[] effort",
        "builtin_interfaces/Duration time_from_start",
        TYPE_SEPARATOR,
        "MSG: builtin_interfaces/Duration",
        "int32 sec",
        "uint32 nanosec",
        "",
    ]
)


@dataclass(frozen=True, eq=False)
class SampledJoints:
    """Angles, velocities and accelerations of named joints over time."""

    times: Floats  # (m,) [s] from 0
    names: tuple[str, ...]
    angles: Floats  # (m, j) [rad]
    velocities: Floats  # (m, j) [rad/s]
    accelerations: Floats  # (m, j) [rad/s^2]


def write_trajectory_json(joints: SampledJoints, path: Path) -> None:
    """Write a ROS joint trajectory as JSON."""
    rows = zip(joints.times, joints.angles, joints.velocities, joints.accelerations, strict=True)
    message = {
        "header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""},
        "joint_names": joints.names,
        "points": [
            {
                "positions": _rounded(angles),
                "velocities": _rounded(velocities),
                "accelerations": _rounded(accelerations),
                "effort": [],
                "time_from_start": dict(zip(("sec", "nanosec"), _split_time(time), strict=True)),
            }
            for time, angles, velocities, accelerations in rows
        ],
    }
    path.write_bytes(msgspec.json.format(msgspec.json.encode(message), indent=1) + b"\n")


def write_trajectory_mcap(joints: SampledJoints, path: Path) -> None:
    """Write an MCAP file whose only message is a ROS joint trajectory."""
    schema = struct.pack("<H", 1) + _texts(TRAJECTORY_TYPE, "ros2msg", TYPE_DEFINITION)
    channel = struct.pack("<HH", 1, 1) + _texts(TRAJECTORY_TOPIC, "cdr") + struct.pack("<I", 0)
    message = struct.pack("<HIQQ", 1, 0, 0, 0) + _serialise(joints)
    records = (
        (OPCODE_HEADER, _texts("ros2", f"kinesic {__version__}")),
        (OPCODE_SCHEMA, schema),
        (OPCODE_CHANNEL, channel),
        (OPCODE_MESSAGE, message),
        (OPCODE_DATA_END, struct.pack("<I", 0)),
        (OPCODE_FOOTER, struct.pack("<QQI", 0, 0, 0)),
    )
    content = b"".join(struct.pack("<BQ", opcode, len(record)) + record for opcode, record in records)
    path.write_bytes(FILE_MAGIC + content + FILE_MAGIC)


def _texts(*texts: str) -> bytes:
    """Return texts as MCAP stores them, each with its length before it."""
    encoded = [text.encode() for text in texts]
    return b"".join(struct.pack("<I", len(text)) + text for text in encoded)


def _serialise(joints: SampledJoints) -> bytes:
    """Serialise a joint trajectory in little-endian CDR."""
    message = _CdrWriter()
    message.add_time(0.0)
    message.add_text("")
    message.add_count(len(joints.names))
    for name in joints.names:
        message.add_text(name)
    message.add_count(len(joints.times))
    rows = zip(joints.times, joints.angles, joints.velocities, joints.accelerations, strict=True)
    for time, angles, velocities, accelerations in rows:
        for numbers in (angles, velocities, accelerations, np.empty(0)):
            message.add_doubles(numbers)
        message.add_time(float(time))
    return message.data


class _CdrWriter:
    """Writer of the successive fields of a ROS 2 message."""

    def __init__(self) -> None:
        self._body = bytearray()

    @property
    def data(self) -> bytes:
        """Serialised message with its header."""
        return CDR_HEADER + bytes(self._body)

    def _align(self, size: int) -> None:
        """Fill up to a multiple of a field's size [bytes]."""
        self._body += bytes(-len(self._body) % size)

    def add_count(self, number: int) -> None:
        """Append an unsigned 32-bit integer to the message."""
        self._align(4)
        self._body += struct.pack("<I", number)

    def add_time(self, time: float) -> None:
        """Append a time or duration [s] to the message."""
        self._align(4)
        self._body += struct.pack("<iI", *_split_time(time))

    def add_text(self, text: str) -> None:
        """Append a text with its final NUL to the message."""
        data = text.encode() + b"\0"
        self.add_count(len(data))
        self._body += data

    def add_doubles(self, numbers: Floats) -> None:
        """Append a sequence of numbers (k,) to the message."""
        self.add_count(len(numbers))
        if len(numbers):
            self._align(8)
            self._body += np.asarray(numbers, dtype="<f8").tobytes()


def _split_time(time: float) -> tuple[int, int]:
    """Split a time [s] into seconds and nanoseconds."""
    return divmod(round(float(time) * NANOSECONDS_PER_SECOND), NANOSECONDS_PER_SECOND)


def _rounded(numbers: Floats) -> Sequence[float]:
    """Return numbers (k,) with nine significant digits."""
    return [float(f"{value:.9g}") for value in numbers]
