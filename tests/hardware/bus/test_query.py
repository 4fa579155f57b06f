import numpy as np
import pytest

from kinesic.hardware.bus.cycle import (
    BLOCK_DTYPE,
    CELL_CONTENTS,
    FIELD_NAMES,
    RECORD_ADDRESSES,
    RECORD_DTYPE,
    RECORD_REGISTERS,
    RECORD_SIZE,
    signature,
)
from kinesic.hardware.bus.query import HEADER_SIZE, FastQuery, PlainQuery, make_query
from kinesic.hardware.protocol.packet import BROADCAST_ID, PACKET_HEADER, Instruction, Reader, crc16, status

SERVO_IDS = tuple(range(1, 15))
FAST_QUERY = FastQuery(SERVO_IDS, (224,) * 14)
RECORDS = [bytes(np.random.default_rng(k).integers(0, 256, RECORD_SIZE, dtype=np.uint8)) for k in SERVO_IDS]
BLOCK_SIZE = BLOCK_DTYPE.itemsize


def joint() -> bytes:
    length = 1 + BLOCK_SIZE * len(SERVO_IDS)
    raw = bytearray(PACKET_HEADER + bytes((BROADCAST_ID, length & 0xFF, length >> 8, Instruction.STATUS)))
    for servo, record in zip(SERVO_IDS, RECORDS, strict=True):
        raw += bytes((0, servo)) + record
        raw += crc16(raw).to_bytes(2, "little")
    return bytes(raw)


WHOLE_REPLY = joint()  # bytes of an undamaged fast reply of all servos


def found(raw: bytes) -> list[int]:
    """Check the values of read records, and return the servos' indices."""
    answer = FAST_QUERY.parse(raw)
    for k in np.flatnonzero(answer.received):
        assert answer.blocks[k].tobytes()[2:20] == RECORDS[k]
    return [SERVO_IDS[k] for k in np.flatnonzero(answer.received)]


def without(*servos: int) -> list[int]:
    return [servo for servo in SERVO_IDS if servo not in servos]


def test_servo_record_consists_of_eighteen_bytes_of_status_registers():
    assert RECORD_SIZE == 18
    assert (64, 70, 98, 120, 121, 126, 127, *range(128, 136), 144, 145, 146) == RECORD_ADDRESSES
    assert b"".join(address.to_bytes(2, "little") for address in RECORD_ADDRESSES) == CELL_CONTENTS
    assert RECORD_DTYPE.names == FIELD_NAMES
    assert [RECORD_DTYPE[name].itemsize for name in FIELD_NAMES] == [
        register.field.size for register in RECORD_REGISTERS
    ]


def test_query_and_reply_lengths_match_the_protocol():
    assert len(FAST_QUERY.data) == 14 + 14
    assert FAST_QUERY.length == 8 + 14 * (18 + 4)
    assert PlainQuery(SERVO_IDS, (224,) * 14).length == 14 * (11 + 18)


def test_models_with_different_indirect_addresses_are_queried_in_one_packet():
    mixed = FastQuery((1, 2), (224, 208))
    (asked,) = Reader().feed(mixed.data)
    assert asked.instruction == Instruction.FAST_BULK_READ
    assert asked.parameters == bytes((1, 224, 0, 18, 0, 2, 208, 0, 18, 0))
    (asked,) = Reader().feed(PlainQuery((1, 2), (224, 208)).data)
    assert asked.instruction == Instruction.BULK_READ


def test_plain_query_of_one_servo_is_a_read_instruction():
    (asked,) = Reader().feed(PlainQuery((5,), (224,)).data)
    assert (asked.id, asked.instruction, asked.parameters) == (5, Instruction.READ, bytes((224, 0, 18, 0)))


def test_fast_query_is_used_for_several_servos_if_enabled_but_not_for_a_single_servo():
    servos, addresses = (1, 2), (224, 208)
    assert make_query(servos, addresses, fast=True).data == FastQuery(servos, addresses).data
    assert make_query(servos, addresses, fast=False).data == PlainQuery(servos, addresses).data
    assert make_query((5,), (224,), fast=True).data == PlainQuery((5,), (224,)).data


def test_intact_reply_of_several_servos_is_parsed_completely():
    answer = FAST_QUERY.parse(WHOLE_REPLY)
    assert answer.whole
    assert found(WHOLE_REPLY) == list(SERVO_IDS)
    assert not answer.blocks.flags.writeable


def test_changed_byte_in_a_fast_reply_loses_only_the_servo_block_that_contains_the_byte():
    for servo in SERVO_IDS:
        raw = bytearray(WHOLE_REPLY)
        raw[HEADER_SIZE + BLOCK_SIZE * (servo - 1) + 7] ^= 0x10
        assert found(bytes(raw)) == without(servo)


def test_lost_byte_in_a_fast_reply_loses_only_the_servo_block_that_contained_the_byte():
    for servo in SERVO_IDS:
        at = HEADER_SIZE + BLOCK_SIZE * (servo - 1) + 7
        assert found(WHOLE_REPLY[:at] + WHOLE_REPLY[at + 1 :]) == without(servo)


def test_truncated_servo_block_in_a_fast_reply_loses_at_most_the_next_block_too():
    at = HEADER_SIZE + BLOCK_SIZE * 4
    for kept in range(BLOCK_SIZE):
        assert found(WHOLE_REPLY[: at + kept] + WHOLE_REPLY[at + BLOCK_SIZE :]) in (without(5), without(5, 6))


def test_noise_and_repeated_blocks_in_a_fast_reply_lose_no_other_servo_block():
    at = HEADER_SIZE + BLOCK_SIZE * 4
    assert found(WHOLE_REPLY[:at] + b"\x11\x22\x33\x44\x55\x66\x77\x88" + WHOLE_REPLY[at:]) == list(SERVO_IDS)
    assert found(WHOLE_REPLY[: at + BLOCK_SIZE] + WHOLE_REPLY[at:]) == list(SERVO_IDS)


def test_servo_blocks_before_a_silent_servo_in_a_fast_reply_are_accepted():
    assert found(WHOLE_REPLY[: HEADER_SIZE + BLOCK_SIZE * 4]) == [1, 2, 3, 4]
    assert found(WHOLE_REPLY[:5]) == []
    assert found(b"") == []


@pytest.mark.parametrize("noise", [b"\xff\xff\xfd", b"\x00" * 20, WHOLE_REPLY[:40]])
def test_noise_bytes_before_a_bus_reply_are_skipped(noise: bytes):
    assert FAST_QUERY.parse(noise + WHOLE_REPLY).whole


def test_damaged_header_of_a_fast_reply_loses_no_servo_block():
    for k in range(HEADER_SIZE):
        raw = bytearray(WHOLE_REPLY)
        raw[k] ^= 0xFF
        assert found(bytes(raw)) == list(SERVO_IDS)
        assert found(WHOLE_REPLY[:k] + WHOLE_REPLY[k + 1 :]) == list(SERVO_IDS)


def test_end_of_a_bus_reply_with_lost_bytes_is_detected():
    assert FAST_QUERY.is_complete(WHOLE_REPLY)
    assert FAST_QUERY.is_complete(WHOLE_REPLY[:50] + WHOLE_REPLY[60:])
    assert not FAST_QUERY.is_complete(WHOLE_REPLY[:-1])
    assert not FAST_QUERY.is_complete(WHOLE_REPLY[:-BLOCK_SIZE])
    assert not FAST_QUERY.is_complete(WHOLE_REPLY[:-1] + b"\0")
    assert not FAST_QUERY.is_complete(b"")


def test_expected_bus_reply_is_found_behind_a_reply_of_other_servos():
    other = bytearray(WHOLE_REPLY)
    other[HEADER_SIZE + 1] = 99
    answer = FAST_QUERY.parse(bytes(other) + WHOLE_REPLY)
    assert answer.whole
    assert answer.end == len(other) + len(WHOLE_REPLY)


def test_end_of_a_damaged_bus_reply_is_predicted():
    at = HEADER_SIZE + BLOCK_SIZE * 4
    assert FAST_QUERY.parse(WHOLE_REPLY[: at + 30]).end == len(WHOLE_REPLY)
    assert (
        FAST_QUERY.parse(WHOLE_REPLY[: at + BLOCK_SIZE] + WHOLE_REPLY[at : at + 60]).end
        == len(WHOLE_REPLY) + BLOCK_SIZE
    )
    assert FAST_QUERY.parse(WHOLE_REPLY[:-1] + b"\0").end == len(WHOLE_REPLY)


def test_block_of_a_fast_reply_with_the_id_of_an_unqueried_servo_is_ignored():
    assert found(WHOLE_REPLY.replace(bytes((0, 3)) + RECORDS[2], bytes((0, 77)) + RECORDS[2])) == without(3)


def test_status_packets_of_wrong_length_or_unqueried_servos_are_ignored():
    question = PlainQuery((1, 2, 3), (224,) * 3)
    raw = status(1, 0x80, RECORDS[0]) + status(2, 0, b"\x05") + status(9, 0, RECORDS[2])
    answer = question.parse(raw)
    assert answer.received.tolist() == [True, False, False]
    assert answer.blocks["error"][0] == 0x80
    assert not answer.whole


def test_signature_of_servo_records_depends_on_errors_torque_and_temperature_but_not_on_motion():
    blocks = np.zeros(3, BLOCK_DTYPE)
    same = signature(blocks)
    for name in ("tick", "current", "velocity", "position", "volts"):
        blocks[name] = 7
        assert signature(blocks) == same
    for name in ("error", "hardware_error", "watchdog", "torque", "temperature"):
        changed = blocks.copy()
        changed[name][1] = 7
        assert signature(changed) != same
