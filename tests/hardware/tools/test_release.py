import pytest

from kinesic.hardware.protocol.registers import HardwareError, Register
from kinesic.hardware.tools.release import release_servos
from kinesic.hardware.virtual.faults import FaultKind, FaultPlan, PlannedFault


def energise(table) -> None:
    for servo in table.servos.values():
        servo.write(Register.TORQUE_ENABLE.field.address, b"\1")


def released(table) -> tuple[str, ...]:
    return release_servos({"body": table.wire}, {"body": list(table.servos)}, {})


def test_release_tool_switches_torque_off_on_all_servos(bench):
    table = bench()
    energise(table)
    assert len(table.energised) == 23
    assert released(table) == ()
    assert table.energised == []


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("kind", ["corrupt", "lost", "drop", "noise"])
@pytest.mark.parametrize("way", ["reply", "request"])
def test_release_tool_reports_every_servo_that_may_keep_torque_after_wire_faults(
    bench, kind: FaultKind, seed: int, way
):
    table = bench(FaultPlan((PlannedFault(kind, rate=0.1, way=way),), seed))
    energise(table)
    doubts = released(table)
    held = table.energised
    assert held == [] or doubts, "who is not sure says so"
    assert len(held) <= len(doubts)


@pytest.mark.parametrize("error", list(HardwareError))
def test_release_tool_switches_torque_off_despite_an_alert_of_one_servo(bench, error: HardwareError):
    table = bench(FaultPlan((PlannedFault("alert", (3,), start=0.0, value=error.value),)))
    energise(table)
    assert released(table) == ()
    assert table.energised == []


def test_release_tool_switches_torque_off_on_a_servo_stopped_by_its_watchdog(bench):
    table = bench(FaultPlan((PlannedFault("watchdog", (2,), start=0.0),)))
    energise(table)
    assert released(table) == ()
    assert table.energised == []


def test_release_tool_reports_a_silent_servo(bench):
    table = bench(FaultPlan((PlannedFault("silent", (7,)),)))
    energise(table)
    assert released(table) == ("memory: servo 7: does not answer, and may still have torque; switch the power off",)
    assert table.energised == []


def test_release_tool_reports_a_servo_that_keeps_its_torque(bench, monkeypatch: pytest.MonkeyPatch):
    table = bench()
    energise(table)
    monkeypatch.setattr(table.servos[5], "write", lambda address, data: None)
    assert released(table) == ("memory: servo 5: keeps its torque; switch the power off",)
    assert table.energised == [5]


def test_release_tool_also_switches_torque_off_on_unexpected_servos(bench):
    table = bench()
    energise(table)
    assert release_servos({"body": table.wire}, {"body": [1, 2]}, {}) == ()
    assert table.energised == []


def test_release_tool_reports_a_lost_port(bench):
    table = bench(FaultPlan((PlannedFault("unplug", start=0.01, seconds=100.0),)))
    energise(table)
    (line,) = released(table)
    assert "the port is gone" in line
    assert "switch the power off" in line
