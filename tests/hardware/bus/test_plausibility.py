from math import inf

import numpy as np
import pytest

from kinesic.hardware.bus.cycle import BLOCK_DTYPE, Records
from kinesic.hardware.bus.plausibility import PLAUSIBILITY_TUNING, PlausibilityFilter
from kinesic.hardware.bus.query import ServoReplies
from kinesic.hardware.protocol.registers import CLOCK_WRAP

from .records import ALL_SERVOS, answer, blocks, gate, make_filter, told

__all__ = ["gate"]

POSITION_TOLERANCE = PLAUSIBILITY_TUNING.position_tolerance  # [ticks] position jump that is always plausible
TEMPERATURE_TOLERANCE = PLAUSIBILITY_TUNING.temperature_tolerance  # [C] change that is always plausible
MAX_HEATING_RATE = PLAUSIBILITY_TUNING.max_heating_rate  # [C/s] plausible temperature change over time


def test_plausible_first_servo_record_is_accepted():
    opened = make_filter()
    opened.begin()
    assert opened.times.tolist() == [-inf, -inf]
    opened.admit(ALL_SERVOS, answer(blocks(1000, 17)), 1.0)
    assert opened.fresh.all()
    assert opened.blocks["position"].tolist() == [17, 17]
    assert opened.times.tolist() == [1.0, 1.0]


def test_servo_record_changes_within_tolerance_are_accepted(gate: PlausibilityFilter):
    assert told(gate, blocks(1010, 2048 + POSITION_TOLERANCE)) == [True, True]
    assert told(gate, blocks(1020, temperature=40 + TEMPERATURE_TOLERANCE), 1.02) == [True, True]
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
def test_implausible_servo_record_is_accepted_only_when_repeated(gate: PlausibilityFilter, lie: dict[str, int]):
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
def test_repeated_impossible_servo_record_is_rejected(gate: PlausibilityFilter, lie: dict, text: str):
    heard = [told(gate, blocks(1000 + 10 * k, **lie), 1.0 + 0.01 * k) for k in range(1, 200)]
    assert all(fresh == [True, False] for fresh in heard)
    assert gate.impossible[1].startswith(text)
    gate.impossible.clear()
    assert told(gate, blocks(3010, **lie), 3.01) == [True, False]
    assert not gate.impossible, "it is told once"
    assert told(gate, blocks(3020), 3.02) == [True, True]


def test_impossible_first_servo_record_is_rejected(gate: PlausibilityFilter):
    gate.forget(1)
    assert told(gate, blocks(1010, position=10**6)) == [True, False]
    assert told(gate, blocks(1020, position=2000), 1.02) == [True, True]


@pytest.mark.parametrize("place", [2500, 1200])
def test_repeated_position_jump_of_a_servo_with_torque_is_rejected(gate: PlausibilityFilter, place: int):
    assert told(gate, blocks(1010, torque=1), 1.01) == [True, True]
    heard = [told(gate, blocks(1000 + 10 * k, position=place, torque=1), 1.0 + 0.01 * k) for k in range(2, 200)]
    assert all(fresh == [True, False] for fresh in heard)
    assert gate.impossible[1] == f"position jumped from 2048 to {place}, with torque"
    assert gate.blocks["position"][1] == 2048
    assert told(gate, blocks(3010, position=2090, torque=1), 3.01) == [True, True]


def test_servo_motion_that_continues_from_a_rejected_position_jump_is_also_rejected(gate: PlausibilityFilter):
    """The servo moves slowly, but is soon far from the rejected position."""
    told(gate, blocks(1010, torque=1), 1.01)
    for k in range(8):
        lie = blocks(1020 + 10 * k, position=3400 - 100 * k, torque=1)
        assert told(gate, lie, 1.02 + 0.01 * k) == [True, False]
        assert gate.doubted == {1}, "at first"
        assert list(gate.impossible) == ([1] if k else [])
        if k:
            assert gate.impossible[1] == "position jumped from 2048 to 3300, with torque"
    gate.doubted.clear()
    for k in range(8, 12):
        assert told(gate, blocks(1020 + 10 * k, position=2600, torque=1), 1.02 + 0.01 * k) == [True, False]
    assert not gate.doubted, "it is no new surprise"


def test_jump_rejected_repeatedly_with_torque_is_accepted_once_torque_is_off(gate: PlausibilityFilter):
    told(gate, blocks(1010, torque=1), 1.01)
    for k in range(2, 20):
        assert told(gate, blocks(1000 + 10 * k, position=2800, torque=1), 1.0 + 0.01 * k) == [True, False]
    assert told(gate, blocks(1200, position=2800), 1.2) == [True, True]


def test_position_may_lose_whole_turns_when_torque_is_switched_on(gate: PlausibilityFilter):
    gate.forget(1)
    assert told(gate, blocks(1010, position=2048 + 4096), 1.01) == [True, True]
    assert told(gate, blocks(1020, position=2050, torque=1), 1.02) == [True, True]
    assert gate.blocks["position"][1] == 2050


def test_jump_by_a_whole_turn_without_torque_is_rejected_at_first(gate: PlausibilityFilter):
    assert told(gate, blocks(1010, position=2048 + 4096), 1.01) == [True, False]
    assert gate.blocks["position"][1] == 2048


def test_record_after_a_rejected_record_is_compared_with_the_last_accepted_record(gate: PlausibilityFilter):
    told(gate, blocks(1010, torque=1), 1.01)
    assert told(gate, blocks(1020, position=2048 + 300, torque=1), 1.02) == [True, False]
    assert told(gate, blocks(1030, position=2048 + 60, torque=1), 1.03) == [True, True]


def test_servo_position_far_from_the_last_accepted_one_is_accepted_after_a_long_silence(gate: PlausibilityFilter):
    told(gate, blocks(1010, torque=1), 1.01)
    assert told(gate, blocks(1020, position=2700, torque=1), 1.02) == [True, False]
    assert told(gate, blocks(1220, position=1500, torque=1), 1.22) == [True, True]


def test_implausible_record_repeated_after_a_plausible_record_is_rejected_again(gate: PlausibilityFilter):
    assert told(gate, blocks(1010, position=3000)) == [True, False]
    assert told(gate, blocks(1020), 1.02) == [True, True]
    assert told(gate, blocks(1030, position=3000), 1.03) == [True, False]


def test_large_servo_position_change_is_accepted_after_half_a_second_of_silence(gate: PlausibilityFilter):
    assert told(gate, blocks(1500, position=3500), 1.5) == [True, True]


def test_temperature_of_a_servo_may_rise_during_long_silence(gate: PlausibilityFilter):
    assert told(gate, blocks(1200, temperature=40 + TEMPERATURE_TOLERANCE + 10), 1.2) == [True, True]
    assert told(gate, blocks(1210, temperature=40 + TEMPERATURE_TOLERANCE + 10 + TEMPERATURE_TOLERANCE + 2), 1.21) == [
        True,
        False,
    ]


@pytest.mark.parametrize("tick", [1000, 990, 900, 1000 + CLOCK_WRAP // 2])
def test_servo_record_with_an_earlier_clock_value_is_rejected(gate: PlausibilityFilter, tick: int):
    assert told(gate, blocks(tick, 2060)) == [False, False]
    assert gate.blocks["position"].tolist() == [2048, 2048]


def test_servo_records_are_accepted_while_the_servo_clock_wraps(gate: PlausibilityFilter):
    for k in range(1, 4000):
        assert all(told(gate, blocks((1000 + 10 * k) % 32768), 1.0 + 0.01 * k))


def test_servo_clock_that_repeatedly_reports_earlier_values_counts_as_restarted(gate: PlausibilityFilter):
    heard = [told(gate, blocks(10 * k), 1.0 + 0.01 * k) for k in range(1, 8)]
    assert heard[0] == [False, False]
    assert heard[-1] == [True, True]


def test_repeated_old_servo_record_does_not_count_as_a_clock_restart(gate: PlausibilityFilter):
    heard = [told(gate, blocks(990 - k % 2, 2060), 1.0 + 0.01 * k) for k in range(1, 12)]
    assert not np.any(heard)


@pytest.mark.parametrize("time", [1.001, 1.01, 2.0, 20.0])
def test_records_of_a_servo_with_a_stopped_clock_are_rejected(gate: PlausibilityFilter, time: float):
    frozen = blocks(1010)
    frozen["tick"][1] = 1000
    heard = []
    for k in range(20):
        frozen["tick"][0] = 1000 + round(1000 * (time - 1.0)) + k
        heard.append(told(gate, frozen, time + 0.001 * k))
    assert heard == [[True, False]] * 20
    assert gate.times[1] == 1.0


def test_servo_record_one_millisecond_newer_has_the_position_tolerance_of_a_whole_cycle(gate: PlausibilityFilter):
    assert told(gate, blocks(1001, 2048 + 218 + POSITION_TOLERANCE)) == [True, True]


def test_earlier_clock_value_of_one_servo_rejects_only_its_record(gate: PlausibilityFilter):
    mixed = blocks(1010)
    mixed["tick"][1] = 990
    assert told(gate, mixed) == [True, False]


def test_servo_record_without_voltage_is_rejected(gate: PlausibilityFilter):
    empty = blocks(1010)
    empty[1] = np.zeros(1, BLOCK_DTYPE)[0]
    assert told(gate, empty) == [True, False]
    assert gate.unmapped == {1}
    assert gate.blocks["volts"][1] == 120


def test_servo_with_discarded_history_may_report_any_position_in_range(gate: PlausibilityFilter):
    gate.forget(1)
    assert told(gate, blocks(5, position=3000)) == [False, True]


def test_silent_servo_keeps_its_last_record_and_time(gate: PlausibilityFilter):
    gate.begin()
    gate.admit(ALL_SERVOS, ServoReplies(blocks(1010, 2060), np.array([True, False]), False, 0), 1.01)
    assert gate.blocks["position"].tolist() == [2060, 2048]
    assert gate.times.tolist() == [1.01, 1.0]
    assert gate.fresh.tolist() == [True, False]


def test_returned_servo_records_are_immutable(gate: PlausibilityFilter):
    before, times = gate.blocks, gate.times
    kept = before.copy()
    told(gate, blocks(1010, 2060))
    told(gate, blocks(1020, position=3000), 1.02)
    gate.forget(0)
    assert (before == kept).all()
    assert times.tolist() == [1.0, 1.0]


def test_position_change_per_cycle_is_plausible_up_to_two_cycles_at_the_velocity_limit(gate: PlausibilityFilter):
    """The limit is 10943 ticks/s times 20 ms, plus the tolerance."""
    assert told(gate, blocks(1010, position=2048 + 218 + POSITION_TOLERANCE)) == [True, True]
    assert told(gate, blocks(1020, position=2048), 1.02) == [True, True]
    assert told(gate, blocks(1030, position=2048 + 219 + POSITION_TOLERANCE), 1.03) == [True, False]
    assert told(gate, blocks(1040, position=2048 - 219 - POSITION_TOLERANCE), 1.04) == [True, False]


def alone(made: PlausibilityFilter, block: Records, time: float) -> bool:
    """Return whether the second servo's record is accepted if queried alone."""
    made.begin()
    made.admit(np.array([1]), answer(block[1:]), time)
    return bool(made.fresh[1])


@pytest.mark.parametrize("sign", [-1, 1])
def test_plausible_position_change_of_a_silent_servo_grows_with_the_velocity_limit(sign: int):
    """The limit is 8192 ticks/s; times are sums of powers of two, so that sums are exact."""
    most = 8192 // 8 + POSITION_TOLERANCE
    for jump, believed in ((most, True), (most + 1, False)):
        made = make_filter("xm540_w270")
        made.admit(ALL_SERVOS, answer(blocks(1000, 0)), 1.0)
        assert alone(made, blocks(1125, 0, position=sign * jump), 1.125) is believed


@pytest.mark.parametrize("sign", [-1, 1])
def test_temperature_change_accepted_after_silence_grows_with_the_heating_rate(gate: PlausibilityFilter, sign: int):
    most = TEMPERATURE_TOLERANCE + round(MAX_HEATING_RATE / 4)
    assert not alone(gate, blocks(1250, temperature=40 + sign * (most + 1)), 1.25)
    gate.forget(1)
    assert alone(gate, blocks(1260, temperature=40), 1.25)
    assert alone(gate, blocks(1510, temperature=40 + sign * most), 1.5)


@pytest.mark.parametrize(
    ("first", "second", "same"),
    [
        ({"position": 3000}, {"position": 3000 + 2 * POSITION_TOLERANCE}, True),
        ({"position": 3000}, {"position": 3000 + 2 * POSITION_TOLERANCE + 1}, False),
        ({"temperature": 90}, {"temperature": 90 + TEMPERATURE_TOLERANCE}, True),
        ({"temperature": 90}, {"temperature": 90 - TEMPERATURE_TOLERANCE - 1}, False),
        ({"hardware_error": 4}, {"hardware_error": 4}, True),
        ({"hardware_error": 4}, {"hardware_error": 8}, False),
        ({"position": 3000}, {"position": 3000, "temperature": 60}, False),
        ({"position": 3000}, {"position": 3000, "hardware_error": 4}, False),
    ],
)
def test_implausible_servo_record_is_accepted_only_if_the_next_record_is_similar(
    gate: PlausibilityFilter, first: dict, second: dict, same: bool
):
    assert told(gate, blocks(1010, **first)) == [True, False]
    assert told(gate, blocks(1020, **second), 1.02) == [True, same]


def test_series_of_old_servo_records_interrupted_by_a_punctual_one_is_no_clock_restart(gate: PlausibilityFilter):
    """Three records of a seemingly restarted clock, one in time, and three again."""
    for begin in (0, 100):
        for k in range(3):
            time = 1.01 + (10 * k + begin) / 1000
            assert told(gate, blocks(1010 + 10 * k + begin, tick=500 + 10 * k + begin), time) == [True, False]
        assert told(gate, blocks(1050 + begin), 1.05 + begin / 1000) == [True, True]


def test_restarted_servo_clock_is_accepted_at_the_fourth_record(gate: PlausibilityFilter):
    heard = [told(gate, blocks(1010 + 10 * k, tick=10 * k), 1.01 + 0.01 * k)[1] for k in range(5)]
    assert heard == [False, False, False, True, True]


def test_discarding_a_servo_history_also_discards_its_unconfirmed_records(gate: PlausibilityFilter):
    """Unconfirmed records are old or implausible ones that await repetition."""
    told(gate, blocks(1010, position=3000), 1.01)
    for k in range(3):
        told(gate, blocks(1020 + 10 * k, tick=10 * k), 1.02 + 0.01 * k)
    gate.forget(1)
    gate.admit_late(ALL_SERVOS, answer(blocks(1045, tick=40)), 1.05, sent_at=1.045)
    assert told(gate, blocks(1050, tick=30), 1.05) == [True, False]
    assert told(gate, blocks(1060, tick=60, position=3000), 1.06) == [True, False]


def test_servo_record_received_after_half_a_clock_period_is_new(gate: PlausibilityFilter):
    """After 16.4 s, clock values no longer show which record is older."""
    assert not alone(gate, blocks(900), 1.0 + 16.383)
    assert alone(gate, blocks(900), 1.0 + 16.385)
