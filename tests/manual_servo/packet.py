"""Frames of protocol 2.0 with stuffing and CRC-16."""

from dataclasses import dataclass

PACKET_HEADER = b"\xff\xff\xfd\x00"
BROADCAST_ID = 0xFE  # id that addresses all servos
CRC_POLYNOMIAL = 0x8005
MAX_SILENCE = 0.05  # [s] silence after which an incomplete packet is discarded
MAX_LENGTH = 1024  # [bytes] longest packet that a servo can buffer

# Codes of the instructions
PING, READ, WRITE, REG_WRITE, ACTION = 0x01, 0x02, 0x03, 0x04, 0x05
FACTORY_RESET, REBOOT, CLEAR, BACKUP, STATUS = 0x06, 0x08, 0x10, 0x20, 0x55
SYNC_READ, SYNC_WRITE, FAST_SYNC_READ = 0x82, 0x83, 0x8A
BULK_READ, BULK_WRITE, FAST_BULK_READ = 0x92, 0x93, 0x9A

# Error numbers of status packets
RESULT_FAIL, INSTRUCTION_ERROR, CRC_ERROR, RANGE_ERROR = 1, 2, 3, 4
LENGTH_ERROR, LIMIT_ERROR, ACCESS_ERROR = 5, 6, 7
ALERT_BIT = 0x80  # bit of the error byte during a hardware error


def _row(byte: int) -> int:
    value = byte << 8
    for _ in range(8):
        value = (value << 1) ^ CRC_POLYNOMIAL if value & 0x8000 else value << 1
    return value & 0xFFFF


CRC_TABLE = tuple(_row(byte) for byte in range(256))


def crc(data: bytes, start: int = 0) -> int:
    """Compute CRC-16/BUYPASS, continuing from an earlier value."""
    value = start
    for byte in data:
        value = (value << 8) & 0xFF00 ^ CRC_TABLE[(value >> 8) ^ byte]
    return value


def sealed(head: bytes) -> bytes:
    """Return the bytes with their CRC appended."""
    return head + crc(head).to_bytes(2, "little")


def stuff(body: bytes) -> bytes:
    """Add FD behind each FF FF FD, so that a packet contains no header."""
    return body.replace(b"\xff\xff\xfd", b"\xff\xff\xfd\xfd")


def unstuff(body: bytes) -> bytes:
    """Remove the FD that follows each FF FF FD."""
    return body.replace(b"\xff\xff\xfd\xfd", b"\xff\xff\xfd")


def frame(servo: int, body: bytes) -> bytes:
    """Pack an instruction with parameters, or a status, into a packet."""
    stuffed = stuff(body)
    return sealed(PACKET_HEADER + bytes([servo]) + (len(stuffed) + 2).to_bytes(2, "little") + stuffed)


def instruct(servo: int, instruction: int, parameters: bytes = b"") -> bytes:
    """Make an instruction packet."""
    return frame(servo, bytes([instruction]) + parameters)


def status(servo: int, error: int, parameters: bytes = b"") -> bytes:
    """Make a status packet."""
    return frame(servo, bytes([STATUS, error]) + parameters)


@dataclass(frozen=True)
class Packet:
    """Received packet."""

    servo: int
    instruction: int
    parameters: bytes
    intact: bool  # whether the CRC is correct


class Decoder:
    """Decoder that finds packets in a stream of bytes."""

    def __init__(self) -> None:
        self._heard, self._last = b"", 0.0

    def feed(self, data: bytes, time: float = 0.0) -> list[Packet]:
        """Return the packets completed by the given bytes.

        Half a packet is forgotten after a silence.
        """
        if time - self._last > MAX_SILENCE:
            self._heard = b""
        self._last = time
        self._heard += data
        results: list[Packet] = []
        while (packet := self._next()) is not None:
            results.append(packet)
        return results

    def _next(self) -> Packet | None:
        while True:
            begin = self._heard.find(PACKET_HEADER)
            if begin < 0:
                self._heard = self._heard[-3:]
                return None
            heard = self._heard = self._heard[begin:]
            if len(heard) < 7:
                return None
            size = int.from_bytes(heard[5:7], "little")
            if not 3 <= size <= MAX_LENGTH:
                self._heard = heard[1:]
                continue
            if len(heard) < 7 + size:
                return None
            whole, self._heard = heard[: 7 + size], heard[7 + size :]
            body = unstuff(whole[7:-2])
            intact = crc(whole[:-2]) == int.from_bytes(whole[-2:], "little")
            return Packet(whole[4], body[0], body[1:], intact)
