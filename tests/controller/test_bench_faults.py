"""The tables of the fault matrix."""

import pytest

from kinesic.controller.bench import faults


def test_every_driver_has_a_table_and_who_is_not_installed_a_reason(monkeypatch: pytest.MonkeyPatch):
    asked: list[object] = []

    def one(opens: object, **named: object) -> list[object]:
        asked.append(opens)
        return []

    monkeypatch.setattr(faults, "matrix", one)
    monkeypatch.setattr(faults, "MISSING", {"lerobot": lambda: "not here", "lerobot, 3 retries": lambda: ""})
    found = list(faults.tables(sizes=(7,), bauds=(1_000_000,), seeds=(0,)))
    assert [table.splitlines()[0] for table in found] == ["kinesic", "dynamixel-sdk", "lerobot", "lerobot, 3 retries"]
    assert found[2] == "lerobot\n\nnull: not here\n"
    assert len(asked) == 3
