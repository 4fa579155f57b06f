import numpy as np
import pytest

from kinesic.controller.bench import faults
from kinesic.hardware.virtual.matrix import Result, cases


def result(case: str, **figures: object) -> Result:
    return Result(case, 14, 1_000_000, 0, durations=np.full(100, 0.005), fresh=1.0, **figures)


def test_every_fault_has_its_figure_and_goal(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(faults, "trial", lambda case, opens, **named: result(case.name))
    figures = {figure.name: figure for figure in faults.bench()}
    assert len([name for name in figures if name.endswith(".wrong")]) == len(cases())
    assert figures["bus.fault.corrupt_1.fresh"].value == 100.0
    assert figures["bus.fault.mixed_6_2.p99"].value == pytest.approx(0.5)
    assert all(figure.ok for figure in figures.values())


def test_what_is_missed_shows(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(faults, "trial", lambda case, opens, **named: result(case.name, wrong=1, told=0.03))
    figures = {figure.name: figure for figure in faults.bench()}
    assert figures["bus.fault.alert_overload.told"].value == pytest.approx(3.0)
    assert figures["bus.fault.alert_overload.told"].ok is False
    assert figures["bus.fault.calm.wrong"].value == 3
    assert figures["bus.fault.calm.wrong"].ok is False


def test_servos_that_must_be_refused_are(monkeypatch: pytest.MonkeyPatch):
    real = {"duplicate id", "wrong model"}
    monkeypatch.setattr(faults, "cases", lambda: tuple(case for case in cases() if case.name in real))
    monkeypatch.setattr(faults, "SEEDS", (0,))
    figures = faults.bench()
    assert [figure.name for figure in figures] == ["bus.fault.duplicate_id.wrong", "bus.fault.wrong_model.wrong"]
    assert all("refused: memory: servo 2" in figure.why for figure in figures)


def test_the_table_sets_drivers_side_by_side(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("kinesic.hardware.virtual.matrix.cases", lambda: cases()[:1])
    kinesic, sdk = faults.tables(sizes=(2,), bauds=(1_000_000,), seeds=(0,))
    assert kinesic.startswith("kinesic\n\nfault ")
    assert sdk.startswith("dynamixel-sdk\n\nfault ")
    assert kinesic.splitlines()[3].split()[:3] == ["calm", "2", "1000000"]
