"""A small sample of the fault matrix, in virtual time: each fault once, for kinesic's bus and for dynamixel-sdk."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from kinesic.bench.bus.drivers import DriverReading, KinesicDriver, SdkDriver
from kinesic.bench.bus.faults import COLUMNS, rows, text
from kinesic.bench.bus.matrix import PERIOD, FaultCase, TrialResult, cases, trial
from kinesic.body.arrays import Floats

CASES = {case.name: case for case in cases()}
REFUSED = {"duplicate id": "several servos have this id", "wrong model": "is a xl430_w250, must be a xm430_w350"}


@cache
def driven(driver: str, case: str, cycles: int = 120) -> TrialResult:
    opens = {"kinesic": KinesicDriver, "sdk": SdkDriver}[driver]
    return trial(CASES[case], opens, servos=7, baud=1_000_000, seed=1, cycles=cycles)


@pytest.mark.parametrize("case", CASES)
def test_kinesic_never_raises_and_believes_nothing_wrong(case: str):
    result = driven("kinesic", case)
    if case in REFUSED:
        assert REFUSED[case] in result.refused
        return
    assert result.refused == ""
    assert (result.exceptions, result.wrong) == (0, 0)
    assert result.durations.max() <= PERIOD
    assert result.fresh > 0.85


@pytest.mark.parametrize("case", [name for name in CASES if name.startswith("alert")] + ["overheat", "undervoltage"])
def test_kinesic_tells_of_a_hardware_error_within_a_cycle(case: str):
    result = driven("kinesic", case)
    assert result.reported is not None
    assert result.reported <= PERIOD
    assert driven("sdk", case, 60).reported is None, "the SDK throws the alert away"


def test_the_sdk_shows_the_weaknesses_that_its_users_report():
    assert driven("sdk", "calm").fresh == 1.0
    silent = driven("sdk", "silent")
    assert silent.fresh < 0.7, "one silent servo, and nobody is read"
    assert silent.duration(99) > 0.03
    unplugged = driven("sdk", "unplug")
    assert unplugged.exceptions >= 1
    assert unplugged.fresh < 0.7, "the port is busy for ever"
    assert driven("sdk", "duplicate id").wrong > 0


def test_a_late_and_broken_answer_is_not_taken_for_the_one_that_was_asked_for():
    result = trial(CASES["late 5%"], KinesicDriver, servos=7, baud=57_600, seed=0, cycles=150)
    assert (result.exceptions, result.wrong) == (0, 0)


def test_the_same_seed_is_the_same_run():
    once = trial(CASES["mixed 6 x 2%"], SdkDriver, servos=3, baud=1_000_000, seed=4, cycles=50)
    again = trial(CASES["mixed 6 x 2%"], SdkDriver, servos=3, baud=1_000_000, seed=4, cycles=50)
    assert (once.durations == again.durations).all()
    other = trial(CASES["mixed 6 x 2%"], SdkDriver, servos=3, baud=1_000_000, seed=5, cycles=50)
    assert (once.durations != other.durations).any()


def test_a_lie_is_noticed():
    class Liar(SdkDriver):
        def cycle(self, goals: Floats) -> DriverReading:
            reading = super().cycle(goals)
            return replace(reading, positions=reading.positions + np.array([100, 0]))

    assert trial(FaultCase("calm"), Liar, servos=2, baud=1_000_000, seed=0, cycles=20).wrong == 20


def test_the_table_has_a_row_for_each_fault():
    results = [driven("kinesic", name) for name in ("calm", "corrupt 1%", "wrong model")]
    table = rows(results)
    assert [row[0] for row in table] == ["calm", "corrupt 1%", "wrong model"]
    assert {len(row) for row in table} == {len(COLUMNS)}
    assert table[0][3:6] == ("0", "0", "100.00")
    assert text(results).count("\n") == 3
