from math import inf

import numpy as np
import pytest

from kinesic.hardware.bus.cycle import BLOCK, Records
from kinesic.hardware.bus.plausibility import LEAP, LEEWAY, RUSH, PlausibilityFilter
from kinesic.hardware.bus.query import ServoReplies

from .records import ALL, answer, blocks, gate, make_filter, told

__all__ = ["gate"]


def test_the_first_record_is_believed():
    opened = make_filter()
    opened.begin()
    assert opened.times.tolist() == [-inf, -inf]
    opened.admit(ALL, answer(blocks(1000, 17)), 1.0)
    assert opened.fresh.all()
    assert opened.blocks["position"].tolist() == [17, 17]
    assert opened.times.tolist() == [1.0, 1.0]


def test_what_a_servo_can_do_is_believed(gate: PlausibilityFilter):
    assert told(gate, blocks(1010, 2048 + LEEWAY)) == [True, True]
    assert told(gate, blocks(1020, temperature=40 + LEAP), 1.02) == [True, True]
    assert told(gate, blocks(1030, hardware_error=0x20, error=0x80, temperature=44), 1.03) == [True, True]


@pytest.mark.parametrize(
    "lie",
    [
        {"position": 3000},
        {"position": 3000 + 2 * 4096},
        {"temperature": 90},
        {"hardware_error": 4},
        {"error": 0x80},
    ],
)
def test_what_surprises_must_be_said_twice(gate: PlausibilityFilter, lie: dict[str, int]):
    assert told(gate, blocks(1010, **lie)) == [True, False]
    assert gate.doubted == {1}
    assert gate.blocks["position"][1] == 2048
    assert told(gate, blocks(1020, **lie), 1.02) == [True, True]


@pytest.mark.parametrize(
    ("lie", "text"),
    [
        ({"position": 1_000_000}, "position is 1000000, must be -32768..32768"),
        ({"position": 2048 - 2**31}, "position is -2147481600"),
        ({"position": 3513, "torque": 1}, "position is 3513, must be 488..3512"),
        ({"position": 487, "torque": 1}, "position is 487, must be 488..3512"),
        ({"velocity": 5000}, "velocity is 5000, must be -700..700"),
        ({"velocity": -(2**31)}, "velocity is -2147483648"),
        ({"temperature": 126}, "temperature is 126, must be 0..125"),
        ({"volts": 241}, "volts is 241, must be 25..240"),
        ({"volts": 24}, "volts is 24, must be 25..240"),
        ({"current": -2387}, "current is -2387, must be -2386..2386"),
        ({"torque": 2}, "torque is 2, must be 0..1"),
        ({"watchdog": -2}, "watchdog is -2, must be -1..127"),
        ({"hardware_error": 0x40, "error": 0x80}, "hardware_error is 64, must be 0..63"),
    ],
)
def test_what_cannot_be_is_not_believed_however_often_it_is_said(gate: PlausibilityFilter, lie: dict, text: str):
    heard = [told(gate, blocks(1000 + 10 * k, **lie), 1.0 + 0.01 * k) for k in range(1, 200)]
    assert all(fresh == [True, False] for fresh in heard)
    assert gate.impossible[1].startswith(text)
    gate.impossible.clear()
    assert told(gate, blocks(3010, **lie), 3.01) == [True, False]
    assert not gate.impossible, "it is told once"
    assert told(gate, blocks(3020), 3.02) == [True, True]


def test_what_cannot_be_is_not_believed_first_either(gate: PlausibilityFilter):
    gate.forget(1)
    assert told(gate, blocks(1010, position=10**6)) == [True, False]
    assert told(gate, blocks(1020, position=2000), 1.02) == [True, True]


@pytest.mark.parametrize("place", [2500, 1200])
def test_a_joint_with_torque_does_not_leap_however_often_it_is_said(gate: PlausibilityFilter, place: int):
    assert told(gate, blocks(1010, torque=1), 1.01) == [True, True]
    heard = [told(gate, blocks(1000 + 10 * k, position=place, torque=1), 1.0 + 0.01 * k) for k in range(2, 200)]
    assert all(fresh == [True, False] for fresh in heard)
    assert gate.impossible[1] == f"position leapt from 2048 to {place}, with torque"
    assert gate.blocks["position"][1] == 2048
    assert told(gate, blocks(3010, position=2090, torque=1), 3.01) == [True, True]


def test_a_joint_with_torque_that_leapt_is_not_believed_for_moving_on_from_there(gate: PlausibilityFilter):
    """It creeps on by less than it can in a cycle, and soon is far from where it leapt to."""
    told(gate, blocks(1010, torque=1), 1.01)
    for k in range(8):
        lie = blocks(1020 + 10 * k, position=3400 - 100 * k, torque=1)
        assert told(gate, lie, 1.02 + 0.01 * k) == [True, False]
        assert gate.doubted == {1}, "at first"
        assert list(gate.impossible) == ([1] if k else [])
        if k:
            assert gate.impossible[1] == "position leapt from 2048 to 3300, with torque"
    gate.doubted.clear()
    for k in range(8, 12):
        assert told(gate, blocks(1020 + 10 * k, position=2600, torque=1), 1.02 + 0.01 * k) == [True, False]
    assert not gate.doubted, "it is no new surprise"


def test_a_joint_that_leapt_is_believed_when_it_is_limp(gate: PlausibilityFilter):
    told(gate, blocks(1010, torque=1), 1.01)
    for k in range(2, 20):
        assert told(gate, blocks(1000 + 10 * k, position=2800, torque=1), 1.0 + 0.01 * k) == [True, False]
    assert told(gate, blocks(1200, position=2800), 1.2) == [True, True]


def test_torque_that_comes_on_forgets_whole_turns(gate: PlausibilityFilter):
    gate.forget(1)
    assert told(gate, blocks(1010, position=2048 + 4096), 1.01) == [True, True]
    assert told(gate, blocks(1020, position=2050, torque=1), 1.02) == [True, True]
    assert gate.blocks["position"][1] == 2050


def test_one_lie_does_not_hide_the_truth_that_follows(gate: PlausibilityFilter):
    told(gate, blocks(1010, torque=1), 1.01)
    assert told(gate, blocks(1020, position=2048 + 300, torque=1), 1.02) == [True, False]
    assert told(gate, blocks(1030, position=2048 + 60, torque=1), 1.03) == [True, True]


def test_after_lies_and_a_silence_a_joint_may_be_elsewhere(gate: PlausibilityFilter):
    told(gate, blocks(1010, torque=1), 1.01)
    assert told(gate, blocks(1020, position=2700, torque=1), 1.02) == [True, False]
    assert told(gate, blocks(1220, position=1500, torque=1), 1.22) == [True, True]


def test_a_lie_that_is_not_repeated_is_forgotten(gate: PlausibilityFilter):
    assert told(gate, blocks(1010, position=3000)) == [True, False]
    assert told(gate, blocks(1020), 1.02) == [True, True]
    assert told(gate, blocks(1030, position=3000), 1.03) == [True, False]


def test_after_a_silence_a_joint_may_be_elsewhere(gate: PlausibilityFilter):
    assert told(gate, blocks(1500, position=3500), 1.5) == [True, True]


def test_who_has_not_been_heard_for_long_may_have_warmed(gate: PlausibilityFilter):
    assert told(gate, blocks(1200, temperature=40 + LEAP + 10), 1.2) == [True, True]
    assert told(gate, blocks(1210, temperature=40 + LEAP + 10 + LEAP + 2), 1.21) == [True, False]


@pytest.mark.parametrize("tick", [1000, 990, 900])
def test_a_record_from_the_past_is_none(gate: PlausibilityFilter, tick: int):
    assert told(gate, blocks(tick, 2060)) == [False, False]
    assert gate.blocks["position"].tolist() == [2048, 2048]


def test_the_clock_of_a_servo_starts_again_after_half_a_minute(gate: PlausibilityFilter):
    for k in range(1, 4000):
        assert all(told(gate, blocks((1000 + 10 * k) % 32768), 1.0 + 0.01 * k))


def test_a_clock_that_stays_in_the_past_has_started_anew(gate: PlausibilityFilter):
    heard = [told(gate, blocks(10 * k), 1.0 + 0.01 * k) for k in range(1, 8)]
    assert heard[0] == [False, False]
    assert heard[-1] == [True, True]


def test_a_record_from_the_past_that_is_repeated_is_no_new_clock(gate: PlausibilityFilter):
    heard = [told(gate, blocks(990 - k % 2, 2060), 1.0 + 0.01 * k) for k in range(1, 12)]
    assert not np.any(heard)


@pytest.mark.parametrize("time", [1.001, 1.01, 2.0, 20.0])
def test_a_clock_that_stands_still_dates_nothing(gate: PlausibilityFilter, time: float):
    frozen = blocks(1010)
    frozen["tick"][1] = 1000
    heard = []
    for k in range(20):
        frozen["tick"][0] = 1000 + round(1000 * (time - 1.0)) + k
        heard.append(told(gate, frozen, time + 0.001 * k))
    assert heard == [[True, False]] * 20
    assert gate.times[1] == 1.0


def test_the_clock_of_every_servo_is_looked_at(gate: PlausibilityFilter):
    mixed = blocks(1010)
    mixed["tick"][1] = 990
    assert told(gate, mixed) == [True, False]


def test_a_record_without_voltage_is_none(gate: PlausibilityFilter):
    empty = blocks(1010)
    empty[1] = np.zeros(1, BLOCK)[0]
    assert told(gate, empty) == [True, False]
    assert gate.forgetful == {1}
    assert gate.blocks["volts"][1] == 120


def test_a_servo_that_was_forgotten_may_say_anything(gate: PlausibilityFilter):
    gate.forget(1)
    assert told(gate, blocks(5, position=3000)) == [False, True]


def test_who_did_not_answer_keeps_the_record(gate: PlausibilityFilter):
    gate.begin()
    gate.admit(ALL, ServoReplies(blocks(1010, 2060), np.array([True, False]), False, 0), 1.01)
    assert gate.blocks["position"].tolist() == [2060, 2048]
    assert gate.times.tolist() == [1.01, 1.0]
    assert gate.fresh.tolist() == [True, False]


def test_what_was_handed_out_does_not_change(gate: PlausibilityFilter):
    before, times = gate.blocks, gate.times
    kept = before.copy()
    told(gate, blocks(1010, 2060))
    told(gate, blocks(1020, position=3000), 1.02)
    gate.forget(0)
    assert (before == kept).all()
    assert times.tolist() == [1.0, 1.0]


def test_a_joint_may_move_in_a_cycle_as_far_as_its_speed_allows_in_two(gate: PlausibilityFilter):
    """10943 ticks/s over 20 ms, and the leeway."""
    assert told(gate, blocks(1010, position=2048 + 218 + LEEWAY)) == [True, True]
    assert told(gate, blocks(1020, position=2048), 1.02) == [True, True]
    assert told(gate, blocks(1030, position=2048 + 219 + LEEWAY), 1.03) == [True, False]
    assert told(gate, blocks(1040, position=2048 - 219 - LEEWAY), 1.04) == [True, False]


def alone(made: PlausibilityFilter, block: Records, time: float) -> bool:
    """Whether the second servo is believed, asked by itself."""
    made.begin()
    made.admit(np.array([1]), answer(block[1:]), time)
    return bool(made.fresh[1])


@pytest.mark.parametrize("sign", [-1, 1])
def test_after_a_silence_a_joint_may_be_as_far_as_its_speed_allows(sign: int):
    """8192 ticks/s; times are sums of powers of two."""
    most = 8192 // 8 + LEEWAY
    for jump, believed in ((most, True), (most + 1, False)):
        made = make_filter("xm540_w270")
        made.admit(ALL, answer(blocks(1000, 0)), 1.0)
        assert alone(made, blocks(1125, 0, position=sign * jump), 1.125) is believed


@pytest.mark.parametrize("sign", [-1, 1])
def test_after_a_silence_a_servo_may_be_as_much_warmer_as_it_can(gate: PlausibilityFilter, sign: int):
    most = LEAP + round(RUSH / 4)
    assert not alone(gate, blocks(1250, temperature=40 + sign * (most + 1)), 1.25)
    gate.forget(1)
    assert alone(gate, blocks(1260, temperature=40), 1.25)
    assert alone(gate, blocks(1510, temperature=40 + sign * most), 1.5)


@pytest.mark.parametrize(
    ("first", "second", "same"),
    [
        ({"position": 3000}, {"position": 3000 + 2 * LEEWAY}, True),
        ({"position": 3000}, {"position": 3000 + 2 * LEEWAY + 1}, False),
        ({"temperature": 90}, {"temperature": 90 + LEAP}, True),
        ({"temperature": 90}, {"temperature": 90 - LEAP - 1}, False),
        ({"hardware_error": 4}, {"hardware_error": 4}, True),
        ({"hardware_error": 4}, {"hardware_error": 8}, False),
        ({"position": 3000}, {"position": 3000, "temperature": 60}, False),
        ({"position": 3000}, {"position": 3000, "hardware_error": 4}, False),
    ],
)
def test_a_surprise_is_confirmed_by_one_of_the_same_kind(
    gate: PlausibilityFilter, first: dict, second: dict, same: bool
):
    assert told(gate, blocks(1010, **first)) == [True, False]
    assert told(gate, blocks(1020, **second), 1.02) == [True, same]


def test_records_from_the_past_count_only_in_a_row(gate: PlausibilityFilter):
    """Three from a clock that seems to have started anew, one in time, and three again."""
    for begin in (0, 100):
        for k in range(3):
            time = 1.01 + (10 * k + begin) / 1000
            assert told(gate, blocks(1010 + 10 * k + begin, tick=500 + 10 * k + begin), time) == [True, False]
        assert told(gate, blocks(1050 + begin), 1.05 + begin / 1000) == [True, True]


def test_a_clock_that_has_started_anew_is_believed_the_fourth_time(gate: PlausibilityFilter):
    heard = [told(gate, blocks(1010 + 10 * k, tick=10 * k), 1.01 + 0.01 * k)[1] for k in range(5)]
    assert heard == [False, False, False, True, True]


def test_of_who_was_forgotten_no_doubt_is_left(gate: PlausibilityFilter):
    """Neither what it said of the past, nor a surprise; also where its first record comes late."""
    told(gate, blocks(1010, position=3000), 1.01)
    for k in range(3):
        told(gate, blocks(1020 + 10 * k, tick=10 * k), 1.02 + 0.01 * k)
    gate.forget(1)
    gate.admit_late(ALL, answer(blocks(1045, tick=40)), 1.05, sent_at=1.045)
    assert told(gate, blocks(1050, tick=30), 1.05) == [True, False]
    assert told(gate, blocks(1060, tick=60, position=3000), 1.06) == [True, False]


def test_a_clock_that_is_back_after_half_its_turn_is_news(gate: PlausibilityFilter):
    """After 16.4 s, what seems to be older may be newer."""
    assert not alone(gate, blocks(900), 1.0 + 16.383)
    assert alone(gate, blocks(900), 1.0 + 16.385)
