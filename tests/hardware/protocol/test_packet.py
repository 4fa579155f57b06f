import tracemalloc

import dynamixel_sdk.protocol2_packet_handler as sdk_packets
import pytest
from dynamixel_sdk import Protocol2PacketHandler

from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.packet import (
    ALERT_BIT,
    BROADCAST_ID,
    MAX_LENGTH,
    PACKET_HEADER,
    PACKET_OVERHEAD,
    STATUS_OVERHEAD,
    Fault,
    Instruction,
    Packet,
    Reader,
    crc16,
    stuff,
    unstuff,
)

MANUAL = {  # examples of the public manual (Protocol 2.0)
    "ping": (packet.ping(1), "ff ff fd 00 01 03 00 01 19 4e"),
    "ping to all": (packet.ping(254), "ff ff fd 00 fe 03 00 01 31 42"),
    "status of a ping": (packet.status(1, 0, bytes((6, 4, 0x26))), "ff ff fd 00 01 07 00 55 00 06 04 26 65 5d"),
    "status of the second": (packet.status(2, 0, bytes((6, 4, 0x26))), "ff ff fd 00 02 07 00 55 00 06 04 26 6f 6d"),
    "read": (packet.read_packet(1, 132, 4), "ff ff fd 00 01 07 00 02 84 00 04 00 1d 15"),
    "status of a read": (packet.status(1, 0, bytes((0xA6, 0, 0, 0))), "ff ff fd 00 01 08 00 55 00 a6 00 00 00 8c c0"),
    "write": (
        packet.write_packet(1, 116, (512).to_bytes(4, "little")),
        "ff ff fd 00 01 09 00 03 74 00 00 02 00 00 ca 89",
    ),
    "status of a write": (packet.status(1, 0), "ff ff fd 00 01 04 00 55 00 a1 0c"),
    "reg write": (
        packet.packet(1, Instruction.REG_WRITE, bytes((104, 0, 200, 0, 0, 0))),
        "ff ff fd 00 01 09 00 04 68 00 c8 00 00 00 ae 8e",
    ),
    "action": (packet.packet(1, Instruction.ACTION), "ff ff fd 00 01 03 00 05 02 ce"),
    "factory reset": (packet.packet(1, Instruction.FACTORY_RESET, b"\1"), "ff ff fd 00 01 04 00 06 01 a1 e6"),
    "reboot": (packet.packet(1, Instruction.REBOOT), "ff ff fd 00 01 03 00 08 2f 4e"),
    "clear": (
        packet.packet(1, Instruction.CLEAR, bytes((1, 0x44, 0x58, 0x4C, 0x22))),
        "ff ff fd 00 01 08 00 10 01 44 58 4c 22 b1 dc",
    ),
    "sync read": (
        packet.sync_read([1, 2], 132, 4, fast=False),
        "ff ff fd 00 fe 09 00 82 84 00 04 00 01 02 ce fa",
    ),
    "fast sync read": (
        packet.sync_read([1, 2], 580, 4, fast=True),
        "ff ff fd 00 fe 09 00 8a 44 02 04 00 01 02 72 f2",
    ),
    "sync write": (
        packet.sync_write(116, 4, {1: bytes((150, 0, 0, 0)), 2: bytes((170, 0, 0, 0))}),
        "ff ff fd 00 fe 11 00 83 74 00 04 00 01 96 00 00 00 02 aa 00 00 00 82 87",
    ),
    "bulk read": (
        packet.bulk_read({1: (144, 2), 2: (146, 1)}, fast=False),
        "ff ff fd 00 fe 0d 00 92 01 90 00 02 00 02 92 00 01 00 1a 05",
    ),
}


NUMBERS = {  # instruction and fault codes of the manual
    Instruction: (0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x08, 0x10, 0x20, 0x55, 0x82, 0x83, 0x8A, 0x92, 0x93, 0x9A),
    Fault: (0, 1, 2, 3, 4, 5, 6, 7),
}


@pytest.mark.parametrize("example", MANUAL)
def test_encoded_packets_equal_those_of_the_manual(example: str):
    made, manual = MANUAL[example]
    assert made == bytes.fromhex(manual)
    (read,) = Reader().feed(made)
    assert read.id == made[4]
    assert read.instruction == made[7]
    assert read.parameters == made[8:-2]


@pytest.mark.parametrize("numbered", NUMBERS)
def test_instructions_and_faults_have_the_numbers_of_the_manual(numbered: type[Instruction | Fault]):
    assert tuple(numbered) == NUMBERS[numbered]


def test_fault_codes_and_alert_bit_equal_those_of_the_manufacturer_sdk():
    names = ("RESULT_FAIL", "INSTRUCTION", "CRC", "DATA_RANGE", "DATA_LENGTH", "DATA_LIMIT", "ACCESS")
    assert tuple(Fault)[1:] == tuple(getattr(sdk_packets, f"ERRNUM_{name}") for name in names)
    assert sdk_packets.ERRBIT_ALERT == ALERT_BIT == 0x80


def test_packet_without_parameters_is_as_long_as_the_packet_overhead():
    assert len(packet.ping(1)) == PACKET_OVERHEAD
    assert len(packet.status(1, 0)) == STATUS_OVERHEAD


def sealed_packet(servo: int, body: bytes) -> bytes:
    """Build a packet of any id and length with the right CRC, without byte stuffing."""
    head = PACKET_HEADER + bytes((servo,)) + (len(body) + 2).to_bytes(2, "little") + body
    return head + crc16(head).to_bytes(2, "little")


@pytest.mark.parametrize("servo", [0, 1, 252, BROADCAST_ID])
def test_ping_is_encoded_and_decoded_for_valid_and_broadcast_ids(servo: int):
    assert list(Reader().feed(packet.ping(servo))) == [Packet(servo, 1, b"")]


@pytest.mark.parametrize(
    "wrong",
    [
        sealed_packet(0xFD, b"\x01"),  # an id that no servo has
        sealed_packet(0xFF, b"\x01"),
        sealed_packet(1, b""),  # without an instruction
        sealed_packet(1, b"\x55"),  # a status without its error byte
        sealed_packet(1, bytes((3, *bytes(MAX_LENGTH - 2)))),  # longer than servos read
    ],
)
def test_invalid_packet_with_a_correct_crc_is_skipped(wrong: bytes):
    assert list(Reader().feed(wrong + packet.ping(1))) == [Packet(1, 1, b"")]


def test_longest_packet_is_read_and_written():
    longest = bytes(MAX_LENGTH - 2 - 1 - 2)  # without CRC, instruction and address
    made = packet.write_packet(1, 0, longest)
    assert made == sealed_packet(1, bytes((3, 0, 0)) + longest)
    assert list(Reader().feed(made)) == [Packet(1, 3, bytes(2) + longest)]
    with pytest.raises(ValueError, match=f"length {MAX_LENGTH + 1} is longer"):
        packet.write_packet(1, 0, longest + b"\0")


def test_packet_length_limit_includes_stuffing():
    marks = b"\xff\xff\xfd" * 300
    with pytest.raises(ValueError, match="longer than"):
        packet.write_packet(1, 0, marks)


def test_packet_reader_discards_noise_without_storing_it():
    """Bytes that cannot start a packet must not fill the memory."""
    reader, noise = Reader(), bytes(100_000)
    tracemalloc.start()
    for _ in range(20):
        assert list(reader.feed(noise)) == []
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 5 * len(noise)
    assert list(reader.feed(packet.ping(3))) == [Packet(3, 1, b"")]


def test_bytes_before_clearing_the_packet_reader_are_not_part_of_the_next_packet():
    reader, made = Reader(), packet.ping(3)
    assert list(reader.feed(made[:8])) == []
    reader.clear()
    assert list(reader.feed(made[8:])) == []
    assert list(reader.feed(made)) == [Packet(3, 1, b"")]


def test_truncated_packet_does_not_delay_the_next():
    """The next header ends a truncated packet before its announced length."""
    reader = Reader()
    cut = packet.write_packet(1, 0, bytes(200))[:11]
    assert list(reader.feed(cut + packet.ping(2))) == [Packet(2, 1, b"")]


def test_bytes_of_a_fast_reply_are_not_taken_as_byte_stuffing():
    """Bytes that look like a header inside a fast reply are data."""
    body = bytes((Instruction.STATUS, 0, 1)) + PACKET_HEADER + b"\xff\xff\xfd\xfd"
    joint, reader = sealed_packet(BROADCAST_ID, body), Reader()
    assert [item for byte in joint for item in reader.feed(bytes((byte,)))] == [Packet(BROADCAST_ID, 0x55, body[1:])]
    stuffed = b"\xff\xff\xfd\x01"
    for made in (packet.status(1, 0, stuffed), packet.sync_write(116, 4, {1: stuffed})):
        (result,) = Reader().feed(made)
        assert result.parameters.endswith(stuffed)
        assert len(result.parameters) == len(made) - PACKET_OVERHEAD - 1


def test_crc_of_a_fast_reply_covers_all_previous_bytes():
    # the manual's answer of three XC330 to a fast sync read
    first = bytes.fromhex("ff ff fd 00 fe 19 00 55 00 03 a6 00 00 00")
    second = bytes.fromhex("00 07 1f 08 00 00")
    assert crc16(first) == 0x0884
    assert crc16(second, crc16(b"\x84\x08", 0x0884)) == 0xCA16


def test_byte_unstuffing_inverts_stuffing():
    for body in (b"\xff\xff\xfd", b"\xff\xff\xfd\xfd", b"\xff\xff\xff\xfd\xff\xff\xfd", b"\xfd\xff\xff\xfd\xfd\xfd"):
        assert unstuff(stuff(body)) == body
    assert stuff(b"\xff\xff\xfd\x01") == b"\xff\xff\xfd\xfd\x01"


def test_data_that_looks_like_a_packet_header_arrives_unchanged():
    data = (-1).to_bytes(2, "little", signed=True) + (-3).to_bytes(4, "little", signed=True)
    (read,) = Reader().feed(packet.write_packet(1, 102, data))
    assert read.parameters == bytes((102, 0)) + data


def test_invalid_packets_in_a_byte_stream_are_skipped():
    good = packet.status(3, 0, b"\x01\x02")
    wrong = bytearray(packet.status(4, 0, b"\x01\x02"))
    wrong[-3] ^= 1
    stream = b"\xff\xff\xfd" + packet.ping(2)[:6] + good + bytes(wrong) + b"\xff\xff" + good
    reader = Reader()
    assert [item for byte in stream for item in reader.feed(bytes((byte,)))] == [Packet(3, 0x55, b"\0\1\2")] * 2
    assert list(reader.feed(stream)) == [Packet(3, 0x55, b"\0\1\2")] * 2


def test_packet_with_an_impossible_length_counts_as_noise():
    reader = Reader()
    assert list(reader.feed(b"\xff\xff\xfd\x00\x01\xff\xff" + packet.ping(1))) == [Packet(1, 1, b"")]
    assert list(reader.feed(b"\xff\xff\xfd\x00\x01\xfe\xff" + packet.ping(1))) == [Packet(1, 1, b"")]
    assert list(reader.feed(b"\xff\xff\xfd\x00\x01\x02\x00\x55" + packet.ping(1))) == [Packet(1, 1, b"")]


def test_status_packet_has_error_and_data():
    (status,) = Reader().feed(packet.status(9, ALERT_BIT | Fault.ACCESS, b"\x05"))
    assert (status.error, status.data) == (0x87, b"\x05")


@pytest.mark.parametrize("servo", [-1, 253, 255, 300])
def test_invalid_servo_id_is_refused(servo: int):
    with pytest.raises(ValueError, match="id is"):
        packet.ping(servo)


def test_too_long_packet_and_value_of_the_wrong_size_are_refused():
    with pytest.raises(ValueError, match="longer than"):
        packet.write_packet(1, 0, bytes(2000))
    with pytest.raises(ValueError, match="must be 4"):
        packet.sync_write(116, 4, {1: b"\0"})


@pytest.mark.parametrize("parameters", [b"", b"\x01", bytes(range(200)), b"\xff\xff\xfe\xfd", b"\xff\xfd"])
def test_packet_crc_equals_that_of_the_manufacturer_sdk(parameters: bytes):
    made = packet.packet(7, Instruction.WRITE, parameters)
    assert Protocol2PacketHandler().updateCRC(0, made, len(made) - 2) == int.from_bytes(made[-2:], "little")


class _Sent:
    """Port that records the bytes written by the SDK."""

    def __init__(self) -> None:
        self.is_using, self.data = False, b""

    def clearPort(self) -> None:  # noqa: N802  # the SDK's name
        self.data = b""

    def writePort(self, data: list[int]) -> int:  # noqa: N802  # the SDK's name
        self.data = bytes(data)
        return len(data)

    def setPacketTimeout(self, length: int) -> None:  # noqa: N802  # the SDK's name
        pass


def test_encoder_and_sdk_build_identical_packets_if_no_byte_needs_stuffing():
    port, sdk = _Sent(), Protocol2PacketHandler()
    sdk.writeTxOnly(port, 5, 116, 4, [1, 2, 3, 4])
    assert port.data == packet.write_packet(5, 116, bytes((1, 2, 3, 4)))
    port.is_using = False
    sdk.readTx(port, 5, 132, 4)
    assert port.data == packet.read_packet(5, 132, 4)
    for fast in (False, True):
        port.is_using = False
        sdk.syncReadTx(port, 224, 18, [1, 2, 3], 3, fast)
        assert port.data == packet.sync_read([1, 2, 3], 224, 18, fast=fast)
        port.is_using = False
        sdk.bulkReadTx(port, [1, 144, 0, 2, 0, 2, 146, 0, 1, 0], 10, fast)
        assert port.data == packet.bulk_read({1: (144, 2), 2: (146, 1)}, fast=fast)
