from types import SimpleNamespace

import pytest

from kinesic.hardware.protocol.device import PingReply
from kinesic.hardware.protocol.registers import HardwareError, Register
from kinesic.hardware.protocol.tables import FAMILY_TABLES
from kinesic.hardware.protocol.wire import Wire
from kinesic.hardware.tools.survey import (
    CountingWire,
    FoundServo,
    _frame_protocol,
    find_unexpected_servos,
    open_slow_access,
    scan_bus,
    survey,
)
from kinesic.hardware.virtual.faults import NO_FAULTS, FaultPlan, PlannedFault
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus


def port(baud: int = 1_000_000, faults: FaultPlan = NO_FAULTS):
    """Return a function that opens a wire with three servos at a baud rate."""
    _, buses = build_bus(
        [
            Cable(
                "body",
                (ServoFitting(1), ServoFitting(7, model="xl430_w250"), ServoFitting(20)),
                baud=baud,
                faults=faults,
            )
        ]
    )

    wires = [MemoryWire(buses["body"])]

    def opened(rate: int) -> Wire:
        wires.append(MemoryWire(buses["body"], time=wires[-1].now()))
        wires[-1].baud = rate
        return wires[-1]

    return opened


@pytest.mark.parametrize("baud", [57_600, 1_000_000, 4_000_000])
def test_bus_scan_finds_servos_at_their_baud_rate(baud: int):
    steps: list[int] = []
    servos = scan_bus(port(baud), bauds=(57_600, 1_000_000, 4_000_000), step=lambda: steps.append(1))
    assert servos == (
        FoundServo(PingReply(1, 1020, 52), baud, shared=False),
        FoundServo(PingReply(7, 1060, 52), baud, shared=False),
        FoundServo(PingReply(20, 1020, 52), baud, shared=False),
    )
    assert len(steps) == 3


def test_bus_scan_of_given_ids_finds_each_answering_servo_once():
    servos = scan_bus(port(), bauds=(1_000_000,), ids=(7, 8))
    assert [sighting.servo.id for sighting in servos] == [1, 7, 20]


def test_bus_scan_reports_an_id_shared_by_several_servos():
    faults = FaultPlan((PlannedFault("duplicate_id", servos=(20,)),))
    servos = scan_bus(port(faults=faults), bauds=(1_000_000,), ids=(20,))
    assert [sighting.servo.id for sighting in servos if not sighting.shared] == [1, 7]


def test_servo_survey_of_a_robot_at_rest_reads_all_servos_and_their_differing_position_limits(bench):
    table = bench()
    seen = survey(table.manifest, {"body": table.wire})
    assert [item.member.id for item in seen] == [member.id for member in table.manifest.members]
    assert all(item.right and not item.torque and not item.errors for item in seen)
    elbow = next(item for item in seen if item.member.hinge == "l_elbow_flexion")
    assert elbow.degrees == pytest.approx(18.0, abs=0.1)  # at rest
    assert (elbow.volts, elbow.celsius) == (12.0, 25)
    assert {change.register for change in elbow.differs} == {Register.MIN_POSITION_LIMIT, Register.MAX_POSITION_LIMIT}


def test_servo_survey_reports_faulty_servos_and_reads_all_other_servos(bench):
    table = bench(FaultPlan((PlannedFault("silent", (7,)), PlannedFault("alert", (5,), start=0.001))))
    table.set(4, Register.MODEL_NUMBER, 1060)
    table.set(6, Register.RETURN_DELAY_TIME, 250)
    table.servos[12].write(Register.TORQUE_ENABLE.field.address, b"\1")
    table.wire.sleep(0.1)
    seen = {item.member.id: item for item in survey(table.manifest, {"body": table.wire})}
    assert seen[7].model_name == ""
    assert (seen[4].model_name, seen[4].right) == ("xl430_w250", False)
    assert seen[5].errors == ("overload",)
    assert any((c.register, c.before, c.after) == (Register.RETURN_DELAY_TIME, 250, 0) for c in seen[6].differs)
    assert seen[12].torque
    assert sum(item.right for item in seen.values()) == 21


def test_servo_survey_reads_servos_whose_status_return_level_is_zero(bench):
    table = bench()
    for servo in table.servos:
        table.set(servo, Register.STATUS_RETURN_LEVEL, 0)
    assert all(item.right for item in survey(table.manifest, {"body": table.wire}))


def test_servo_survey_reports_unexpected_servos(bench):
    table = bench()
    expected = [servo for servo in table.servos if servo != 28]
    assert find_unexpected_servos(open_slow_access(table.wire), expected) == ("28 (xc330_t288)",)


def test_hardware_error_bits_of_a_servo_are_reported_by_name():
    assert HardwareError.names(HardwareError.OVERLOAD.value | HardwareError.VOLTAGE.value) == ("voltage", "overload")
    assert HardwareError.names(0) == ()


@pytest.mark.parametrize(
    ("family", "protocol"), [("sts", "Feetech"), ("scs", "Feetech"), ("ax", "Protocol 1.0"), (None, "Protocol 1.0")]
)
def test_protocol_of_a_servo_with_frames_is_that_of_its_maker(family: str | None, protocol: str):
    model = None if family is None else SimpleNamespace(table=FAMILY_TABLES[family])
    assert _frame_protocol(SimpleNamespace(model=model)) == protocol
    assert _frame_protocol(SimpleNamespace(model=SimpleNamespace(table=None))) == "Protocol 1.0"


@pytest.mark.parametrize("is_back", [True, False])
def test_counting_wire_reopens_and_closes_the_wire_that_it_counts(is_back: bool):
    calls: list[str] = []
    wire = SimpleNamespace(reopen=lambda: calls.append("reopen") or is_back, close=lambda: calls.append("close"))
    counting = CountingWire(wire)
    assert counting.reopen() == is_back
    counting.close()
    assert calls == ["reopen", "close"]
