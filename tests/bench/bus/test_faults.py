"""Fault matrix of every driver, as tables and as JSON."""

import json

import pytest
from click.testing import CliRunner

from kinesic import cli
from kinesic.bench.bus import faults
from kinesic.bench.bus.matrix import FaultCase


def test_fault_benchmark_prints_a_table_or_a_reason_for_each_driver(monkeypatch: pytest.MonkeyPatch):
    factories: list[object] = []

    def no_trials(make_driver: object, **named: object) -> list[object]:
        factories.append(make_driver)
        return []

    monkeypatch.setattr(faults, "run_matrix", no_trials)
    monkeypatch.setattr(faults, "MISSING_REASONS", {"lerobot": lambda: "not here", "lerobot, 3 retries": lambda: ""})
    tables = [str(trials) for trials in faults.compare_drivers(sizes=(7,), bauds=(1_000_000,), seeds=(0,))]
    assert [table.splitlines()[0] for table in tables] == ["kinesic", "dynamixel-sdk", "lerobot", "lerobot, 3 retries"]
    assert tables[2] == "lerobot\n\nnull: not here\n"
    assert len(factories) == 3


def test_fault_benchmark_json_contains_trials_and_reasons_for_missing_drivers(monkeypatch: pytest.MonkeyPatch):
    def one_trial(make_driver: faults.DriverFactory, **named: object) -> list[faults.TrialResult]:
        return [faults.run_trial(FaultCase("calm"), make_driver, servos=2, baud=57_600, seed=3, cycles=4)]

    monkeypatch.setattr(faults, "run_matrix", one_trial)
    monkeypatch.setattr(
        faults, "DRIVER_FACTORIES", {"kinesic": faults.DRIVER_FACTORIES["kinesic"], "lerobot": one_trial}
    )
    monkeypatch.setattr(faults, "MISSING_REASONS", {"lerobot": lambda: "not here"})
    printed = CliRunner().invoke(cli.kinesic, ["bench", "bus", "--matrix", "--json"], standalone_mode=False)
    kinesic, lerobot = json.loads(printed.output)
    (record,) = kinesic["trials"]
    assert (record["case"], record["servos"], record["baud"], record["seed"]) == ("calm", 2, 57_600, 3)
    assert (record["exceptions"], record["wrong"], record["fresh"]) == (0, 0, 1.0)
    assert 0 < record["p99_s"] < record["period_s"]
    assert lerobot == {"driver": "lerobot", "why": "not here", "trials": []}
