"""Records of earlier cycles and their times."""

from math import inf

import numpy as np
import pytest

from kinesic.hardware.bus.plausibility import PlausibilityFilter
from kinesic.hardware.bus.query import ServoReplies

from .records import ALL_SERVOS, answer, blocks, gate, make_filter, told

__all__ = ["gate"]


def test_late_servo_record_keeps_its_measurement_time(gate: PlausibilityFilter):
    gate.admit_late(ALL_SERVOS, answer(blocks(1010, 2050)), 1.025)
    assert not gate.fresh.any()
    assert gate.late.all()
    assert gate.blocks["position"].tolist() == [2050, 2050]
    assert gate.times.tolist() == pytest.approx([1.01, 1.01])
    gate.admit_late(ALL_SERVOS, answer(blocks(1005, 2070)), 1.03)
    assert gate.blocks["position"].tolist() == [2050, 2050]


def test_servo_record_is_late_according_to_the_servo_clock(gate: PlausibilityFilter):
    assert gate.is_late(0, blocks(1005)[0], 1.02, leeway=0.004)
    assert not gate.is_late(0, blocks(1019)[0], 1.02, leeway=0.004)


def test_untrusted_servo_clock_is_ignored_until_the_next_record(gate: PlausibilityFilter):
    gate.distrust_clocks()
    assert not gate.is_late(0, blocks(1005)[0], 1.02, leeway=0.004)
    gate.admit(ALL_SERVOS, answer(blocks(1005)), 1.02)
    assert gate.times.tolist() == [1.02, 1.02]
    assert gate.is_late(0, blocks(1010)[0], 1.04, leeway=0.004)


def test_servo_record_within_the_clock_tolerance_is_not_late(gate: PlausibilityFilter):
    assert not gate.is_late(0, blocks(1016)[0], 1.02, leeway=0.0041)
    assert gate.is_late(0, blocks(1016)[0], 1.02, leeway=0.0039)


def test_age_of_a_servo_record_is_ambiguous_after_half_the_period_of_the_servo_clock(gate: PlausibilityFilter):
    assert gate.is_late(0, blocks(1010)[0], 1.0 + 16.383, leeway=0.004)
    for half_period in (16.384, 16.385):  # [s] a sum with 1.0 is exact
        assert not gate.is_late(0, blocks(1010)[0], 1.0 + half_period, leeway=0.004)


def test_first_servo_record_does_not_count_as_late():
    assert not make_filter().is_late(1, blocks(5)[1], 1.0, leeway=0.0)


def test_complete_reply_in_time_synchronises_all_servo_clocks(gate: PlausibilityFilter):
    gate.distrust_clocks()
    told(gate, blocks(1010))
    assert all(gate.is_late(place, blocks(1012)[place], 1.02, leeway=0.004) for place in (0, 1))


def test_reply_of_one_servo_synchronises_only_its_clock(gate: PlausibilityFilter):
    gate.distrust_clocks()
    gate.admit(ALL_SERVOS, ServoReplies(blocks(1010), np.array([True, False]), False, 0), 1.01)
    assert [gate.is_late(place, blocks(1012)[place], 1.03, leeway=0.004) for place in (0, 1)] == [True, False]


def test_damaged_reply_is_split_into_current_and_late_records(gate: PlausibilityFilter):
    mixed = blocks(1040, 2050)
    mixed["tick"][1] = 1010
    left = gate.without_late(ALL_SERVOS, answer(mixed), 1.04, leeway=0.004)
    assert left.received.tolist() == [True, False]
    assert gate.late.tolist() == [False, True]
    assert gate.times.tolist() == pytest.approx([1.0, 1.01])
    assert gate.blocks["position"].tolist() == [2048, 2050]


def test_late_record_in_a_damaged_reply_is_assigned_to_its_servo(gate: PlausibilityFilter):
    left = gate.without_late(np.array([1]), answer(blocks(1010, 2050)[1:]), 1.04, leeway=0.004)
    assert left.received.tolist() == [False]
    assert gate.late.tolist() == [False, True]


def test_servo_reply_in_time_is_returned_unchanged(gate: PlausibilityFilter):
    given = answer(blocks(1040))
    assert gate.without_late(ALL_SERVOS, given, 1.04, leeway=0.004) is given
    assert not gate.late.any()
    assert gate.blocks["tick"].tolist() == [1000, 1000]


def test_damaged_reply_without_servo_records_is_returned_unchanged(gate: PlausibilityFilter):
    given = ServoReplies(blocks(1010), np.array([False, False]), False, 0)
    assert gate.without_late(ALL_SERVOS, given, 1.04, leeway=0.004) is given


def test_late_first_servo_record_gets_the_time_of_its_query():
    opened = make_filter()
    opened.admit_late(ALL_SERVOS, answer(blocks(7)), 1.03)
    assert opened.times.tolist() == [-inf, -inf]
    opened.admit_late(ALL_SERVOS, answer(blocks(7)), 1.03, sent_at=1.01)
    assert opened.times.tolist() == [1.01, 1.01]
    assert opened.late.all()


def test_late_servo_record_gets_at_most_the_reception_time(gate: PlausibilityFilter):
    gate.admit_late(ALL_SERVOS, answer(blocks(1500)), 1.2)
    assert gate.times.tolist() == [1.2, 1.2]


@pytest.mark.parametrize("tick", [1000, 999, 1000 + 16_384])
def test_late_servo_record_with_an_old_clock_value_is_ignored(gate: PlausibilityFilter, tick: int):
    gate.admit_late(ALL_SERVOS, answer(blocks(tick, 2050)), 20.0, sent_at=19.0)
    assert not gate.late.any()
    assert gate.blocks["position"].tolist() == [2048, 2048]


def test_implausible_late_servo_record_is_ignored(gate: PlausibilityFilter):
    gate.admit_late(ALL_SERVOS, answer(blocks(1010, position=3000)), 1.025)
    assert gate.late.tolist() == [True, False]
    assert gate.doubted == {1}


def test_late_flags_of_servo_records_are_cleared_at_the_next_cycle(gate: PlausibilityFilter):
    for place in (0, 1):
        gate.admit_late(np.array([place]), answer(blocks(1010)[place : place + 1]), 1.025)
    assert gate.late.all()
    gate.begin()
    assert not gate.late.any()


def test_servo_record_at_exactly_the_clock_tolerance_is_not_late(gate: PlausibilityFilter):
    assert not gate.is_late(0, blocks(1250)[0], 1.5, leeway=0.25)
    assert gate.is_late(0, blocks(1249)[0], 1.5, leeway=0.25)
