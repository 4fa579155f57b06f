"""Fault matrix in virtual time, with each fault once for two drivers.

The drivers are kinesic's bus and dynamixel-sdk.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from kinesic.bench.bus.drivers import DriverReading, KinesicDriver, SdkDriver
from kinesic.bench.bus.faults import TABLE_COLUMNS, format_table, table_rows
from kinesic.bench.bus.matrix import BUS_PERIOD, FaultCase, TrialResult, list_cases, run_trial
from kinesic.body.arrays import Floats

FAULT_CASES = {case.name: case for case in list_cases()}
REFUSAL_REASONS = {
    "duplicate id": "several servos have this id",
    "wrong model": "is a xl430_w250, must be a xm430_w350",
}


@cache
def run_driver(driver: str, case: str, cycles: int = 120) -> TrialResult:
    make_driver = {"kinesic": KinesicDriver, "sdk": SdkDriver}[driver]
    return run_trial(FAULT_CASES[case], make_driver, servos=7, baud=1_000_000, seed=1, cycles=cycles)


@pytest.mark.parametrize(
    "case", [pytest.param(name, marks=[pytest.mark.soak] * ("1%" in name)) for name in FAULT_CASES]
)
def test_kinesic_driver_refuses_or_survives_each_bus_fault_without_wrong_positions(case: str):
    result = run_driver("kinesic", case)
    if case in REFUSAL_REASONS:
        assert REFUSAL_REASONS[case] in result.refused
        return
    assert result.refused == ""
    assert (result.exceptions, result.wrong) == (0, 0)
    assert result.durations.max() <= BUS_PERIOD
    assert result.fresh > 0.85


@pytest.mark.parametrize(
    "case", [name for name in FAULT_CASES if name.startswith("alert")] + ["overheat", "undervoltage"]
)
def test_kinesic_reports_a_servo_hardware_error_within_one_bus_cycle(case: str):
    result = run_driver("kinesic", case)
    assert result.reported is not None
    assert result.reported <= BUS_PERIOD
    assert run_driver("sdk", case, 60).reported is None, "the SDK discards the alert"


def test_dynamixel_sdk_fails_with_silent_unplugged_or_duplicate_servos():
    assert run_driver("sdk", "calm").fresh == 1.0
    silent = run_driver("sdk", "silent")
    assert silent.fresh < 0.7, "one silent servo prevents all readings"
    assert silent.duration(99) > 0.03
    unplugged = run_driver("sdk", "unplug")
    assert unplugged.exceptions >= 1
    assert unplugged.fresh < 0.7, "the port stays busy"
    assert run_driver("sdk", "duplicate id").wrong > 0


def test_late_replies_cause_no_exceptions_or_wrong_positions_in_the_kinesic_driver():
    result = run_trial(FAULT_CASES["late 5%"], KinesicDriver, servos=7, baud=57_600, seed=0, cycles=150)
    assert (result.exceptions, result.wrong) == (0, 0)


def test_same_seed_gives_the_same_fault_trial():
    first = run_trial(FAULT_CASES["mixed 6 x 2%"], SdkDriver, servos=3, baud=1_000_000, seed=4, cycles=50)
    second = run_trial(FAULT_CASES["mixed 6 x 2%"], SdkDriver, servos=3, baud=1_000_000, seed=4, cycles=50)
    assert (first.durations == second.durations).all()
    other = run_trial(FAULT_CASES["mixed 6 x 2%"], SdkDriver, servos=3, baud=1_000_000, seed=5, cycles=50)
    assert (first.durations != other.durations).any()


def test_wrong_servo_positions_are_counted():
    class WrongDriver(SdkDriver):
        def cycle(self, goals: Floats) -> DriverReading:
            reading = super().cycle(goals)
            return replace(reading, positions=reading.positions + np.array([100, 0]))

    assert run_trial(FaultCase("calm"), WrongDriver, servos=2, baud=1_000_000, seed=0, cycles=20).wrong == 20


def test_driver_comparison_table_has_a_row_per_bus_fault():
    results = [run_driver("kinesic", name) for name in ("calm", "corrupt 1%", "wrong model")]
    table = table_rows(results)
    assert [row[0] for row in table] == ["calm", "corrupt 1%", "wrong model"]
    assert {len(row) for row in table} == {len(TABLE_COLUMNS)}
    assert table[0][3:6] == ("0", "0", "100.00")
    assert format_table(results).count("\n") == 3
