"""Records of an earlier cycle: how the filter tells them, and from when they count."""

from math import inf

import numpy as np
import pytest

from kinesic.hardware.bus.plausibility import PlausibilityFilter
from kinesic.hardware.bus.query import ServoReplies

from .records import ALL, answer, blocks, gate, make_filter, told

__all__ = ["gate"]


def test_a_late_record_counts_from_when_it_was_taken(gate: PlausibilityFilter):
    gate.admit_late(ALL, answer(blocks(1010, 2050)), 1.025)
    assert not gate.fresh.any()
    assert gate.late.all()
    assert gate.blocks["position"].tolist() == [2050, 2050]
    assert gate.times.tolist() == pytest.approx([1.01, 1.01])
    gate.admit_late(ALL, answer(blocks(1005, 2070)), 1.03)
    assert gate.blocks["position"].tolist() == [2050, 2050]


def test_a_record_is_late_by_the_servos_clock(gate: PlausibilityFilter):
    assert gate.is_late(0, blocks(1005)[0], 1.02, leeway=0.004)
    assert not gate.is_late(0, blocks(1019)[0], 1.02, leeway=0.004)


def test_a_clock_that_is_not_trusted_proves_nothing_until_the_next_record(gate: PlausibilityFilter):
    gate.distrust_clocks()
    assert not gate.is_late(0, blocks(1005)[0], 1.02, leeway=0.004)
    gate.admit(ALL, answer(blocks(1005)), 1.02)
    assert gate.times.tolist() == [1.02, 1.02]
    assert gate.is_late(0, blocks(1010)[0], 1.04, leeway=0.004)


def test_a_record_within_the_leeway_is_not_late(gate: PlausibilityFilter):
    assert not gate.is_late(0, blocks(1016)[0], 1.02, leeway=0.0041)
    assert gate.is_late(0, blocks(1016)[0], 1.02, leeway=0.0039)


def test_a_clock_tells_nothing_after_half_its_turn(gate: PlausibilityFilter):
    assert gate.is_late(0, blocks(1010)[0], 1.0 + 16.383, leeway=0.004)
    assert not gate.is_late(0, blocks(1010)[0], 1.0 + 16.385, leeway=0.004)


def test_who_was_never_heard_is_not_late():
    assert not make_filter().is_late(1, blocks(5)[1], 1.0, leeway=0.0)


def test_a_whole_answer_in_time_sets_all_clocks_anew(gate: PlausibilityFilter):
    gate.distrust_clocks()
    told(gate, blocks(1010))
    assert all(gate.is_late(place, blocks(1012)[place], 1.02, leeway=0.004) for place in (0, 1))


def test_an_answer_of_one_servo_sets_its_clock_alone(gate: PlausibilityFilter):
    gate.distrust_clocks()
    gate.admit(ALL, ServoReplies(blocks(1010), np.array([True, False]), False, 0), 1.01)
    assert [gate.is_late(place, blocks(1012)[place], 1.03, leeway=0.004) for place in (0, 1)] == [True, False]


def test_a_broken_answer_is_split_at_the_question(gate: PlausibilityFilter):
    mixed = blocks(1040, 2050)
    mixed["tick"][1] = 1010
    left = gate.without_late(ALL, answer(mixed), 1.04, leeway=0.004)
    assert left.found.tolist() == [True, False]
    assert gate.late.tolist() == [False, True]
    assert gate.times.tolist() == pytest.approx([1.0, 1.01])
    assert gate.blocks["position"].tolist() == [2048, 2050]


def test_places_of_a_broken_answer_are_those_that_were_asked(gate: PlausibilityFilter):
    left = gate.without_late(np.array([1]), answer(blocks(1010, 2050)[1:]), 1.04, leeway=0.004)
    assert left.found.tolist() == [False]
    assert gate.late.tolist() == [False, True]


def test_an_answer_in_time_is_left_as_it_is(gate: PlausibilityFilter):
    given = answer(blocks(1040))
    assert gate.without_late(ALL, given, 1.04, leeway=0.004) is given
    assert not gate.late.any()
    assert gate.blocks["tick"].tolist() == [1000, 1000]


def test_who_did_not_answer_is_not_late(gate: PlausibilityFilter):
    given = ServoReplies(blocks(1010), np.array([False, False]), False, 0)
    assert gate.without_late(ALL, given, 1.04, leeway=0.004) is given


def test_a_first_record_that_is_late_is_dated_by_its_question_if_that_is_known():
    opened = make_filter()
    opened.admit_late(ALL, answer(blocks(7)), 1.03)
    assert opened.times.tolist() == [-inf, -inf]
    opened.admit_late(ALL, answer(blocks(7)), 1.03, sent_at=1.01)
    assert opened.times.tolist() == [1.01, 1.01]
    assert opened.late.all()


def test_a_late_record_is_never_of_the_future(gate: PlausibilityFilter):
    gate.admit_late(ALL, answer(blocks(1500)), 1.2)
    assert gate.times.tolist() == [1.2, 1.2]


@pytest.mark.parametrize("tick", [1000, 999, 1000 + 16_384])
def test_what_is_not_news_is_not_taken_late(gate: PlausibilityFilter, tick: int):
    gate.admit_late(ALL, answer(blocks(tick, 2050)), 20.0, sent_at=19.0)
    assert not gate.late.any()
    assert gate.blocks["position"].tolist() == [2048, 2048]


def test_a_late_record_must_be_plausible_too(gate: PlausibilityFilter):
    gate.admit_late(ALL, answer(blocks(1010, position=3000)), 1.025)
    assert gate.late.tolist() == [True, False]
    assert gate.doubted == {1}


def test_late_records_add_up_until_the_next_cycle(gate: PlausibilityFilter):
    for place in (0, 1):
        gate.admit_late(np.array([place]), answer(blocks(1010)[place : place + 1]), 1.025)
    assert gate.late.all()
    gate.begin()
    assert not gate.late.any()
