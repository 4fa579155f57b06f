from collections.abc import Callable

import pytest

from kinesic.hardware.protocol.device import PingReply, RegisterChange, ServoAccess
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.virtual.faults import FaultPlan, PlannedFault
from kinesic.hardware.virtual.wiring import Cable, ServoFitting

from ..conftest import BUILDERS

FOUR_BYTES = (Register.MIN_POSITION_LIMIT, Register.MAX_POSITION_LIMIT, Register.HOMING_OFFSET, Register.GOAL_POSITION)
Make = Callable  # of a rig, see conftest


@pytest.fixture
def cold(rig: Make) -> ServoAccess:
    return ServoAccess(rig(3).wire)


def test_ping_of_a_servo_returns_its_model_and_firmware_version(cold: ServoAccess):
    reply = cold.ping(2)
    assert reply == PingReply(2, 1020, 52)
    assert reply.name == "xm430_w350"
    assert PingReply(1, 77, 1).name == "model 77"
    assert cold.ping(9) is None


def test_bus_scan_finds_all_servos(cold: ServoAccess):
    assert [item.id for item in cold.ping_all()] == [1, 2, 3]


def test_servo_registers_are_read_and_written(cold: ServoAccess):
    cold.write(1, Register.HOMING_OFFSET, -5)
    assert cold.read(1, Register.HOMING_OFFSET) == -5
    assert cold.read_span(1, 144, 3) == bytes((120, 0, cold.read(1, Register.PRESENT_TEMPERATURE)))


def test_several_registers_of_a_servo_are_read_at_once(cold: ServoAccess):
    registers = [Register.PRESENT_TEMPERATURE, Register.PRESENT_INPUT_VOLTAGE, Register.ID]
    assert cold.read_several(2, registers) == {register: cold.read(2, register) for register in registers}


def test_error_of_a_register_read_names_the_silent_servo_and_the_register(cold: ServoAccess):
    with pytest.raises(BusError, match=r"memory: servo 9: read of 4 bytes at 132.*is it powered, wired"):
        cold.read(9, Register.PRESENT_POSITION)


@pytest.mark.parametrize("latency", [0.001, 0.008, 0.012, 0.016, 0.030])
def test_late_reply_of_a_slow_adapter_is_not_taken_as_the_reply_to_another_read(servos: str, latency: float):
    build, wire_of = BUILDERS[servos]
    plant, buses = build([Cable("body", (ServoFitting(1, model="xm430_w350"),), latency=latency)])
    cold, right = ServoAccess(wire_of(buses["body"])), list[bool]()
    for register in FOUR_BYTES * 3:
        try:
            right.append(cold.read(1, register) == plant.servos[0].memory[register])
        except BusError:
            continue
    assert all(right)
    assert len(right) == 3 * len(FOUR_BYTES) or latency > 0.016


def test_refused_instruction_error_names_the_fault(cold: ServoAccess):
    with pytest.raises(BusError, match=r"servo 1: write of OPERATING_MODE at 11 refused \(range error\)"):
        cold.write(1, Register.OPERATING_MODE, 7)
    with pytest.raises(BusError, match=r"write of PRESENT_POSITION at 132 refused \(access error\)"):
        cold.write(1, Register.PRESENT_POSITION, 1)


def test_configuration_writes_only_registers_whose_values_differ(cold: ServoAccess):
    wanted = {Register.MAX_POSITION_LIMIT: 3000, Register.MIN_POSITION_LIMIT: 0, Register.PROFILE_VELOCITY: 100}
    assert cold.configure(1, wanted) == (
        RegisterChange(1, Register.MAX_POSITION_LIMIT, 4095, 3000),
        RegisterChange(1, Register.PROFILE_VELOCITY, 0, 100),
    )
    assert cold.configure(1, wanted) == ()


def test_eeprom_registers_are_not_written_while_torque_is_on(cold: ServoAccess):
    cold.write(1, Register.TORQUE_ENABLE, 1)
    with pytest.raises(BusError, match="MAX_POSITION_LIMIT cannot be set while its torque is on"):
        cold.configure(1, {Register.MAX_POSITION_LIMIT: 3000})
    assert cold.configure(1, {Register.PROFILE_VELOCITY: 100})


def test_register_reads_with_damaged_replies_are_repeated(rig: Make):
    made = rig(2, faults=FaultPlan((PlannedFault("corrupt", rate=0.3, start=0.2),), seed=3))
    cold = ServoAccess(made.wire)
    made.wire.sleep(0.3)
    for _ in range(30):
        assert cold.read(1, Register.MODEL_NUMBER) == 1020


def test_servo_id_shared_by_two_servos_is_detected_by_three_damaged_reads(servos: str):
    build, wire_of = BUILDERS[servos]
    faults = FaultPlan((PlannedFault("duplicate_id", servos=(2,)),))
    fitted = tuple(ServoFitting(id, model="xm430_w350") for id in (1, 2))
    _, buses = build([Cable("body", fitted, faults=faults)])
    wire, sent = wire_of(buses["body"]), list[bytes]()
    write = wire.write
    wire.write = lambda data: (sent.append(bytes(data)), write(data))[1]
    access = ServoAccess(wire, tries=1)
    assert not access.is_shared(1)
    assert len(sent) == 1
    assert access.is_shared(2)
    assert len(sent) == 1 + 3
