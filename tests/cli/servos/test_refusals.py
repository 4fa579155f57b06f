"""Refusals of `kinesic perform --on servos` before any servo gets torque."""

from collections.abc import Callable
from pathlib import Path

import pytest
import serial

from kinesic.cli import perform
from kinesic.controller.dry_run import dry_runs
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.virtual.faults import FaultPlan, PlannedFault
from kinesic.metrics.dry_run import DryRun
from kinesic.report import output
from kinesic.session.plan import plan
from kinesic.sim.servo_factors import NOMINAL_FACTORS

from .conftest import Table, serving

pytestmark = pytest.mark.realtime

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.8"/></bml>'
FAULT_REASONS = [
    (PlannedFault("silent"), "no servo of ids"),
    (PlannedFault("wrong_model", (15,)), "servo 15: is a xl430_w250, must be a xm430_w210"),
    (PlannedFault("old_firmware", (15,), value=37), "firmware 37 has no bus watchdog"),
    (PlannedFault("duplicate_id", (15,)), "several servos have this id"),
    (PlannedFault("undervoltage", (15,), value=5.0), "supply is 5.0 V"),
    (PlannedFault("alert", (15,), value=32), "has shut down (overload)"),
]


FAULTS_OF_ONE_CHECK = {"wrong_model", "old_firmware", "undervoltage"}  # refused like an alert


@pytest.fixture(scope="module")
def twins() -> tuple[DryRun, ...]:
    """Dry runs of a nod in the twin."""
    return dry_runs(plan(NOD), (NOMINAL_FACTORS,))


@pytest.fixture(autouse=True)
def _once(monkeypatch: pytest.MonkeyPatch, twins: tuple[DryRun, ...]) -> None:
    """Reuse one dry run in all tests, and skip the report page."""
    monkeypatch.setattr(perform, "_perform_in_twins", lambda *_, **__: twins)
    monkeypatch.setattr(output, "write_page", lambda *_, path: path.touch())


@pytest.fixture
def nod(tmp_path: Path) -> Path:
    path = tmp_path / "nod.bml"
    path.write_text(NOD, encoding="utf-8")
    return path


def refused(kinesic: Callable, nod: Path, table: Table) -> str:
    """Perform on servos, and return the one line of the refusal."""
    ended = kinesic("perform", nod, "--no-film", "--json", "--on", "servos", "--port", table.port)
    lines = [line for line in ended.err.splitlines() if line.startswith("kinesic: ")]
    assert ended.code == 2
    assert len(lines) == 1, ended.err
    assert table.energised == 0
    return lines[0]


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        pytest.param(*case, id=case[0].kind, marks=[pytest.mark.soak] * (case[0].kind in FAULTS_OF_ONE_CHECK))
        for case in FAULT_REASONS
    ],
)
def test_perform_refuses_faulty_servos_with_one_line_that_names_the_fault(
    kinesic: Callable, nod: Path, tmp_path: Path, fault: PlannedFault, message: str
):
    with serving(Table(FaultPlan((fault,))), tmp_path / "port") as table:
        assert message in refused(kinesic, nod, table)


def test_perform_refuses_servo_limits_narrower_than_the_joint_range(kinesic: Callable, nod: Path, served: Table):
    served.set(15, Register.MAX_POSITION_LIMIT, 2100)
    assert "its hinge needs" in refused(kinesic, nod, served)


def test_perform_refuses_a_busy_servo_port_with_one_line(kinesic: Callable, nod: Path, served: Table):
    wire = SerialWire(served.port, 1_000_000)
    assert "another program uses this port" in refused(kinesic, nod, served)
    wire.close()


def test_release_verb_refuses_a_port_without_permission_and_names_the_remedy(
    kinesic: Callable, monkeypatch: pytest.MonkeyPatch, served: Table
):
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(serial, "Serial", refuse)
    ended = kinesic("servos", "release", "--yes", "--port", served.port)
    assert ended.code == 2
    (line,) = ended.err.splitlines()
    assert "dialout" in line
