"""Protocol 1.0 frames, compared byte by byte with the manufacturers' manuals.

The manufacturers are ROBOTIS and Feetech.
"""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.hardware.protocol.frame import (
    FrameReader,
    bulk_read_frame,
    find_frames,
    frame,
    ping_frame,
    read_frame,
    split_frames,
    sync_read_frame,
    sync_write_frame,
    write_frame,
)
from kinesic.hardware.protocol.packet import BROADCAST_ID, Instruction

from ...naming import about

GOAL = bytes.fromhex("00 08 00 00 E8 03")  # goal 2048, time 0, speed 1000
DYNAMIXEL_ROWS = {
    0: bytes.fromhex("10 00 50 01"),
    1: bytes.fromhex("20 02 60 03"),
    2: bytes.fromhex("30 00 70 01"),
    3: bytes.fromhex("20 02 80 03"),
}
MANUAL_FRAMES = {  # hexadecimal bytes of the manuals -> encoded frame
    "FF FF 01 02 01 FB": ping_frame(1),
    "FF FF 01 02 00 FC": frame(1, 0),
    "FF FF 01 04 02 2B 01 CC": read_frame(1, 43, 1),
    "FF FF 01 03 00 20 DB": frame(1, 0, b"\x20"),
    "FF FF 00 02 06 F7": frame(0, Instruction.FACTORY_RESET),
    "FF FF FE 04 03 03 01 F6": write_frame(BROADCAST_ID, 3, b"\1"),
    "FF FF 00 05 04 1E F4 01 E3": frame(0, Instruction.REG_WRITE, bytes((0x1E, 0xF4, 0x01))),
    "FF FF FE 02 05 FA": frame(BROADCAST_ID, Instruction.ACTION),
    "FF FF FE 18 83 1E 04 00 10 00 50 01 01 20 02 60 03 02 30 00 70 01 03 20 02 80 03 12": sync_write_frame(
        0x1E, 4, DYNAMIXEL_ROWS
    ),
    "FF FF FE 09 92 00 02 01 24 02 02 24 17": bulk_read_frame((1, 2), 0x24, 2),
    "FF FF 01 04 00 00 80 7A": frame(1, 0, b"\0\x80"),
    "FF FF 01 02 24 D8": frame(1, 0x24),
    "FF FF 01 04 02 38 02 BE": read_frame(1, 0x38, 2),
    "FF FF 01 04 00 18 05 DD": frame(1, 0, b"\x18\x05"),
    "FF FF FE 04 03 05 01 F4": write_frame(BROADCAST_ID, 5, b"\1"),
    "FF FF 01 09 03 2A 00 08 00 00 E8 03 D5": write_frame(1, 0x2A, GOAL),
    "FF FF 01 09 04 2A 00 08 00 00 E8 03 D4": frame(1, Instruction.REG_WRITE, b"\x2a" + GOAL),
    "FF FF FE 20 83 2A 06 01 00 08 00 00 E8 03 02 00 08 00 00 E8 03 03 00 08 00 00 E8 03 04 00 08 00 00 E8 03 58": (
        sync_write_frame(0x2A, 6, dict.fromkeys((1, 2, 3, 4), GOAL))
    ),
    "FF FF FE 06 82 38 08 01 02 36": sync_read_frame((1, 2), 0x38, 8),
    "FF FF 01 04 03 37 00 C0": write_frame(1, 55, b"\0"),
    "FF FF 01 02 08 F4": frame(1, Instruction.REBOOT),
}


def test_twenty_one_encoded_protocol_1_frames_equal_those_printed_in_the_manuals():
    assert len(MANUAL_FRAMES) == 21
    for text, encoded in MANUAL_FRAMES.items():
        with about(text):
            expected = bytes.fromhex(text)
            assert sum(expected[2:]) & 0xFF == 0xFF  # the checksum completes the sum of all bytes after the header
            assert encoded == expected


def test_protocol_1_frames_are_found_between_noise_and_truncated_frames():
    one, two = frame(1, 0, b"\xff\xff\x01\x02"), frame(2, 0x20, b"\x05")
    found = list(find_frames(b"\x00\xff" + one + one[:5] + two + b"\xff\xff"))
    assert [(packet.id, packet.instruction, packet.parameters) for packet, _ in found] == [
        (1, 0, b"\xff\xff\x01\x02"),
        (2, 0x20, b"\x05"),
    ]
    wrong = bytearray(one)
    wrong[-1] ^= 1
    assert list(find_frames(bytes(wrong))) == []


@given(
    st.lists(st.tuples(st.integers(0, 253), st.integers(0, 255), st.binary(max_size=20)), max_size=6), st.integers(1, 9)
)
def test_protocol_1_reader_yields_all_frames_for_any_division_of_a_stream(sent, size: int):
    stream = b"".join(frame(*each) for each in sent)
    reader = FrameReader()
    pieces = [stream[k : k + size] for k in range(0, len(stream), size)]
    read = [(p.id, p.instruction, p.parameters) for piece in pieces for p in reader.feed(piece)]
    assert read == sent
    assert list(split_frames(stream)) == [frame(*each) for each in sent]


def test_long_protocol_1_sync_write_is_divided_into_frames_of_up_to_250_bytes():
    data = sync_write_frame(42, 2, dict.fromkeys(range(100), b"\x00\x00"))
    sizes = [len(packet.parameters) for packet, _ in find_frames(data)]
    assert sizes == [2 + 3 * 82, 2 + 3 * 18]


def test_invalid_protocol_1_frames_are_refused():
    for call, message in (
        (lambda: frame(255, 1), "id is 255"),
        (lambda: frame(1, 1, bytes(251)), "251 bytes of parameters"),
        (lambda: sync_write_frame(42, 2, {1: b"\0"}), "row of 1 bytes, must be 2"),
    ):
        with about(message), pytest.raises(ValueError, match=message):
            call()
