import pytest

from kinesic.hardware.bus.bring_up import open_bus
from kinesic.hardware.bus.dialect import Servo
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.virtual.faults import NO_FAULTS, FaultPlan, PlannedFault
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.shaft_simulation import ShaftSimulation
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus

MODEL = SERVO_MODELS["xm430_w350"]


def wire_of(faults: FaultPlan = NO_FAULTS, baud: int = 1_000_000, count: int = 3) -> tuple[MemoryWire, ShaftSimulation]:
    plant, buses = build_bus(
        [Cable("body", tuple(ServoFitting(k + 1) for k in range(count)), baud=baud, faults=faults)]
    )
    return MemoryWire(buses["body"], name="/dev/ttyUSB0"), plant


def refused(*faults: PlannedFault, ids: tuple[int, ...] = (1, 2, 3), host_baud: int | None = None) -> str:
    """Return the error of a bus that cannot be opened."""
    wire, plant = wire_of(FaultPlan(faults))
    if host_baud is not None:
        wire.baud = host_baud
    wire.sleep(0.1)
    with pytest.raises(BusError) as error:
        open_bus(wire, [Servo(servo, MODEL) for servo in ids])
    assert not any(servo.memory[Register.TORQUE_ENABLE] for servo in plant.servos)
    return str(error.value)


def test_opening_a_bus_leaves_servo_torque_off():
    wire, plant = wire_of()
    bus = open_bus(wire, [Servo(servo, MODEL) for servo in (3, 1, 2)])
    assert bus.fast
    assert bus.ids == (3, 1, 2)
    assert not any(servo.memory[Register.TORQUE_ENABLE] for servo in plant.servos)


def test_reopening_a_bus_keeps_servo_torque_on():
    wire, plant = wire_of()
    servos = [Servo(servo, MODEL) for servo in (1, 2, 3)]
    open_bus(wire, servos)
    for servo in plant.servos:
        servo.memory[Register.TORQUE_ENABLE] = 1
    assert open_bus(wire, servos).cycle().raw_values("torque").tolist() == [1, 1, 1]


def test_error_for_a_bus_without_any_answering_servo_names_the_ids_and_the_baud_rate():
    assert refused(host_baud=57_600) == (
        "/dev/ttyUSB0: no servo of ids 1, 2, 3 at 57600 baud; is the power on, is the baud rate right?"
    )


def test_error_for_a_bus_with_other_servo_ids_lists_the_servos_that_answer():
    assert "answering: 1 (xm430_w350), 2 (xm430_w350), 3 (xm430_w350)" in refused(ids=(11, 12))


def test_error_names_a_servo_that_the_bus_lacks():
    assert refused(ids=(1, 2, 3, 4)) == (
        "/dev/ttyUSB0: servo 4: no answer at 1000000 baud; `kinesic servos scan` lists the servos"
    )


def test_error_for_a_servo_of_a_wrong_model_names_both_models():
    said = refused(PlannedFault("wrong_model", servos=(2,)))
    assert said == "/dev/ttyUSB0: servo 2: is a xl430_w250, must be a xm430_w350; wrong id, or wrong robot?"


def test_firmware_without_watchdog_is_refused():
    said = refused(PlannedFault("old_firmware", servos=(2,), value=36))
    assert "servo 2: firmware 36 has no bus watchdog, must be 38 or newer" in said


def test_opening_a_bus_with_two_servos_of_one_id_is_refused():
    assert "servo 2:" in refused(PlannedFault("duplicate_id", servos=(2,)))


def test_servos_with_low_supply_voltage_are_refused():
    assert refused(PlannedFault("undervoltage", value=9.0)).splitlines() == [
        f"/dev/ttyUSB0: servo {servo}: supply is 9.0 V, must be at least 9.5 V" for servo in (1, 2, 3)
    ]


def test_error_for_two_faulty_servos_has_one_line_per_servo():
    said = refused(PlannedFault("wrong_model", servos=(1,)), PlannedFault("old_firmware", servos=(3,), value=36))
    assert [line.split(":")[1] for line in said.splitlines()] == [" servo 1", " servo 3"]


@pytest.mark.parametrize(("count", "is_fast"), [(1, False), (2, True)])
def test_opened_bus_uses_fast_reads_only_with_at_least_two_servos(count: int, is_fast: bool):
    wire, _ = wire_of(count=count)
    bus = open_bus(wire, [Servo(k + 1, MODEL) for k in range(count)])
    assert bus.fast is is_fast
    assert bus.cycle().fresh.all()


def test_bus_with_firmware_without_fast_reads_uses_plain_reads():
    wire, _ = wire_of(FaultPlan((PlannedFault("old_firmware", servos=(2,), value=41),)))
    bus = open_bus(wire, [Servo(servo, MODEL) for servo in (1, 2, 3)])
    assert not bus.fast
    assert bus.cycle().fresh.all()
