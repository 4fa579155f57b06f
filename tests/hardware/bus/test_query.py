import numpy as np
import pytest

from kinesic.hardware.bus.cycle import ADDRESSES, BLOCK, CELLS, HEALTH, NAMES, REGISTERS, SIZE, signature
from kinesic.hardware.bus.query import HEAD, FastQuery, PlainQuery
from kinesic.hardware.protocol.packet import BROADCAST, HEADER, Instruction, Reader, crc16, status

SERVOS = tuple(range(1, 15))
FAST = FastQuery(SERVOS, (224,) * 14)
RECORDS = [bytes(np.random.default_rng(k).integers(0, 256, SIZE, dtype=np.uint8)) for k in SERVOS]
BLOCK_SIZE = BLOCK.itemsize


def joint() -> bytes:
    length = 1 + BLOCK_SIZE * len(SERVOS)
    raw = bytearray(HEADER + bytes((BROADCAST, length & 0xFF, length >> 8, Instruction.STATUS)))
    for servo, record in zip(SERVOS, RECORDS, strict=True):
        raw += bytes((0, servo)) + record
        raw += crc16(raw).to_bytes(2, "little")
    return bytes(raw)


RAW = joint()


def found(raw: bytes) -> list[int]:
    """Servos whose records were read, and rightly."""
    answer = FAST.answer(raw)
    for k in np.flatnonzero(answer.found):
        assert answer.blocks[k].tobytes()[2:20] == RECORDS[k]
    return [SERVOS[k] for k in np.flatnonzero(answer.found)]


def without(*servos: int) -> list[int]:
    return [servo for servo in SERVOS if servo not in servos]


def test_the_record_is_eighteen_bytes_of_the_registers_that_tell_health():
    assert SIZE == 18
    assert (64, 70, 98, 120, 121, 126, 127, *range(128, 136), 144, 145, 146) == ADDRESSES
    assert b"".join(address.to_bytes(2, "little") for address in ADDRESSES) == CELLS
    assert HEALTH.names == NAMES
    assert [HEALTH[name].itemsize for name in NAMES] == [register.field.size for register in REGISTERS]


def test_lengths_are_those_of_the_wire():
    assert len(FAST.data) == 14 + 14
    assert FAST.length == 8 + 14 * (18 + 4)
    assert PlainQuery(SERVOS, (224,) * 14).length == 14 * (11 + 18)


def test_models_with_other_cells_are_asked_in_one_packet():
    mixed = FastQuery((1, 2), (224, 208))
    (asked,) = Reader().feed(mixed.data)
    assert asked.instruction == Instruction.FAST_BULK_READ
    assert asked.parameters == bytes((1, 224, 0, 18, 0, 2, 208, 0, 18, 0))
    (asked,) = Reader().feed(PlainQuery((1, 2), (224, 208)).data)
    assert asked.instruction == Instruction.BULK_READ


def test_a_single_servo_is_read_plainly():
    (asked,) = Reader().feed(PlainQuery((5,), (224,)).data)
    assert (asked.id, asked.instruction, asked.parameters) == (5, Instruction.READ, bytes((224, 0, 18, 0)))


def test_a_sound_answer_is_read_whole():
    answer = FAST.answer(RAW)
    assert answer.whole
    assert found(RAW) == list(SERVOS)
    assert not answer.blocks.flags.writeable


def test_a_changed_byte_costs_its_block():
    for servo in SERVOS:
        raw = bytearray(RAW)
        raw[HEAD + BLOCK_SIZE * (servo - 1) + 7] ^= 0x10
        assert found(bytes(raw)) == without(servo)


def test_a_lost_byte_costs_its_block():
    for servo in SERVOS:
        at = HEAD + BLOCK_SIZE * (servo - 1) + 7
        assert found(RAW[:at] + RAW[at + 1 :]) == without(servo)


def test_a_block_cut_short_costs_itself():
    at = HEAD + BLOCK_SIZE * 4
    for kept in range(BLOCK_SIZE):
        assert found(RAW[: at + kept] + RAW[at + BLOCK_SIZE :]) in (without(5), without(5, 6))


def test_noise_and_doubled_blocks_cost_nothing_but_what_they_hide():
    at = HEAD + BLOCK_SIZE * 4
    assert found(RAW[:at] + b"\x11\x22\x33\x44\x55\x66\x77\x88" + RAW[at:]) == list(SERVOS)
    assert found(RAW[: at + BLOCK_SIZE] + RAW[at:]) == list(SERVOS)


def test_what_the_chain_has_said_before_it_broke_counts():
    assert found(RAW[: HEAD + BLOCK_SIZE * 4]) == [1, 2, 3, 4]
    assert found(RAW[:5]) == []
    assert found(b"") == []


@pytest.mark.parametrize("noise", [b"\xff\xff\xfd", b"\x00" * 20, RAW[:40]])
def test_what_comes_before_the_answer_is_passed_over(noise: bytes):
    assert FAST.answer(noise + RAW).whole


def test_a_damaged_header_costs_the_header():
    for k in range(HEAD):
        raw = bytearray(RAW)
        raw[k] ^= 0xFF
        assert found(bytes(raw)) == list(SERVOS)
        assert found(RAW[:k] + RAW[k + 1 :]) == list(SERVOS)


def test_an_answer_that_has_lost_bytes_is_known_to_be_over():
    assert FAST.complete(RAW)
    assert FAST.complete(RAW[:50] + RAW[60:])
    assert not FAST.complete(RAW[:-1])
    assert not FAST.complete(RAW[:-BLOCK_SIZE])
    assert not FAST.complete(RAW[:-1] + b"\0")
    assert not FAST.complete(b"")


def test_an_answer_stands_behind_one_to_other_servos():
    other = bytearray(RAW)
    other[HEAD + 1] = 99
    answer = FAST.answer(bytes(other) + RAW)
    assert answer.whole
    assert answer.end == len(other) + len(RAW)


def test_where_a_damaged_answer_ends_is_foretold():
    at = HEAD + BLOCK_SIZE * 4
    assert FAST.answer(RAW[: at + 30]).end == len(RAW)
    assert FAST.answer(RAW[: at + BLOCK_SIZE] + RAW[at : at + 60]).end == len(RAW) + BLOCK_SIZE
    assert FAST.answer(RAW[:-1] + b"\0").end == len(RAW)


def test_servos_that_were_not_asked_are_not_heard():
    assert found(RAW.replace(bytes((0, 3)) + RECORDS[2], bytes((0, 77)) + RECORDS[2])) == without(3)


def test_plain_statuses_with_another_length_or_of_others_are_passed_over():
    question = PlainQuery((1, 2, 3), (224,) * 3)
    raw = status(1, 0x80, RECORDS[0]) + status(2, 0, b"\x05") + status(9, 0, RECORDS[2])
    answer = question.answer(raw)
    assert answer.found.tolist() == [True, False, False]
    assert answer.blocks["error"][0] == 0x80
    assert not answer.whole


def test_the_signature_changes_with_what_matters():
    blocks = np.zeros(3, BLOCK)
    same = signature(blocks)
    for name in ("tick", "current", "velocity", "position", "volts"):
        blocks[name] = 7
        assert signature(blocks) == same
    for name in ("error", "hardware_error", "watchdog", "torque", "temperature"):
        changed = blocks.copy()
        changed[name][1] = 7
        assert signature(changed) != same
