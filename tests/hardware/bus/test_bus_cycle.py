"""Bus cycles on the wire: writes, queried servos and end times."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from kinesic.hardware.bus.bus import Bus
from kinesic.hardware.bus.cycle import RECORD_SIZE, signature
from kinesic.hardware.bus.dialect import Servo
from kinesic.hardware.bus.late_replies import MAX_STALE_CYCLES
from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.registers import HardwareError, Register
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.virtual.faults import FaultPlan, PlannedFault
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus

from ..conftest import Rig, rig_of
from .test_bus import on_kinesic_servos

Make = Callable[..., Rig]
BYTE_TIME = 1e-5  # [s] transmission time of a byte at 1 Mbit/s


def overhear(made: Rig) -> list[bytes]:
    """Collect all bytes that are written to the wire from now on."""
    written: list[bytes] = []
    write = made.wire.write

    def overheard(data: bytes) -> None:
        written.append(bytes(data))
        write(data)

    made.wire.write = overheard
    return written


def asked(written: list[bytes], servos: tuple[int, ...]) -> int:
    """Count the queries to exactly the given servos."""
    cells = SERVO_MODELS["xm430_w350"].cells[0].data
    question = packet.sync_read(servos, cells, RECORD_SIZE, fast=True) if len(servos) > 1 else None
    return written.count(question or packet.read_packet(servos[0], cells, RECORD_SIZE))


def test_queued_register_writes_are_sent_once_before_servo_goals(rig: Make):
    made = rig(2)
    written = overhear(made)
    made.bus.put(Register.PROFILE_VELOCITY, {1: 100, 2: 200})
    made.bus.put(Register.GOAL_PWM, {2: 50})
    made.run(2, np.array([1000, 2000]))
    puts = packet.sync_write(112, 4, {1: (100).to_bytes(4, "little"), 2: (200).to_bytes(4, "little")})
    puts += packet.sync_write(100, 2, {2: (50).to_bytes(2, "little")})
    goals = packet.sync_write(116, 4, {1: (1000).to_bytes(4, "little"), 2: (2000).to_bytes(4, "little")})
    question = packet.sync_read([1, 2], SERVO_MODELS["xm430_w350"].cells[0].data, RECORD_SIZE, fast=True)
    assert written == [puts + goals + question, goals + question]


def test_several_silent_servos_are_queried_in_turn(rig: Make):
    made = rig(7)
    for place in (1, 4):
        made.plant.servos[place].mute = True
    made.run(20)
    written = overhear(made)
    made.run(40)
    often = [asked(written, (servo,)) for servo in (2, 5)]
    assert min(often) > 10
    assert abs(often[0] - often[1]) <= 1
    made.plant.servos[4].mute = False
    events = [event for cycle in made.run(10) for event in cycle.events]
    assert [(event.kind, event.servo) for event in events] == [("heard", 5)]


@on_kinesic_servos
def test_silent_servo_is_queried_every_tenth_of_a_second_without_spare_time(rig: Make):
    made = rig(14, period=0.0055)
    made.plant.servos[4].mute = True
    made.run(100)
    written = overhear(made)
    made.run(100)
    assert asked(written, (5,)) in (5, 6)  # in 0.55 s


def test_reopening_of_a_lost_port_is_tried_at_most_twenty_times_a_second(rig: Make):
    made = rig(2, faults=FaultPlan((PlannedFault("unplug", start=0.3, seconds=5.0),)))
    made.run(50)
    looks: list[float] = []
    reopen = made.wire.reopen

    def looked() -> bool:
        looks.append(made.wire.now())
        return reopen()

    made.wire.reopen = looked
    assert all(cycle.lost for cycle in made.run(100))
    assert len(looks) in range(16, 21)
    assert np.diff(looks).min() > 0.049


def test_port_closed_after_a_servo_mismatch_is_reopened_after_one_second(rig: Make):
    made = rig(2)
    made.run(3)
    closed: list[float] = []
    made.wire.close = lambda: closed.append(made.wire.now())
    began = made.wire.now()
    made.bus.drop(BusError("other servos stand there"))
    cycles = made.run(150)
    assert closed == [began]
    events = [event for cycle in cycles for event in cycle.events]
    assert [(event.kind, event.servo, event.text) for event in events] == [
        ("port lost", None, "other servos stand there"),
        ("port back", None, made.wire.name),
    ]
    lost = [cycle.time - began for cycle in cycles if cycle.lost]
    assert lost == pytest.approx([0.01 * k for k in range(len(lost))])
    assert lost[-1] == pytest.approx(1.05, abs=0.021)


@pytest.mark.parametrize(("period", "end"), [(0.005, 0.00475), (0.01, 0.0095), (0.1, 0.0995)])
def test_bus_cycle_ends_five_percent_but_at_most_half_a_millisecond_before_the_next_cycle(
    rig: Make, period: float, end: float
):
    """A cycle without queries listens until its end."""
    made = rig(1, period=period)
    made.run(3)
    made.bus._late._stale_cycles = MAX_STALE_CYCLES
    (cycle,) = made.run(1)
    assert cycle.duration == pytest.approx(end, abs=1e-9)


def test_bus_events_describe_error_and_torque_changes_with_their_time(rig: Make):
    made = rig(3)
    made.energise()
    made.plant.servos[1].electronics.fail(HardwareError.OVERLOAD.value)
    (cycle,) = made.run(1)
    assert {(event.kind, event.servo, event.text) for event in cycle.events} == {
        ("error", 2, "hardware error 0x00 -> 0x20"),
        ("torque", 2, "off"),
    }
    assert all(cycle.time < event.time <= cycle.time + cycle.duration for event in cycle.events)
    assert not made.run(1)[0].events
    made.bus.put(Register.TORQUE_ENABLE, {1: 0})
    made.run(1)
    made.bus.put(Register.TORQUE_ENABLE, {1: 1})
    texts = [(event.kind, event.servo, event.text) for cycle in made.run(2) for event in cycle.events]
    assert texts[-1] == ("torque", 1, "on")


def test_bus_cycle_has_start_time_and_duration(rig: Make):
    made = rig(3)
    made.run(1)
    before = made.wire.now()
    cycle = made.bus.cycle()
    assert (cycle.time, cycle.time + cycle.duration) == pytest.approx((before, made.wire.now()))
    question = packet.sync_read([1, 2, 3], SERVO_MODELS["xm430_w350"].cells[0].data, RECORD_SIZE, fast=True)
    assert cycle.times == pytest.approx([before + len(question) * BYTE_TIME] * 3), "when it was out"
    assert cycle.signature == signature(cycle.records)


def test_port_that_is_lost_in_the_first_cycle_is_reopened_in_the_next():
    made = Cable("body", (ServoFitting(1),), faults=FaultPlan((PlannedFault("unplug", start=0.001, seconds=0.004),)))
    _, buses = build_bus([made])
    wire = MemoryWire(buses["body"])
    bus = Bus(wire, [Servo(1, SERVO_MODELS["xm430_w350"])])
    assert (bus.period, bus.fast, bus.servos[0].span) == (0.01, True, (0, 4095)), "if nobody says otherwise"
    assert bus.cycle().lost
    wire.sleep(bus.period)
    assert not bus.cycle().lost


@pytest.mark.parametrize(
    ("firmware", "baud", "period", "mute"),
    [
        (52, 1_000_000, 0.009, (3,)),
        (52, 1_000_000, 0.0075, (3,)),
        (52, 4_000_000, 0.006, (3,)),
        (41, 1_000_000, 0.0095, range(3, 15)),
        (41, 1_000_000, 0.009, range(3, 15)),
        (41, 1_000_000, 0.0085, range(3, 15)),
    ],
)
def test_repeated_query_asks_only_as_many_missing_servos_as_fit_into_the_cycle(
    rig: Make, firmware: int, baud: int, period: float, mute: Sequence[int]
):
    """Transmission time limits the number of servos per query."""
    made, byte = rig(20, baud=baud, period=period, firmware=firmware), 10 / baud
    made.run(30)
    for place in mute:
        made.plant.servos[place].mute = True
    said: list[tuple[float, float, bytes]] = []
    write, slack = made.wire.write, made.bus._listener.slack
    made.wire.write = lambda data: (said.append((made.wire.now(), slack.usual, data)), write(data))
    (cycle,) = made.run(1)
    (_, _, first), (time, usual, again), *_ = said
    fast, cells = made.bus.fast, made.bus.servos[0].cells
    assert first == packet.sync_read(range(1, 21), cells, RECORD_SIZE, fast=fast)
    left = cycle.time + max(0.95 * period, period - 0.0005) - time - usual
    room = max(1, int((left / byte - 22) / (23 if fast else 30)))
    later = [*range(5, 21 if fast else 16), 4][:room]
    assert again == (
        packet.sync_read(later, cells, RECORD_SIZE, fast=fast)
        if room > 1
        else packet.read_packet(later[0], cells, RECORD_SIZE)
    )


@pytest.mark.parametrize("mute", [(1,), (0, 1, 2)])
def test_missing_servo_is_queried_at_most_four_times_per_cycle(rig: Make, mute: tuple[int, ...]):
    made = rig(3, period=0.05)
    made.run(3)
    for place in mute:
        made.plant.servos[place].mute = True
    written = overhear(made)
    made.run(1)
    assert len(written) == 1 + 4


def test_bus_listener_keeps_only_the_bytes_of_the_last_reply(rig: Make):
    made = rig(3)
    made.run(5)
    assert len(made.bus._listener.received) == 8 + 3 * 22


def test_late_reply_that_arrives_during_a_repeated_query_is_accepted():
    made = rig_of(14, faults=FaultPlan((PlannedFault("late", start=0.6, seconds=0.0095, value=0.005),)))
    durations = []
    for _ in range(60):
        (cycle,) = made.run(1)
        assert cycle.fresh.all()
        assert made.bus._late._unfinished is None
        durations.append(cycle.duration)
    assert sum(duration > 0.006 for duration in durations) == 1, "one answer was late"


def silence(made: Rig, *places: int) -> None:
    """Make only the servos with the given indices silent from now on."""
    for place, servo in enumerate(made.plant.servos):
        servo.mute = place in places


def lose_question(made: Rig) -> None:
    """Make the next write to the wire lose its bytes."""
    write, lost = made.wire.write, [True]
    made.wire.write = lambda data: lost.pop() if lost else write(data)


def test_replies_count_as_lost_instead_of_late_if_a_repeated_query_recovers_them(rig: Make):
    made = rig(3, period=0.05)
    made.run(3)
    lose_question(made)
    made.bus._listener.replies_late = True
    assert made.run(1)[0].fresh.all()
    assert not made.bus._listener.replies_late


def test_replies_count_as_late_if_repeated_queries_recover_only_one_of_three_servos(rig: Make):
    """No reply is received before the queries are repeated, and then one of three."""
    made = rig(3, period=0.05)
    made.run(3)
    lose_question(made)
    silence(made, 0, 2)
    assert made.run(1)[0].fresh.tolist() == [False, True, False]
    assert made.bus._listener.replies_late


def test_replies_still_count_as_late_if_a_repeated_query_recovers_one_servo(rig: Make):
    made = rig(3, period=0.05)
    made.run(3)
    write, count = made.wire.write, [0]

    def speak(data: bytes) -> None:
        silence(made, *((2,) if not count[0] else ()))
        count[0] += 1
        write(data)

    made.wire.write = speak
    made.bus._listener.replies_late = True
    assert made.run(1)[0].fresh.all()
    assert count[0] == 2
    assert made.bus._listener.replies_late


def test_replies_no_longer_count_as_late_after_a_punctual_reply(rig: Make):
    made = rig(3)
    made.run(3)
    silence(made, 0, 1, 2)
    made.run(1)
    made.bus._listener.replies_late = True
    silence(made, 1)
    (cycle,) = made.run(1)
    assert cycle.fresh.any()
    assert not cycle.fresh.all()
    assert not made.bus._listener.replies_late


def test_reply_of_an_earlier_cycle_during_a_repeated_query_counts_as_late(rig: Make):
    """The last servo does not reply, and the late reply is 30 ms old."""
    made = rig(3)
    made.run(3)
    made.wire.write(made.bus._question.data)
    made.wire.sleep(made.wire.now() + 0.005)
    earlier = made.wire.read(made.wire.now())
    made.wire.sleep(made.wire.now() + 0.03)
    made.bus._accepted.begin()
    made.bus._listener.send(b"")
    made.bus._sent_at = made.bus._listener.sent_at
    made.bus._late.note_missed(made.bus._question)
    made.bus._listener.received = earlier[:-22]
    made.bus._look_again()
    assert not made.bus._accepted.fresh.any()
    assert made.bus._accepted.late.tolist() == [True, True, False]
