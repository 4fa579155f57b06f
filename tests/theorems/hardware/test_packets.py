"""Properties of every packet and every split of the stream."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.hardware.bus.cycle import BLOCK_DTYPE, RECORD_SIZE
from kinesic.hardware.bus.goals import GoalFrame
from kinesic.hardware.bus.query import FastQuery, PlainQuery
from kinesic.hardware.protocol.crc import advance_crcs, byte_contributions, crc_contributions
from kinesic.hardware.protocol.packet import (
    BROADCAST_ID,
    PACKET_HEADER,
    Instruction,
    Packet,
    Reader,
    crc16,
    packet,
    stuff,
    sync_write,
    unstuff,
)

SERVO_IDS = st.integers(0, 252)
# packet contents that often need byte stuffing
STUFFED_BODIES = st.lists(st.sampled_from([0xFF, 0xFF, 0xFD, 0xFD, 0x00, 0x55]), max_size=60).map(bytes)
PACKET_BODIES = st.binary(max_size=80) | STUFFED_BODIES
INSTRUCTION_KINDS = st.sampled_from([kind for kind in Instruction if kind != Instruction.STATUS])
SAMPLE_SIZE, SOAK_SIZE = 2_000, 100_000


@given(PACKET_BODIES)
def test_byte_unstuffing_inverts_byte_stuffing(body: bytes):
    assert unstuff(stuff(body)) == body
    assert PACKET_HEADER not in stuff(body)


@given(st.lists(st.tuples(SERVO_IDS, INSTRUCTION_KINDS, PACKET_BODIES), max_size=6), st.data())
def test_servo_packets_are_decoded_for_any_split_of_the_byte_stream(
    asked: list[tuple[int, Instruction, bytes]], data: st.DataObject
):
    stream = b"".join(packet(*one) for one in asked)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=5)))
    reader = Reader()
    pieces = [stream[a:b] for a, b in zip([0, *cuts], [*cuts, len(stream)], strict=True)]
    assert [item for piece in pieces for item in reader.feed(piece)] == [Packet(*one) for one in asked]


@given(SERVO_IDS, PACKET_BODIES, st.integers(0, 1000), st.integers(1, 255))
def test_servo_packet_with_a_changed_byte_is_rejected(servo: int, body: bytes, where: int, change: int):
    whole = bytearray(packet(servo, Instruction.WRITE, body))
    whole[where % len(whole)] ^= change
    assert list(Reader().feed(bytes(whole))) == []


@given(st.binary(max_size=30).filter(lambda noise: b"\xff" not in noise), SERVO_IDS, PACKET_BODIES)
def test_servo_packet_after_noise_bytes_is_decoded(noise: bytes, servo: int, body: bytes):
    assert list(Reader().feed(noise + packet(servo, Instruction.READ, body))) == [Packet(servo, 2, body)]


@given(st.binary(min_size=1, max_size=60), st.integers(0, 0xFFFF))
def test_packet_crc_by_table_equals_packet_crc_by_bits(data: bytes, before: int):
    table = byte_contributions(len(data))
    own = np.bitwise_xor.reduce([table[k, byte] for k, byte in enumerate(data)])
    assert own == crc16(data)
    chained = int(crc_contributions(len(data))[before]) ^ int(own)
    assert chained == crc16(data, crc16(before.to_bytes(2, "little"), before))
    assert advance_crcs(np.array([before], dtype=np.uint16), data[0])[0] == crc16(data[:1], before)


SERVO_RECORDS = st.binary(min_size=RECORD_SIZE, max_size=RECORD_SIZE) | st.lists(
    st.sampled_from([0xFF, 0xFD, 0x00]), min_size=RECORD_SIZE, max_size=RECORD_SIZE
).map(bytes)
SERVO_LISTS = st.lists(SERVO_IDS, min_size=2, max_size=28, unique=True)


def joint(servos: list[int], records: list[bytes], errors: list[int]) -> bytes:
    """Return the combined reply of several servos to a fast read."""
    length = 1 + BLOCK_DTYPE.itemsize * len(servos)
    answer = bytearray(PACKET_HEADER + bytes((BROADCAST_ID, length & 0xFF, length >> 8, Instruction.STATUS)))
    for servo, record, error in zip(servos, records, errors, strict=True):
        answer += bytes((error, servo)) + record
        answer += crc16(answer).to_bytes(2, "little")
    return bytes(answer)


@given(SERVO_LISTS, st.data())
def test_fast_read_answer_is_decoded(servos: list[int], data: st.DataObject):
    records = [data.draw(SERVO_RECORDS) for _ in servos]
    question = FastQuery(tuple(servos), (224,) * len(servos))
    raw = joint(servos, records, [0] * len(servos))
    assert len(raw) == question.length
    answer = question.parse(raw)
    assert answer.whole
    assert [block.tobytes()[2:20] for block in answer.blocks] == records
    assert question.is_complete(raw)


@given(SERVO_LISTS, st.integers(0, 1000), st.integers(1, 255), st.data())
def test_changed_byte_in_a_fast_answer_loses_at_most_two_records(
    servos: list[int], where: int, change: int, data: st.DataObject
):
    records = [data.draw(st.binary(min_size=RECORD_SIZE, max_size=RECORD_SIZE)) for _ in servos]
    raw = bytearray(joint(servos, records, [0] * len(servos)))
    raw[where % len(raw)] ^= change
    answer = FastQuery(tuple(servos), (224,) * len(servos)).parse(bytes(raw))
    assert answer.received.sum() >= len(servos) - 2
    for block, result, record in zip(answer.blocks, answer.received, records, strict=True):
        assert not result or block.tobytes()[2:20] == record


@given(st.lists(st.integers(1, 250), min_size=1, max_size=20, unique=True), st.data())
def test_separate_status_packets_of_several_servos_are_decoded(servos: list[int], data: st.DataObject):
    records = [data.draw(SERVO_RECORDS) for _ in servos]
    raw = b"".join(packet(s, Instruction.STATUS, b"\0" + r) for s, r in zip(servos, records, strict=True))
    answer = PlainQuery(tuple(servos), (224,) * len(servos)).parse(raw)
    assert answer.whole
    assert [block.tobytes()[2:20] for block in answer.blocks] == records


@given(SERVO_LISTS, st.data())
def test_packet_with_the_goals_of_all_servos_is_a_sync_write(servos: list[int], data: st.DataObject):
    frame = GoalFrame(servos)
    for _ in range(3):
        goals = np.array([data.draw(st.integers(-10, 5000)) for _ in servos])
        kept = np.clip(goals, 0, 4095)
        rows = {servo: int(goal).to_bytes(4, "little") for servo, goal in zip(servos, kept, strict=True)}
        assert frame.fill(goals) == sync_write(116, 4, rows)


def _round_trips(count: int) -> None:
    rng = np.random.default_rng(6)
    reader = Reader()
    for _ in range(count):
        size = int(rng.integers(0, 60))
        pool = rng.integers(0, 256, size) if rng.random() < 0.5 else rng.choice([0xFF, 0xFD, 0x00], size)
        body, servo = bytes(pool.astype(np.uint8)), int(rng.integers(0, 253))
        noise = bytes(rng.integers(0, 0xFE, int(rng.integers(0, 4))).astype(np.uint8))
        assert list(reader.feed(noise + packet(servo, Instruction.WRITE, body))) == [Packet(servo, 3, body)]


def test_encoded_random_servo_packets_are_decoded_unchanged():
    _round_trips(SAMPLE_SIZE)


@pytest.mark.soak
def test_100000_encoded_random_servo_packets_are_decoded_unchanged():
    _round_trips(SOAK_SIZE)
