"""The fault matrix for every driver: as tables, and for machines."""

import json

import pytest
from click.testing import CliRunner

from kinesic import cli
from kinesic.bench.bus import faults
from kinesic.bench.bus.matrix import FaultCase


def test_every_driver_has_a_table_and_who_is_not_installed_a_reason(monkeypatch: pytest.MonkeyPatch):
    asked: list[object] = []

    def one(opens: object, **named: object) -> list[object]:
        asked.append(opens)
        return []

    monkeypatch.setattr(faults, "matrix", one)
    monkeypatch.setattr(faults, "MISSING", {"lerobot": lambda: "not here", "lerobot, 3 retries": lambda: ""})
    found = [str(trials) for trials in faults.compare_drivers(sizes=(7,), bauds=(1_000_000,), seeds=(0,))]
    assert [table.splitlines()[0] for table in found] == ["kinesic", "dynamixel-sdk", "lerobot", "lerobot, 3 retries"]
    assert found[2] == "lerobot\n\nnull: not here\n"
    assert len(asked) == 3


def test_machines_read_every_trial(monkeypatch: pytest.MonkeyPatch):
    def one(opens: faults.Opens, **named: object) -> list[faults.TrialResult]:
        return [faults.trial(FaultCase("calm"), opens, servos=2, baud=57_600, seed=3, cycles=4)]

    monkeypatch.setattr(faults, "matrix", one)
    monkeypatch.setattr(faults, "DRIVERS", {"kinesic": faults.DRIVERS["kinesic"], "lerobot": one})
    monkeypatch.setattr(faults, "MISSING", {"lerobot": lambda: "not here"})
    printed = CliRunner().invoke(cli.kinesic, ["bench", "bus", "--matrix", "--json"], standalone_mode=False)
    kinesic, lerobot = json.loads(printed.output)
    (trial,) = kinesic["trials"]
    assert (trial["case"], trial["servos"], trial["baud"], trial["seed"]) == ("calm", 2, 57_600, 3)
    assert (trial["exceptions"], trial["wrong"], trial["fresh"]) == (0, 0, 1.0)
    assert 0 < trial["p99_s"] < trial["period_s"]
    assert lerobot == {"driver": "lerobot", "why": "not here", "trials": []}
