"""Any sequence of writes and reads leaves a servo's registers as a plain table of values says."""

from hypothesis import given
from hypothesis import strategies as st

from kinesic.hardware.protocol.models import MODELS, Model
from kinesic.hardware.protocol.packet import Fault
from kinesic.hardware.protocol.registers import Mode, Register
from kinesic.hardware.virtual.control_table import TURNS_MAX, RefusalError
from kinesic.hardware.virtual.physics import Shaft
from kinesic.hardware.virtual.servo import VirtualServo

from ...examples import examples

# Registers whose value changes only when they are written, and whose range is all there is to know about them.
PLAIN = (
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
READ_ONLY = (Register.MODEL_NUMBER, Register.FIRMWARE_VERSION, Register.HARDWARE_ERROR_STATUS)
LIMITS = {Register.GOAL_PWM: Register.PWM_LIMIT, Register.GOAL_VELOCITY: Register.VELOCITY_LIMIT}

STEPS = st.lists(
    st.tuples(st.sampled_from(PLAIN + READ_ONLY), st.integers(-5000, 5000) | st.integers(0, 5)), min_size=1, max_size=30
)


class Table:
    """What the manual says, for one register at a time."""

    def __init__(self, model: Model, firmware: int, place: int) -> None:
        self.model = model
        self.values = {register: model.starts(register) for register in PLAIN + READ_ONLY}
        self.values[Register.FIRMWARE_VERSION] = firmware
        self.values[Register.GOAL_POSITION] = place

    def write(self, register: Register, value: int) -> Fault:
        fault = self.judge(register, value)
        if fault is Fault.NONE:
            self.values[register] = value
        return fault

    def judge(self, register: Register, value: int) -> Fault:
        if register in READ_ONLY or (register.field.eeprom and self.values[Register.TORQUE_ENABLE]):
            return Fault.ACCESS
        if register is Register.GOAL_POSITION:
            least = self.values[Register.MIN_POSITION_LIMIT]
            return Fault.NONE if least <= value <= self.model.starts(Register.MAX_POSITION_LIMIT) else Fault.LIMIT
        if register in LIMITS:
            return Fault.LIMIT if abs(value) > self.values[LIMITS[register]] else Fault.NONE
        lower, upper = self.model.range(register)
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
@given(st.sampled_from(sorted(MODELS)), STEPS)
def test_any_sequence_of_writes_and_reads(name: str, steps: list[tuple[Register, int]]):
    servo = VirtualServo(MODELS[name])
    servo.electronics.place(Shaft(3.0), 0.0)
    table = Table(MODELS[name], servo.memory.firmware, servo.electronics.here())
    for register, value in steps:
        if fits(register, value):
            assert written(servo, register, value) is table.write(register, value)
        for shown, expected in table.values.items():
            field = shown.field
            assert field.unpack(servo.read(field.address, field.size)) == expected


@examples(100)
@given(st.integers(0, 700), st.binary(max_size=40))
def test_no_write_whatever_breaks_a_servo_or_changes_what_is_read_only(address: int, data: bytes):
    servo = VirtualServo(MODELS["xm540_w270"])
    servo.electronics.place(Shaft(3.0), 0.0)
    for mode in Mode:
        written(servo, Register.OPERATING_MODE, mode.value)
        error, answer = servo.execute(3, address.to_bytes(2, "little") + data)
        assert answer == b""
        assert error in set(Fault)
        servo.electronics.demand(0.0)
        servo.electronics.show()
    assert servo.memory[Register.MODEL_NUMBER] == 1120
    assert abs(servo.memory[Register.GOAL_POSITION]) <= TURNS_MAX
    lower, upper = servo.memory.model.range(Register.PROFILE_VELOCITY)
    assert lower <= servo.memory[Register.PROFILE_VELOCITY] <= upper


@examples(100)
@given(st.integers(0, 300), st.binary(max_size=40), st.integers(0, 4))
def test_a_refused_write_changes_nothing(address: int, data: bytes, mode: int):
    servo = VirtualServo(MODELS["xm540_w270"])
    servo.electronics.place(Shaft(3.0), 0.0)
    written(servo, Register.TORQUE_ENABLE, mode % 2)
    before = servo.read(0, 662)
    error, _ = servo.execute(3, address.to_bytes(2, "little") + data)
    if error:
        assert servo.read(0, 662) == before
