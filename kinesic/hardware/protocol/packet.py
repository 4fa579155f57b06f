"""Dynamixel Protocol 2.0 packets: stuffing, CRC and stream parsing.

A packet is FF FF FD 00, id, length (2 bytes), instruction, parameters, CRC (2 bytes); the length counts the bytes
after it. A status has instruction 0x55 and its error byte before the data. Inside the body FF FF FD becomes FF FF FD
FD, so that the body never contains a header; the CRC covers the stuffed packet (ROBOTIS e-Manual, Protocol 2.0).
Replies to fast reads are the exception: they are not stuffed, see `query`.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum

PACKET_HEADER = b"\xff\xff\xfd\x00"  # first bytes of every packet
BROADCAST_ID = 0xFE  # Id that addresses all servos
MAX_ID = 252  # Largest id of a servo
ALERT_BIT = 0x80  # Bit of the error byte for a nonzero hardware error register
MAX_LENGTH = 1024  # [bytes] largest accepted length field of a packet; a larger one is treated as noise
PACKET_OVERHEAD = 10  # [bytes] size of an instruction packet without parameters
STATUS_OVERHEAD = 11  # [bytes] size of a status packet without data

_HEADER_MARK = b"\xff\xff\xfd"  # bytes that may occur only in a header
_STUFFED_MARK = b"\xff\xff\xfd\xfd"  # bytes of _HEADER_MARK inside a packet's body, after stuffing
_CRC_POLYNOMIAL = 0x8005  # generator polynomial of the 16-bit CRC, without its highest bit


class Instruction(IntEnum):
    """Instruction code of a packet."""

    PING = 0x01
    READ = 0x02
    WRITE = 0x03
    REG_WRITE = 0x04
    ACTION = 0x05
    FACTORY_RESET = 0x06
    REBOOT = 0x08
    CLEAR = 0x10
    BACKUP = 0x20
    STATUS = 0x55
    SYNC_READ = 0x82
    SYNC_WRITE = 0x83
    FAST_SYNC_READ = 0x8A
    BULK_READ = 0x92
    BULK_WRITE = 0x93
    FAST_BULK_READ = 0x9A


class Fault(IntEnum):
    """Reason for a refused instruction: the error byte without its alert bit."""

    NONE = 0
    RESULT = 1
    INSTRUCTION = 2
    CRC = 3
    RANGE = 4
    LENGTH = 5
    LIMIT = 6
    ACCESS = 7


@dataclass(frozen=True)
class Packet:
    """Protocol 2.0 packet without its stuffing bytes."""

    id: int
    instruction: int
    parameters: bytes

    @property
    def error(self) -> int:
        """Error byte of a status packet."""
        return self.parameters[0]

    @property
    def data(self) -> bytes:
        """Data of a status packet, after its error byte."""
        return self.parameters[1:]


def _row(byte: int) -> int:
    crc = byte << 8
    for _ in range(8):
        crc = (crc << 1) ^ (_CRC_POLYNOMIAL if crc & 0x8000 else 0)
    return crc & 0xFFFF


CRC_TABLE = tuple(_row(byte) for byte in range(256))  # CRC of each byte value


def crc16(data: bytes | bytearray | memoryview, crc: int = 0) -> int:
    """Return the CRC of data, continued from `crc`.

    The polynomial is 0x8005, not reflected, with initial value 0.
    """
    table = CRC_TABLE
    for byte in data:
        crc = ((crc << 8) & 0xFF00) ^ table[crc >> 8 ^ byte]
    return crc


def stuff(body: bytes) -> bytes:
    """Insert stuffing bytes, so that the body contains no header."""
    return body.replace(_HEADER_MARK, _STUFFED_MARK)


def unstuff(body: bytes) -> bytes:
    """Remove the stuffing bytes of a body."""
    return body.replace(_STUFFED_MARK, _HEADER_MARK)


def packet(servo: int, instruction: int, parameters: bytes = b"") -> bytes:
    """Encode an instruction or status as packet bytes.

    Raises:
        ValueError: the id is invalid, or the packet is longer than servos accept.
    """
    if not 0 <= servo <= BROADCAST_ID or servo == 0xFD:
        raise ValueError(f"id is {servo}, must be 0..252, or {BROADCAST_ID} for all")
    body = stuff(bytes((instruction,)) + parameters)
    length = len(body) + 2
    if length > MAX_LENGTH:
        raise ValueError(f"a packet of length {length} is longer than the {MAX_LENGTH} that servos read")
    head = PACKET_HEADER + bytes((servo, length & 0xFF, length >> 8)) + body
    return head + crc16(head).to_bytes(2, "little")


def status(servo: int, error: int, data: bytes = b"") -> bytes:
    """Encode a servo's status packet."""
    return packet(servo, Instruction.STATUS, bytes((error,)) + data)


def ping(servo: int) -> bytes:
    """Encode a ping of one servo or of all.

    The reply has model number and firmware.
    """
    return packet(servo, Instruction.PING)


def read_packet(servo: int, address: int, size: int) -> bytes:
    """Encode a read of `size` bytes from `address` on."""
    return packet(servo, Instruction.READ, _span(address, size))


def write_packet(servo: int, address: int, data: bytes) -> bytes:
    """Encode a write of data from `address` on."""
    return packet(servo, Instruction.WRITE, address.to_bytes(2, "little") + data)


def sync_write(address: int, size: int, rows: dict[int, bytes]) -> bytes:
    """Encode a write of `size` bytes at `address` in several servos.

    Servos do not answer it.

    Args:
        address: first address.
        size: [bytes] per servo.
        rows: id -> bytes.

    Raises:
        ValueError: a row has another size.
    """
    for servo, row in rows.items():
        if len(row) != size:
            raise ValueError(f"servo {servo} has a row of {len(row)} bytes, must be {size}")
    listed = b"".join(bytes((servo,)) + row for servo, row in rows.items())
    return packet(BROADCAST_ID, Instruction.SYNC_WRITE, _span(address, size) + listed)


def sync_read(servos: Sequence[int], address: int, size: int, *, fast: bool) -> bytes:
    """Encode a read of the same registers of several servos.

    They answer with one status each, or with one common reply to a fast read.
    """
    kind = Instruction.FAST_SYNC_READ if fast else Instruction.SYNC_READ
    return packet(BROADCAST_ID, kind, _span(address, size) + bytes(servos))


def bulk_read(spans: dict[int, tuple[int, int]], *, fast: bool) -> bytes:
    """Encode a read of different registers of several servos.

    Args:
        spans: id -> (address, size).
        fast: whether to request one common reply.
    """
    kind = Instruction.FAST_BULK_READ if fast else Instruction.BULK_READ
    return packet(BROADCAST_ID, kind, b"".join(bytes((servo,)) + _span(*span) for servo, span in spans.items()))


def _span(address: int, size: int) -> bytes:
    return address.to_bytes(2, "little") + size.to_bytes(2, "little")


class Reader:
    """Stream parser that skips noise, truncated packets and wrong CRCs."""

    def __init__(self) -> None:
        self._stream = bytearray()

    def clear(self) -> None:
        """Discard the bytes of an unfinished packet."""
        self._stream.clear()

    def feed(self, data: bytes) -> Iterator[Packet]:
        """Add received bytes, and yield the packets that become complete.

        Unfinished packets wait for more bytes. A common reply to a fast read, a status from BROADCAST_ID, is not
        unstuffed.
        """
        self._stream += data
        while (packet_read := self._next()) is not None:
            yield packet_read

    def _next(self) -> Packet | None:
        stream = self._stream
        while True:
            start = stream.find(PACKET_HEADER)
            if start < 0:
                del stream[: max(0, len(stream) - len(PACKET_HEADER) + 1)]
                return None
            del stream[:start]
            if len(stream) < 7:
                return None
            length = stream[5] | stream[6] << 8
            if not 3 <= length <= MAX_LENGTH or stream[4] in (0xFD, 0xFF):
                del stream[:1]
                continue
            end = 7 + length
            if len(stream) < end:
                later = stream.find(PACKET_HEADER, 1)
                if later < 0 or stream[4] == BROADCAST_ID:
                    return None
                # a stuffed packet contains no header, so this one was truncated
                del stream[:later]
                continue
            if crc16(memoryview(stream)[: end - 2]) != stream[end - 2] | stream[end - 1] << 8:
                del stream[:1]
                continue
            body = bytes(stream[7 : end - 2])
            servo = stream[4]
            del stream[:end]
            fast = servo == BROADCAST_ID and body[0] == Instruction.STATUS
            body = body if fast else unstuff(body)
            if body[0] == Instruction.STATUS and len(body) < 2:
                continue
            return Packet(servo, body[0], body[1:])
