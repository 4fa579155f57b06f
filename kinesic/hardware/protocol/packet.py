"""Writes and reads the bytes of Dynamixel Protocol 2.0: packets, stuffing, CRC, and packets in a stream.

A packet is FF FF FD 00, id, length (2 bytes), instruction, parameters, CRC (2 bytes); the length counts what follows
it. A status has instruction 0x55 and its error byte before the data. Inside the body FF FF FD becomes FF FF FD FD, so
that no header ever stands in it; the CRC covers the stuffed packet (ROBOTIS e-Manual, Protocol 2.0). Replies to the
fast reads are the exception: they are not stuffed, see `query`.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum

HEADER = b"\xff\xff\xfd\x00"
BROADCAST = 0xFE
ALERT = 0x80  # bit of the error byte: the servo's hardware error register says why
MAX_LENGTH = 1024  # of the length field; what claims more is noise
OVERHEAD = 10  # [bytes] of a packet without parameters
STATUS_OVERHEAD = 11  # [bytes] of a status without data

_MARK = b"\xff\xff\xfd"
_STUFFED = b"\xff\xff\xfd\xfd"
_POLYNOMIAL = 0x8005


class Instruction(IntEnum):
    """What a packet asks for."""

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
    """Why a servo refused an instruction: the error byte without its alert bit."""

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
    """One packet, its stuffing removed."""

    id: int
    instruction: int
    parameters: bytes

    @property
    def error(self) -> int:
        """The error byte of a status."""
        return self.parameters[0]

    @property
    def data(self) -> bytes:
        """What a status carries behind its error byte."""
        return self.parameters[1:]


def _row(byte: int) -> int:
    crc = byte << 8
    for _ in range(8):
        crc = (crc << 1) ^ (_POLYNOMIAL if crc & 0x8000 else 0)
    return crc & 0xFFFF


CRC_TABLE = tuple(_row(byte) for byte in range(256))


def crc16(data: bytes | bytearray | memoryview, crc: int = 0) -> int:
    """Returns the CRC of data, continued from `crc` (polynomial 0x8005, not reflected, starting at 0)."""
    table = CRC_TABLE
    for byte in data:
        crc = ((crc << 8) & 0xFF00) ^ table[crc >> 8 ^ byte]
    return crc


def stuff(body: bytes) -> bytes:
    """Stuffs a body, so that no header can be found in it."""
    return body.replace(_MARK, _STUFFED)


def unstuff(body: bytes) -> bytes:
    """Undoes `stuff`."""
    return body.replace(_STUFFED, _MARK)


def packet(servo: int, instruction: int, parameters: bytes = b"") -> bytes:
    """Returns the bytes of a packet.

    Raises:
        ValueError: the id is none, or the packet would be longer than servos read.
    """
    if not 0 <= servo <= BROADCAST or servo == 0xFD:
        raise ValueError(f"id is {servo}, must be 0..252, or {BROADCAST} for all")
    body = stuff(bytes((instruction,)) + parameters)
    length = len(body) + 2
    if length > MAX_LENGTH:
        raise ValueError(f"a packet of length {length} is longer than the {MAX_LENGTH} that servos read")
    head = HEADER + bytes((servo, length & 0xFF, length >> 8)) + body
    return head + crc16(head).to_bytes(2, "little")


def status(servo: int, error: int, data: bytes = b"") -> bytes:
    """Returns the bytes of a servo's answer."""
    return packet(servo, Instruction.STATUS, bytes((error,)) + data)


def ping(servo: int) -> bytes:
    """Asks one servo, or all, for model number and firmware."""
    return packet(servo, Instruction.PING)


def read_packet(servo: int, address: int, size: int) -> bytes:
    """Asks for `size` bytes from `address` on."""
    return packet(servo, Instruction.READ, _span(address, size))


def write_packet(servo: int, address: int, data: bytes) -> bytes:
    """Writes data from `address` on."""
    return packet(servo, Instruction.WRITE, address.to_bytes(2, "little") + data)


def sync_write(address: int, size: int, rows: dict[int, bytes]) -> bytes:
    """Writes `size` bytes from `address` on in several servos at once: id -> bytes; nobody answers.

    Raises:
        ValueError: a row has another size.
    """
    for servo, row in rows.items():
        if len(row) != size:
            raise ValueError(f"servo {servo} is to be written {len(row)} bytes, must be {size}")
    listed = b"".join(bytes((servo,)) + row for servo, row in rows.items())
    return packet(BROADCAST, Instruction.SYNC_WRITE, _span(address, size) + listed)


def sync_read(servos: Sequence[int], address: int, size: int, *, fast: bool) -> bytes:
    """Asks several servos for the same registers: one status each, or one joint reply when fast."""
    kind = Instruction.FAST_SYNC_READ if fast else Instruction.SYNC_READ
    return packet(BROADCAST, kind, _span(address, size) + bytes(servos))


def bulk_read(spans: dict[int, tuple[int, int]], *, fast: bool) -> bytes:
    """Asks several servos for registers of their own: id -> (address, size)."""
    kind = Instruction.FAST_BULK_READ if fast else Instruction.BULK_READ
    return packet(BROADCAST, kind, b"".join(bytes((servo,)) + _span(*span) for servo, span in spans.items()))


def _span(address: int, size: int) -> bytes:
    return address.to_bytes(2, "little") + size.to_bytes(2, "little")


class Reader:
    """Finds packets in a stream of bytes: noise, cut packets and wrong CRCs are passed over."""

    def __init__(self) -> None:
        self._stream = bytearray()

    def clear(self) -> None:
        """Forgets what has been fed and is no packet yet."""
        self._stream.clear()

    def feed(self, data: bytes) -> Iterator[Packet]:
        """The packets that are complete with these bytes; unfinished ones wait for the next bytes.

        A joint reply to a fast read, a status from BROADCAST, was never stuffed and is left as it is.
        """
        self._stream += data
        while (found := self._next()) is not None:
            yield found

    def _next(self) -> Packet | None:
        stream = self._stream
        while True:
            start = stream.find(HEADER)
            if start < 0:
                del stream[: max(0, len(stream) - len(HEADER) + 1)]
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
                later = stream.find(HEADER, 1)
                if later < 0 or stream[4] == BROADCAST:
                    return None
                # no header ever stands inside a stuffed packet: this one was cut short
                del stream[:later]
                continue
            if crc16(memoryview(stream)[: end - 2]) != stream[end - 2] | stream[end - 1] << 8:
                del stream[:1]
                continue
            body = bytes(stream[7 : end - 2])
            servo = stream[4]
            del stream[:end]
            fast = servo == BROADCAST and body[0] == Instruction.STATUS
            body = body if fast else unstuff(body)
            if body[0] == Instruction.STATUS and len(body) < 2:
                continue
            return Packet(servo, body[0], body[1:])
