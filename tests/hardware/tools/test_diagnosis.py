from pathlib import Path

import pytest

from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.tools.diagnosis import ServoFinding, diagnose
from kinesic.hardware.virtual.faults import FaultPlan, PlannedFault


def found(table, system: Path = Path("/nowhere")) -> list[ServoFinding]:
    return list(diagnose(table.manifest, {"body": Path("ttyUSB7")}, lambda bus: table.wire, system=system))


def to_mend(table) -> list[str]:
    return [finding.text for finding in found(table) if not finding.well]


def test_diagnosis_finds_no_problem_with_healthy_servos(bench):
    findings = found(bench())
    assert all(finding.well for finding in findings)
    assert findings[-1].text == "23 of 23 are ready"


def test_diagnosis_has_a_line_for_each_faulty_servo_and_the_number_of_healthy_servos(bench):
    table = bench(FaultPlan((PlannedFault("silent", (7,)),)))
    table.set(4, Register.MODEL_NUMBER, 1060)
    table.set(6, Register.FIRMWARE_VERSION, 37)
    table.servos[12].write(Register.TORQUE_ENABLE.field.address, b"\1")
    table.set(13, Register.MAX_POSITION_LIMIT, 2500)
    table.servos[15].electronics.celsius = 75.0
    lines = to_mend(table)
    assert len(lines) == 6
    for start, remedy in (
        ("memory: servo 4: is a xl430_w250, must be a xm540_w270", "wrong id, or wrong robot?"),
        ("memory: servo 6: firmware 37 has no bus watchdog", "DYNAMIXEL Wizard"),
        ("memory: servo 7: no answer", "kinesic servos scan"),
        ("memory: servo 12 (l_shoulder_flexion): has torque", "kinesic servos release"),
        ("memory: servo 13 (l_shoulder_abduct): takes 0..2500 ticks", "widen"),
        ("memory: servo 15 (l_elbow_flexion): is at 75 C", "let it cool"),
    ):
        (line,) = [line for line in lines if line.startswith(start)]
        assert remedy in line
    assert found(table)[-1].text == "17 of 23 are ready"


@pytest.mark.parametrize(("margin", "is_hot"), [(10, False), (9, True)])
def test_servo_is_hot_within_less_than_ten_kelvin_of_its_limit(bench, margin: int, is_hot: bool):
    table = bench()
    servo = table.servos[15]
    servo.electronics.celsius = float(servo.memory[Register.TEMPERATURE_LIMIT] - margin)
    assert ["let it cool" in line for line in to_mend(table)] == [True] * is_hot


def test_bus_without_answering_servos_is_reported_in_one_line(bench):
    table = bench(FaultPlan((PlannedFault("silent"),)))
    (line,) = to_mend(table)
    assert "no servo of ids" in line


def test_diagnosis_reports_a_low_supply_voltage(bench):
    table = bench(FaultPlan((PlannedFault("undervoltage", start=0.0, value=5.0),)))
    table.wire.sleep(0.1)
    lines = to_mend(table)
    assert any("supply is 5.0 V" in line for line in lines)


def test_diagnosis_names_the_remedy_for_a_slow_adapter(bench, tmp_path: Path):
    setting = tmp_path / "bus/usb-serial/devices/ttyUSB7/latency_timer"
    setting.parent.mkdir(parents=True)
    setting.write_text("16\n")
    (finding,) = [finding for finding in found(bench(), tmp_path) if finding.about == "latency"]
    assert not finding.well
    assert "udev" in finding.text
    setting.write_text("1\n")
    assert all(finding.well for finding in found(bench(), tmp_path))


@pytest.mark.parametrize("is_unplugged", [False, True])
def test_diagnosis_closes_its_port_with_and_without_an_error(bench, is_unplugged: bool):
    table = bench()
    closed: list[str] = []
    table.wire.close = lambda: closed.append("body")

    def unplugged(data: bytes) -> None:
        raise BusError("body: the port is gone")

    if is_unplugged:
        table.wire.write = unplugged
    assert all(finding.well for finding in found(table)) != is_unplugged
    assert closed == ["body"]


def test_diagnosis_reports_ports_that_are_not_given_or_cannot_be_opened(bench):
    table = bench()

    def shut(bus: str):
        raise BusError(f"{bus}: no permission")

    for ports, text in (({}, "missing; give --port body=PATH"), ({"body": Path("x")}, "body: no permission")):
        load, port = diagnose(table.manifest, ports, shut)
        assert (load.about, load.well) == ("load", True)
        assert port == ServoFinding("body", "port", False, text)


def test_diagnosis_computes_the_bus_load_without_opening_the_port(bench):
    findings = diagnose(bench().manifest, {}, lambda bus: None, period=0.004)
    load = next(iter(findings))
    assert (load.about, load.well) == ("load", False)
    assert load.text.startswith("23 servos at 1000000 baud use 192 % of the bus; set servos and robot file to 3000000")
