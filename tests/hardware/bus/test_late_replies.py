"""Late replies and drifted servo clocks, for the filter alone and on a bus."""

from collections.abc import Callable

import numpy as np
import pytest

from kinesic.hardware.bus.bounds import RecordBounds
from kinesic.hardware.bus.cycle import BLOCK_DTYPE, CELL_CONTENTS, Records
from kinesic.hardware.bus.late_replies import CLOCK_TOLERANCE, MAX_STALE_CYCLES, TRIAL_PAUSE, LateReplies
from kinesic.hardware.bus.listener import TIMEOUT_TUNING, Listener
from kinesic.hardware.bus.plausibility import PlausibilityFilter
from kinesic.hardware.bus.query import ServoReplies, make_query
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus

from ..conftest import Rig

Make = Callable[..., Rig]
MID_TICKS = 2048  # [ticks] position in the middle of a turn
ALL_SERVOS = slice(None)  # index of all servos
CYCLE_PERIOD = 0.01  # [s] period of the bus cycle
SERVO_MODEL = SERVO_MODELS["xm430_w350"]
AGE_TOLERANCE = CLOCK_TOLERANCE + (8 + 3 * 22) * 1e-5  # [s] age above which a record is late


class Waiting:
    """Three servos with synchronous clocks, and the bus's record of missing replies."""

    def __init__(self) -> None:
        self.plant, buses = build_bus([Cable("body", tuple(ServoFitting(k + 1) for k in range(3)))])
        for servo in self.plant.servos:
            servo.memory.put(SERVO_MODEL.cells[0].addresses, CELL_CONTENTS)
        self.wire = MemoryWire(buses["body"])
        self.listener = Listener(self.wire)
        self.believed = PlausibilityFilter(RecordBounds.of([SERVO_MODEL] * 3, [(1000, 3000)] * 3), CYCLE_PERIOD)
        self.late = LateReplies(self.believed, self.listener)
        self.question = make_query((1, 2, 3), (SERVO_MODEL.cells[0].data,) * 3, fast=True)

    def ask(self, time: float) -> bytes:
        """Return the servos' replies to a query at a time [s]."""
        self.wire.sleep(time)
        self.listener.forget()
        self.listener.send(self.question.data)
        raw = b""
        while chunk := self.wire.read(time + 0.009):
            raw += chunk
        return raw

    def miss(self, time: float) -> float:
        """Return the time [s] until which a query's missing reply is awaited."""
        self.listener.sent_at = time
        self.late.note_missed(self.question)
        return time + (8 + 3 * 22) * 1e-5 + 0.05

    def admit_earlier(self, answer: ServoReplies, sent_at: float) -> bool:
        self.listener.sent_at = sent_at
        return self.late.admit_earlier(self.question, ALL_SERVOS, answer)

    def cycle_of_the_past(self) -> None:
        """Process a cycle in which all records appear older than records accepted before."""
        self.believed.begin()
        assert self.admit_earlier(whole(1.001, 1.001, 1.001), self.miss(1.04) - 0.04)
        self.late.note(fresh=False)
        self.late.keep(self.question, ALL_SERVOS, sent_at=1.04, whole=True)


def records(*times: float) -> Records:
    made = np.zeros(3, BLOCK_DTYPE)
    made["tick"], made["position"] = [round(1000 * time) for time in times], MID_TICKS
    made["volts"], made["temperature"] = 120, 25
    return made


def whole(*times: float) -> ServoReplies:
    """Return a reply of every servo with the given record times [s]."""
    return ServoReplies(records(*times), np.ones(3, dtype=np.bool_), True, 0)


@pytest.fixture
def waiting() -> Waiting:
    made = Waiting()
    made.believed.admit(ALL_SERVOS, whole(1.0, 1.0, 1.0), 1.0)
    made.believed.begin()
    return made


def test_bus_reply_is_not_attributed_to_an_earlier_cycle_if_no_reply_was_missed(waiting: Waiting):
    assert not waiting.admit_earlier(whole(1.001, 1.001, 1.001), 1.04)
    assert not waiting.late.needs_trial


@pytest.mark.parametrize(("after", "earlier"), [(-0.0005, True), (0.0, True), (0.0005, False)])
def test_bus_reply_missed_in_its_cycle_is_accepted_up_to_fifty_milliseconds_late(
    waiting: Waiting, after: float, earlier: bool
):
    assert waiting.admit_earlier(whole(1.001, 1.001, 1.001), waiting.miss(1.02) + after) is earlier


@pytest.mark.parametrize(
    ("times", "earlier"), [((1.001,) * 3, True), ((1.001, 1.001, 1.04), True), ((1.001, 1.04, 1.04), False)]
)
def test_bus_reply_is_assigned_to_the_query_to_which_most_of_its_servo_records_belong(
    waiting: Waiting, times: tuple[float, ...], earlier: bool
):
    waiting.miss(1.03)
    assert waiting.admit_earlier(whole(*times), 1.04) is earlier
    assert waiting.believed.late.any() == earlier


def test_bus_reply_with_only_half_of_its_servo_records_late_is_not_assigned_to_an_earlier_query(waiting: Waiting):
    waiting.miss(1.03)
    waiting.listener.sent_at = 1.04
    two = ServoReplies(records(1.001, 1.04, 1.04)[:2], np.ones(2, dtype=np.bool_), True, 0)
    assert not waiting.late.admit_earlier(waiting.question, np.array([0, 1]), two)


@pytest.mark.parametrize(("sooner", "earlier"), [(0.0002, False), (0.0012, True)])
def test_reply_age_tolerance_is_transmission_time_plus_a_few_milliseconds(
    waiting: Waiting, sooner: float, earlier: bool
):
    waiting.miss(1.03)
    asked = 1.03
    assert waiting.admit_earlier(whole(asked, asked, asked), asked + AGE_TOLERANCE - 0.0007 + sooner) is earlier


def test_reply_faster_than_its_transmission_time_belongs_to_an_earlier_query(waiting: Waiting):
    waiting.miss(1.03)
    waiting.listener.early = True
    for _ in range(5):
        assert waiting.admit_earlier(whole(1.04, 1.04, 1.04), 1.04)
        waiting.late.note(fresh=False)
    assert not waiting.late.needs_trial, "no clock is needed to tell"


def test_records_of_an_earlier_query_are_removed_from_a_damaged_reply(waiting: Waiting):
    broken = whole(1.001, 1.04, 1.04)._replace(whole=False)
    assert waiting.late.remove_earlier(waiting.question, ALL_SERVOS, broken) is broken, "nothing was missed"
    until = waiting.miss(1.03)
    waiting.listener.sent_at = until + 0.001
    assert waiting.late.remove_earlier(waiting.question, ALL_SERVOS, broken) is broken, "it is too late for that"
    assert not waiting.admit_earlier(broken, 1.04)
    assert waiting.late.remove_earlier(waiting.question, ALL_SERVOS, broken).received.tolist() == [False, True, True]
    assert waiting.believed.late.tolist() == [True, False, False]
    unbroken = whole(1.001, 1.04, 1.04)
    assert waiting.late.remove_earlier(waiting.question, ALL_SERVOS, unbroken) is unbroken


def test_two_successive_stale_bus_cycles_trigger_a_cycle_without_query(waiting: Waiting):
    waiting.cycle_of_the_past()
    assert not waiting.late.needs_trial
    waiting.cycle_of_the_past()
    assert waiting.late.needs_trial


def test_bus_cycle_with_a_punctual_record_or_without_any_record_does_not_count_as_late(waiting: Waiting):
    waiting.cycle_of_the_past()
    waiting.late.note(fresh=False)
    assert not waiting.late.needs_trial, "nothing was set aside"
    waiting.late.note(fresh=True)
    waiting.cycle_of_the_past()
    assert not waiting.late.needs_trial, "not in a row"


def test_no_servo_record_counts_as_late_after_a_silent_bus_cycle_without_query(waiting: Waiting):
    for _ in range(2):
        waiting.cycle_of_the_past()
    assert waiting.believed.is_late(0, records(1.002, 1.0, 1.0)[0], 1.05, leeway=0.004)
    waiting.late.listen_for_late(waiting.question, ALL_SERVOS, 1.05)
    assert waiting.wire.now() == 1.05
    assert not waiting.late.needs_trial
    assert not waiting.believed.is_late(0, records(1.002, 1.0, 1.0)[0], 1.05, leeway=0.004)


def test_confirmed_late_replies_prevent_another_cycle_without_query_for_a_while(waiting: Waiting):
    for _ in range(2):
        waiting.cycle_of_the_past()
    waiting.wire.sleep(1.05)
    waiting.listener.send(waiting.question.data)
    waiting.late.listen_for_late(waiting.question, ALL_SERVOS, 1.059)
    assert waiting.believed.late.all()
    assert waiting.believed.is_late(0, records(1.051, 1.0, 1.0)[0], 1.08, leeway=0.004)
    for _ in range(TRIAL_PAUSE + 1):
        waiting.late._set_aside = True
        waiting.late.note(fresh=False)
        assert not waiting.late.needs_trial
    waiting.late.note(fresh=False)
    assert waiting.late.needs_trial


def test_late_reply_is_completed_from_several_received_parts(waiting: Waiting):
    raw, usual = waiting.ask(1.03), waiting.listener.slack.usual
    waiting.listener.received = raw[:40]
    waiting.late.keep(waiting.question, ALL_SERVOS, sent_at=1.03, whole=False)
    waiting.late.catch_up(raw[40:60], 1.04)
    assert waiting.believed.late.tolist() == [True, True, False]
    assert waiting.listener.slack.usual == usual
    waiting.late.catch_up(raw[60:], 1.05)
    assert waiting.believed.late.all()
    assert waiting.listener.slack.usual > usual + TIMEOUT_TUNING.quantile_step, "answers take longer than was thought"
    waiting.believed.begin()
    waiting.late.catch_up(raw, 1.06)
    assert not waiting.believed.late.any(), "nothing is expected any more"
    slow = waiting.listener.slack.usual
    waiting.late.catch_up(waiting.ask(1.07), 1.08)
    assert not waiting.believed.late.any()
    assert waiting.listener.slack.usual == slow, "an answer is late once"


def test_complete_late_reply_leaves_no_pending_bytes(waiting: Waiting):
    raw = waiting.ask(1.03)
    waiting.late.catch_up(raw, 1.04)
    waiting.listener.received = b""
    waiting.late.keep(waiting.question, ALL_SERVOS, sent_at=1.03, whole=True)
    waiting.late.catch_up(raw, 1.04)
    assert not waiting.believed.late.any()


def test_late_first_record_has_the_time_of_its_query():
    made = Waiting()
    raw = made.ask(0.5)
    made.listener.received = raw[:8]
    made.late.keep(made.question, ALL_SERVOS, sent_at=0.5, whole=False)
    made.late.catch_up(b"", 0.51)
    assert not made.believed.late.any()
    made.late.catch_up(raw[8:], 0.51)
    assert made.believed.times.tolist() == [0.5] * 3


def miss_a_cycle(made: Rig) -> None:
    """Run one cycle without replies, so that later replies may be late."""
    for servo in made.plant.servos:
        servo.mute = True
    made.run(1)
    for servo in made.plant.servos:
        servo.mute = False


def test_drifted_servo_clocks_are_synchronised_again(rig: Make):
    made = rig(7)
    made.run(10)
    made.plant.advance(made.wire.now() + 0.03)  # the servos' clocks run ahead, then stand until the wire's has come up
    miss_a_cycle(made)
    cycles = made.run(50)
    assert all(cycle.fresh.all() for cycle in cycles[8:])
    assert cycles[-1].duration < 0.5 * made.bus.period
    assert made.bus.cycle().ages.max() < made.bus.period


@pytest.mark.parametrize("apart", [0.008, 0.02, 0.1])
def test_servo_records_are_accepted_again_a_few_cycles_after_clock_drift(rig: Make, apart: float):
    made = rig(7)
    made.run(10)
    made.bus._accepted.times = made.bus._accepted.times - apart
    miss_a_cycle(made)
    cycles = made.run(20)
    assert not cycles[0].fresh.any()
    assert all(cycle.fresh.all() for cycle in cycles[4:])
    assert not any(cycle.events for cycle in cycles)


def test_servo_goals_are_sent_even_in_cycles_without_a_query(rig: Make):
    made = rig(7)
    made.energise()
    made.bus._late._stale_cycles = MAX_STALE_CYCLES
    (cycle,) = made.run(1, np.full(7, MID_TICKS + 9))
    assert not cycle.fresh.any()
    assert (made.true(Register.GOAL_POSITION) == MID_TICKS + 9).all()
    assert made.run(1)[0].fresh.all()


def test_replies_of_a_slow_adapter_stay_late_with_constant_age(rig: Make):
    made = rig(7, latency=0.016)
    cycles = made.run(150, np.full(7, MID_TICKS))[20:]
    assert not any(cycle.fresh.all() for cycle in cycles)
    apart = [cycle.raw_values("tick") / 1000 - cycle.times for cycle in cycles]
    assert np.ptp(apart) < made.bus.period / 2
    assert max(cycle.ages.max() for cycle in cycles) < 0.03


@pytest.mark.parametrize("late", [(True, False, False), (False, True, True), (True, True, True)])
def test_one_late_servo_record_makes_the_bus_treat_missing_replies_as_late(rig: Make, late: tuple[bool, ...]):
    made = rig(3)
    made.run(3)
    made.bus._query_missing_servos = lambda: setattr(made.bus._accepted, "late", np.array(late))
    made.run(1)
    assert made.bus._listener.replies_late
