"""Small MCAP files with ROS 2 messages for tests."""

import struct
from io import BytesIO

from mcap.writer import CompressionType, Writer

JOINT_STATE = "sensor_msgs/msg/JointState"
JOINT_TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"


class Cdr:
    """Encoder of a ROS 2 message."""

    def __init__(self, order="<") -> None:
        self.order, self.body = order, b""

    def add(self, kind, value) -> "Cdr":
        """Add a number, aligned to the number's size."""
        size = struct.calcsize(kind)
        self.body += b"\0" * (-len(self.body) % size) + struct.pack(self.order + kind, value)
        return self

    def text(self, text) -> "Cdr":
        """Add a text with its length and a final NUL."""
        self.add("I", len(text) + 1).body += text.encode() + b"\0"
        return self

    def texts(self, texts) -> "Cdr":
        self.add("I", len(texts))
        for text in texts:
            self.text(text)
        return self

    def doubles(self, numbers) -> "Cdr":
        self.add("I", len(numbers))
        for number in numbers:
            self.add("d", number)
        return self

    def time(self, seconds) -> "Cdr":
        whole = int(seconds // 1)
        return self.add("i", whole).add("I", round((seconds - whole) * 1e9))

    def bytes(self) -> bytes:
        return (b"\0\1" if self.order == "<" else b"\0\0") + b"\0\0" + self.body


def joint_state(time, names, positions, *, order="<") -> bytes:
    """Write a message with positions, velocities and no efforts."""
    cdr = Cdr(order).time(time).text("base").texts(names).doubles(positions)
    return cdr.doubles([0.5] * len(positions)).doubles([]).bytes()


def joint_trajectory(names, times, rows) -> bytes:
    """Write a trajectory with velocities, and no accelerations and efforts."""
    cdr = Cdr().time(3.0).text("").texts(names).add("I", len(rows))
    for time, row in zip(times, rows, strict=True):
        cdr.doubles(row).doubles([0.1] * len(row)).doubles([]).doubles([]).time(time)
    return cdr.bytes()


def mcap(topics, *, compression=CompressionType.NONE, encoding="cdr") -> bytes:
    """Write an MCAP file with the library `mcap`.

    Args:
        topics: name -> (message type, [(log time [s], data), ...]).
        compression: of the chunks.
        encoding: of the messages.
    """
    file = BytesIO()
    writer = Writer(file, compression=compression, chunk_size=1500)
    writer.start("ros2")
    for name, (kind, messages) in topics.items():
        schema = writer.register_schema(kind, "ros2msg", b"float64[] position")
        channel = writer.register_channel(name, encoding, schema)
        for time, data in messages:
            writer.add_message(channel, log_time=round(time * 1e9), publish_time=0, data=data)
    writer.finish()
    return file.getvalue()


def state_messages(count=40, *, names=("pan", "tilt"), start=100.0) -> list[tuple[float, bytes]]:
    """Return joint states at 50 Hz with linearly growing angles [rad]."""
    rows = [[0.01 * (k + 1) * frame for k in range(len(names))] for frame in range(count)]
    return [(frame / 50, joint_state(start + frame / 50, names, row)) for frame, row in enumerate(rows)]
