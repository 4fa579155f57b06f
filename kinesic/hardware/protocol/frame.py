"""Frames of Dynamixel Protocol 1.0, which Feetech servos speak as well.

A frame is FF FF, id, length, instruction or error byte, parameters, checksum; the length counts the bytes after it, and
the checksum is the inverted sum of all bytes after the header (ROBOTIS e-Manual, Protocol 1.0; Feetech SCS protocol).
Frames are not stuffed, so parameters may contain a header, and the checksum lets one random error in 256 pass.
"""

from collections.abc import Iterator, Mapping, Sequence

from kinesic.hardware.protocol.packet import BROADCAST_ID, Instruction, Packet

FRAME_HEADER = b"\xff\xff"  # first bytes of every frame
FRAME_OVERHEAD = 6  # [bytes] size of a frame without parameters
MAX_FRAME_PARAMETERS = 250  # [bytes] longest parameters of a frame
MIN_LENGTH_FIELD = 2  # smallest value of the length field: instruction or error byte, and checksum


def checksum(body: bytes) -> int:
    """Return the checksum of a frame's bytes between header and checksum."""
    return ~sum(body) & 0xFF


def frame(servo: int, code: int, parameters: bytes = b"") -> bytes:
    """Encode an instruction frame, or a status frame with an error byte.

    Raises:
        ValueError: the id is invalid, or the parameters are too long.
    """
    if not 0 <= servo <= BROADCAST_ID:
        raise ValueError(f"id is {servo}, must be 0..253, or {BROADCAST_ID} for all")
    if len(parameters) > MAX_FRAME_PARAMETERS:
        raise ValueError(f"a frame has {len(parameters)} bytes of parameters, at most {MAX_FRAME_PARAMETERS} fit")
    body = bytes((servo, len(parameters) + MIN_LENGTH_FIELD, code)) + parameters
    return FRAME_HEADER + body + bytes((checksum(body),))


def ping_frame(servo: int) -> bytes:
    """Encode a ping of one servo, or of all."""
    return frame(servo, Instruction.PING)


def read_frame(servo: int, address: int, size: int) -> bytes:
    """Encode a read of `size` bytes from `address` on."""
    return frame(servo, Instruction.READ, bytes((address, size)))


def write_frame(servo: int, address: int, data: bytes) -> bytes:
    """Encode a write of data from `address` on."""
    return frame(servo, Instruction.WRITE, bytes((address,)) + data)


def sync_write_frame(address: int, size: int, rows: Mapping[int, bytes]) -> bytes:
    """Encode writes of `size` bytes at `address` in several servos.

    They take as many frames as fit. Servos do not answer.

    Args:
        address: first address.
        size: [bytes] per servo.
        rows: id -> bytes.

    Raises:
        ValueError: a row has another size.
    """
    listed: list[bytes] = []
    for servo, row in rows.items():
        if len(row) != size:
            raise ValueError(f"servo {servo} has a row of {len(row)} bytes, must be {size}")
        listed.append(bytes((servo,)) + row)
    count = (MAX_FRAME_PARAMETERS - 2) // (size + 1)
    head = bytes((address, size))
    parts = (b"".join(listed[k : k + count]) for k in range(0, len(listed), count))
    return b"".join(frame(BROADCAST_ID, Instruction.SYNC_WRITE, head + part) for part in parts)


def sync_read_frame(servos: Sequence[int], address: int, size: int) -> bytes:
    """Encode a read of the same registers of several Feetech servos.

    They answer with one status each, in this order.
    """
    return frame(BROADCAST_ID, Instruction.SYNC_READ, bytes((address, size)) + bytes(servos))


def bulk_read_frame(servos: Sequence[int], address: int, size: int) -> bytes:
    """Encode a read of several Dynamixel MX servos.

    They answer with one status each, in this order.
    """
    rows = b"".join(bytes((size, servo, address)) for servo in servos)
    return frame(BROADCAST_ID, Instruction.BULK_READ, b"\0" + rows)


def find_frames(data: bytes) -> Iterator[tuple[Packet, int]]:
    """Yield each intact frame with the offset of its end.

    Noise, truncated frames and wrong checksums are skipped.
    """
    start = 0
    while (start := data.find(FRAME_HEADER, start)) >= 0:
        received = _frame_at(data, start)
        if received is None:
            start += 1
            continue
        start += FRAME_OVERHEAD + len(received.parameters)
        yield received, start


def _frame_at(data: bytes, start: int) -> Packet | None:
    """Return the intact frame that begins at an offset, or None."""
    if start + FRAME_OVERHEAD > len(data):
        return None
    servo, length = data[start + 2], data[start + 3]
    end = start + 4 + length
    if servo == 0xFF or length < MIN_LENGTH_FIELD or end > len(data):
        return None
    if checksum(data[start + 2 : end - 1]) != data[end - 1]:
        return None
    return Packet(servo, data[start + 4], data[start + 5 : end - 1])


class FrameReader:
    """Stream parser of instruction frames, as a servo reads them."""

    def __init__(self) -> None:
        self._stream = b""

    def clear(self) -> None:
        """Discard the bytes of an unfinished frame."""
        self._stream = b""

    def feed(self, data: bytes) -> Iterator[Packet]:
        """Add received bytes, and yield the frames that become complete."""
        self._stream += data
        found = list(find_frames(self._stream))
        rest = self._stream[found[-1][1] :] if found else self._stream
        self._stream = rest[-MAX_FRAME_PARAMETERS - FRAME_OVERHEAD :]
        yield from (received for received, _ in found)


def split_frames(data: bytes) -> Iterator[bytes]:
    """Split transmitted bytes into frames.

    Bytes that belong to no frame follow as they are.
    """
    start = 0
    for received, end in find_frames(data):
        begin = end - FRAME_OVERHEAD - len(received.parameters)
        if begin > start:
            yield data[start:begin]
        yield data[begin:end]
        start = end
    if start < len(data):
        yield data[start:]
