from collections.abc import Callable

import pytest

from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.packet import BROADCAST_ID, PACKET_HEADER, Instruction, crc16
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.virtual.bus import USB_PACKET_SIZE
from kinesic.hardware.virtual.faults import FaultPlan, PlannedFault
from kinesic.hardware.virtual.protocol import TURNAROUND_TIME
from kinesic.hardware.virtual.wiring import Cable, ServoFitting

from .conftest import Line

Lines = Callable[..., Line]
SERVO_IDS = tuple(range(1, 15))


def troubled(*faults: PlannedFault, count: int = 3, **changes: object) -> Line:
    fittings = tuple(ServoFitting(servo) for servo in range(1, count + 1))
    return Line(Cable("body", fittings, faults=FaultPlan(faults), **changes))


def blocks(reply: bytes, size: int) -> list[tuple[int, int, bytes]]:
    """Return error, id and data of each block of a combined reply of several servos.

    CRCs are checked.
    """
    assert reply.startswith(PACKET_HEADER + bytes((BROADCAST_ID,)))
    assert reply[7] == Instruction.STATUS
    servo_blocks = []
    for start in range(8, len(reply), size + 4):
        end = start + size + 4
        assert crc16(reply[: end - 2]) == int.from_bytes(reply[end - 2 : end], "little")
        servo_blocks.append((reply[start], reply[start + 1], reply[start + 2 : end - 2]))
    return servo_blocks


@pytest.mark.parametrize("baud", [57_600, 1_000_000, 4_000_000])
@pytest.mark.parametrize("count", [7, 14, 20, 26])
def test_bus_cycle_takes_transmission_time_plus_latency(count: int, baud: int):
    """For 10 bytes of each of 14 servos: 84 + 28 + 204 bytes, as in the table of wire limits."""
    line = troubled(count=count, baud=baud, latency=0.001)
    ids = list(range(1, count + 1))
    asked = packet.sync_write(116, 4, {servo: bytes(4) for servo in ids}) + packet.sync_read(ids, 126, 10, fast=True)
    line.wire.write(asked)
    got = b""
    while len(got) < 8 + 14 * count:
        got += line.wire.read(9.0)
    total = len(asked) + len(got)
    assert total == 14 + 5 * count + 14 + count + 8 + 14 * count
    full = min(USB_PACKET_SIZE, int(0.001 * baud / 10))  # [bytes] when its timer has run, or there is no more room
    waits = 0.001 if len(got) % full else 0.0  # a full piece goes at once
    assert line.wire.now() == pytest.approx(total * 10 / baud + waits + TURNAROUND_TIME, abs=1e-9)


def test_plain_sync_read_takes_its_transmission_time_and_one_turnaround_time_per_servo():
    line = troubled(count=7, latency=0.0)
    asked = packet.sync_read(list(range(1, 8)), 126, 10, fast=False)
    line.wire.write(asked)
    got = b""
    while len(got) < 7 * 21:
        got += line.wire.read(9.0)
    assert line.wire.now() == pytest.approx((len(asked) + len(got)) * 1e-5 + 7 * TURNAROUND_TIME)


def test_fast_read_is_one_reply_with_a_crc_of_all_preceding_bytes_after_each_servo(line: Lines):
    three = line(1, 2, 3)
    for servo, value in ((1, 0xFD), (2, 0), (3, 7)):
        three.set(Register.PROFILE_VELOCITY, value, servo=servo)
    three.plant.servos[0].memory.put(Register.PRESENT_CURRENT.field.address, b"\xff\xff")
    reply = three.bytes(packet.sync_read([1, 2, 3], 112, 4, fast=True))
    assert blocks(reply, 4) == [(0, 1, b"\xfd\0\0\0"), (0, 2, bytes(4)), (0, 3, b"\7\0\0\0")]
    assert reply[5] == 25, "as in the manual's example of three servos and four bytes"


def test_payloads_that_look_like_headers_are_stuffed_but_not_in_fast_replies(line: Lines):
    one = line()
    one.set(Register.GOAL_CURRENT, -1)
    one.bytes(packet.write_packet(1, 168, b"".join(a.to_bytes(2, "little") for a in (102, 103, 112, 113))))
    one.set(Register.PROFILE_VELOCITY, 0xFD)
    plain = one.bytes(packet.read_packet(1, 224, 4))
    assert plain[9:14] == b"\xff\xff\xfd\xfd\x00"
    fast = one.bytes(packet.sync_read([1], 224, 4, fast=True))
    assert blocks(fast, 4) == [(0, 1, b"\xff\xff\xfd\x00")]


def test_bulk_reads_and_writes_access_a_different_register_of_each_servo(line: Lines):
    two = line(1, 2)
    rows = bytes((1,)) + (65).to_bytes(2, "little") + b"\1\0" + b"\1"
    rows += bytes((2,)) + (112).to_bytes(2, "little") + b"\4\0" + (9).to_bytes(4, "little")
    assert two.ask(packet.packet(BROADCAST_ID, Instruction.BULK_WRITE, rows)) == []
    statuses = two.ask(packet.bulk_read({1: (65, 1), 2: (112, 4)}, fast=False))
    assert [(status.id, status.data) for status in statuses] == [(1, b"\1"), (2, b"\x09\0\0\0")]
    fast = two.bytes(packet.bulk_read({1: (65, 1), 2: (112, 4)}, fast=True))
    assert fast[9:11] == b"\1\1"
    assert crc16(fast[:-2]) == int.from_bytes(fast[-2:], "little")


def test_silent_servo_ends_a_fast_reply_but_not_plain_replies():
    line = troubled(PlannedFault("silent", servos=(2,)))
    line.pass_time(0.01)
    assert len(line.bytes(packet.sync_read([1, 2, 3], 132, 4, fast=True))) == 8 + 8
    assert [status.id for status in line.ask(packet.sync_read([1, 2, 3], 132, 4, fast=False))] == [1, 3]
    line.bytes(packet.write_packet(2, 65, b"\1"))
    assert line.plant.servos[1].memory[Register.LED] == 1, "it hears all the same"


def test_old_firmware_does_not_answer_fast_reads():
    line = troubled(PlannedFault("old_firmware"))
    assert line.bytes(packet.sync_read([1, 2], 132, 4, fast=True)) == b""
    assert len(line.ask(packet.sync_read([1, 2], 132, 4, fast=False))) == 2
    assert line.ask(packet.ping(1))[0].data[2] == 41


def test_replies_of_two_servos_with_one_id_collide():
    twins, strangers = (troubled(PlannedFault("duplicate_id", servos=(2,), value=value)) for value in (None, 1060))
    assert len(twins.ask(packet.ping(2))) == 1, "what two say alike is one answer"
    assert twins.ask(packet.read_packet(2, 132, 4)) == []
    assert len(twins.bytes(packet.read_packet(2, 132, 4))) == 15
    assert strangers.ask(packet.ping(2)) == []
    assert len(strangers.ask(packet.ping(1))) == 1


def test_planned_wrong_model_fault_changes_the_reported_model_number():
    line = troubled(PlannedFault("wrong_model", servos=(3,), value=1020 + 100))
    assert [status.data[:2] for status in line.ask(packet.ping(BROADCAST_ID))][2] == (1120).to_bytes(2, "little")


def test_servo_at_another_baud_rate_does_not_answer(line: Lines):
    one = line()
    one.set(Register.BAUD_RATE, 1)
    assert one.ask(packet.ping(1)) == []
    one.wire.baud = 57_600
    assert len(one.bytes(packet.ping(1), wait=0.02)) == 14


def test_late_replies_of_virtual_servos_keep_their_order():
    line = troubled(PlannedFault("late", servos=(1,), value=0.012))
    line.wire.write(packet.ping(1))
    assert line.wire.read(0.010) == b""
    line.wire.write(packet.ping(2))
    got = line.wire.read(0.1)
    assert line.wire.now() == pytest.approx(0.012 + 0.001 + 24e-5 + TURNAROUND_TIME)
    assert [status.id for status in packet.Reader().feed(got + line.wire.read(0.1))] == [1, 2]


def test_unplugged_port_raises_errors_until_it_is_reopened():
    line = troubled(PlannedFault("unplug", start=1.0, seconds=0.5))
    line.wire.write(packet.ping(1))
    assert line.wire.read(0.5)
    with pytest.raises(BusError, match="the port is gone"):
        line.wire.read(2.0)
    assert line.wire.now() == 1.0
    assert not line.wire.reopen()
    line.wire.sleep(1.6)
    with pytest.raises(BusError):
        line.wire.write(packet.ping(1))
    assert line.wire.reopen()
    assert len(line.ask(packet.ping(1))) == 1


def test_simultaneous_transmissions_destroy_packet_and_reply():
    """The second ping overlaps the reply except for its first byte."""
    line = troubled(latency=0.0)
    line.wire.write(packet.ping(1))
    line.wire.sleep(0.00013)
    line.wire.write(packet.ping(2))
    got = line.bytes(b"")
    assert got == packet.status(1, 0, b"\xfc\x03\x34")[:1] + packet.status(1, 0, b"\xfc\x03\x34")[11:]
    assert [status.id for status in line.ask(packet.ping(2))] == [2], "then all is well again"


def test_packets_written_to_the_virtual_bus_at_once_do_not_collide(line: Lines):
    one = line()
    one.wire.write(packet.sync_write(116, 4, {1: bytes(4)}))
    assert len(one.ask(packet.ping(1))) == 1


def test_virtual_bus_joins_a_packet_written_in_two_parts(line: Lines):
    one = line()
    data = packet.ping(1)
    assert one.bytes(data[:5]) == b""
    assert len(one.ask(data[5:])) == 1


def test_goals_written_with_a_query_take_effect_before_the_query(line: Lines):
    one = line()
    one.set(Register.TORQUE_ENABLE, 1)
    both = packet.sync_write(116, 4, {1: (2200).to_bytes(4, "little")}) + packet.read_packet(1, 116, 4)
    assert one.ask(both)[0].data == (2200).to_bytes(4, "little")


def test_servo_obeys_its_secondary_id_but_replies_only_to_its_primary_id(line: Lines):
    both = line(1, 2)
    both.set(Register.SECONDARY_ID, 1, servo=2)
    assert both.set(Register.LED, 1) == 0
    assert both.get(Register.LED, servo=2) == 1
    both.bytes(packet.sync_write(Register.LED.field.address, 1, {1: b"\0"}))
    assert [servo.memory[Register.LED] for servo in both.plant.servos] == [0, 0]
    assert len(both.ask(packet.ping(BROADCAST_ID))) == 2
