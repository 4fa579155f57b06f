"""Registers equal those of a plain table after any writes."""

from hypothesis import given
from hypothesis import strategies as st

from kinesic.hardware.protocol.models import SERVO_MODELS, Model
from kinesic.hardware.protocol.packet import Fault
from kinesic.hardware.protocol.registers import Mode, Register
from kinesic.hardware.virtual.control_table import MAX_MULTI_TURN, RefusalError
from kinesic.hardware.virtual.physics import Shaft
from kinesic.hardware.virtual.servo import VirtualServo

from ...examples import examples

# Registers that change only by writes and are defined by their range alone
PLAIN_REGISTERS = (
    Register.RETURN_DELAY_TIME,
    Register.MOVING_THRESHOLD,
    Register.TEMPERATURE_LIMIT,
    Register.PWM_LIMIT,
    Register.VELOCITY_LIMIT,
    Register.MIN_POSITION_LIMIT,
    Register.TORQUE_ENABLE,
    Register.STATUS_RETURN_LEVEL,
    Register.FEEDFORWARD_1ST_GAIN,
    Register.PROFILE_ACCELERATION,
    Register.PROFILE_VELOCITY,
    Register.GOAL_PWM,
    Register.GOAL_VELOCITY,
    Register.GOAL_POSITION,
)
# registers that no write may change
READ_ONLY_REGISTERS = (Register.MODEL_NUMBER, Register.FIRMWARE_VERSION, Register.HARDWARE_ERROR_STATUS)
# goal register -> register with its limit
LIMIT_REGISTERS = {Register.GOAL_PWM: Register.PWM_LIMIT, Register.GOAL_VELOCITY: Register.VELOCITY_LIMIT}

WRITE_STEPS = st.lists(
    st.tuples(st.sampled_from(PLAIN_REGISTERS + READ_ONLY_REGISTERS), st.integers(-5000, 5000) | st.integers(0, 5)),
    min_size=1,
    max_size=30,
)


class Table:
    """Reference model: the rules of the manual, one register at a time."""

    def __init__(self, model: Model, firmware: int, place: int) -> None:
        self.model = model
        self.values = {register: model.factory_value(register) for register in PLAIN_REGISTERS + READ_ONLY_REGISTERS}
        self.values[Register.FIRMWARE_VERSION] = firmware
        self.values[Register.GOAL_POSITION] = place

    def write(self, register: Register, value: int) -> Fault:
        fault = self.judge(register, value)
        if fault is Fault.NONE:
            self.values[register] = value
        return fault

    def judge(self, register: Register, value: int) -> Fault:
        if register in READ_ONLY_REGISTERS or (register.field.eeprom and self.values[Register.TORQUE_ENABLE]):
            return Fault.ACCESS
        if register is Register.GOAL_POSITION:
            least = self.values[Register.MIN_POSITION_LIMIT]
            return (
                Fault.NONE if least <= value <= self.model.factory_value(Register.MAX_POSITION_LIMIT) else Fault.LIMIT
            )
        if register in LIMIT_REGISTERS:
            return Fault.LIMIT if abs(value) > self.values[LIMIT_REGISTERS[register]] else Fault.NONE
        lower, upper = self.model.allowed_range(register)
        return Fault.NONE if lower <= value <= upper else Fault.RANGE


def written(servo: VirtualServo, register: Register, value: int) -> Fault:
    try:
        servo.write(register.field.address, register.field.pack(value))
    except RefusalError as refused:
        return refused.fault
    return Fault.NONE


def fits(register: Register, value: int) -> bool:
    bits = 8 * register.field.size
    return -(1 << bits - 1) <= value < 1 << bits - 1 if register.field.signed else 0 <= value < 1 << bits


@examples(100)
@given(st.sampled_from(sorted(name for name, model in SERVO_MODELS.items() if model.table is None)), WRITE_STEPS)
def test_servo_register_writes_and_reads_agree_with_a_reference_table(name: str, steps: list[tuple[Register, int]]):
    servo = VirtualServo(SERVO_MODELS[name])
    servo.electronics.place(Shaft(3.0), 0.0)
    table = Table(SERVO_MODELS[name], servo.memory.firmware, servo.electronics.present_position())
    for register, value in steps:
        if fits(register, value):
            assert written(servo, register, value) is table.write(register, value)
        for shown, expected in table.values.items():
            field = shown.field
            assert field.unpack(servo.read(field.address, field.size)) == expected


@examples(100)
@given(st.integers(0, 700), st.binary(max_size=40))
def test_no_write_crashes_a_servo_or_changes_read_only_registers(address: int, data: bytes):
    servo = VirtualServo(SERVO_MODELS["xm540_w270"])
    servo.electronics.place(Shaft(3.0), 0.0)
    for mode in Mode:
        written(servo, Register.OPERATING_MODE, mode.value)
        error, answer = servo.execute(3, address.to_bytes(2, "little") + data)
        assert answer == b""
        assert error in set(Fault)
        servo.electronics.demand(0.0)
        servo.electronics.show()
    assert servo.memory[Register.MODEL_NUMBER] == 1120
    assert abs(servo.memory[Register.GOAL_POSITION]) <= MAX_MULTI_TURN
    lower, upper = servo.memory.model.allowed_range(Register.PROFILE_VELOCITY)
    assert lower <= servo.memory[Register.PROFILE_VELOCITY] <= upper


@examples(100)
@given(st.integers(0, 300), st.binary(max_size=40), st.integers(0, 4))
def test_refused_write_changes_no_register(address: int, data: bytes, mode: int):
    servo = VirtualServo(SERVO_MODELS["xm540_w270"])
    servo.electronics.place(Shaft(3.0), 0.0)
    written(servo, Register.TORQUE_ENABLE, mode % 2)
    before = servo.read(0, 662)
    error, _ = servo.execute(3, address.to_bytes(2, "little") + data)
    if error:
        assert servo.read(0, 662) == before
