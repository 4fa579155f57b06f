"""Control tables of servo families with Protocol 1.0 frames.

The rest of the package speaks of the registers of the X series, in their units and with 4096 ticks per turn. A table
says at which address another family keeps such a register, and how its numbers convert. Sources: Feetech memory tables
of the STS, SMS and SCS series; ROBOTIS e-Manual of AX-12 and MX-28, Protocol 1.0.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Literal

from kinesic.body.servo import FULL_DUTY_PWM, TICKS_PER_TURN
from kinesic.hardware.protocol.registers import HardwareError, Register

TableName = Literal["sts", "scs", "ax", "mx"]

STS_VELOCITY_UNIT = 60 / TICKS_PER_TURN / 0.229  # counts of the X series per step/s
STS_ACCELERATION_UNIT = 100 * 3600 / TICKS_PER_TURN / 214.577  # counts of the X series per 100 steps/s^2
NARROW_TICK = 300 / 1023 * TICKS_PER_TURN / 360  # [ticks] per count of a servo with 1023 counts in 300 degrees
NARROW_MID = 512  # [counts] middle of the range of a servo with 1023 counts
NARROW_OFFSET = TICKS_PER_TURN / 2 - NARROW_MID * NARROW_TICK  # [ticks] value of count 0, if the middle is half a turn
AX_VELOCITY_UNIT = 0.111 / 0.229  # counts of the X series per count of an AX
MX_VELOCITY_UNIT = 0.114 / 0.229  # counts of the X series per count of an MX
LOAD_UNIT = 1000 / 1023  # [0.1 %] load per count


@dataclass(frozen=True, eq=False)
class NativeField:
    """Place and number format of a register in another family.

    The value of the X series is `scale` times the native value plus `zero`, or is listed in `codes` or `bits`.
    """

    address: int
    size: int = 1  # [bytes] 1 or 2
    scale: float = 1.0  # counts of the X series per native count
    zero: float = 0.0  # value of the X series at the native value 0
    sign_bit: int | None = None  # bit of the sign; the other bits are the magnitude
    codes: Mapping[int, int] = field(default_factory=dict)  # value of the X series -> native value
    bits: Mapping[int, int] = field(default_factory=dict)  # bit of the X series -> native bit

    @property
    def end(self) -> int:
        """First address after the register."""
        return self.address + self.size

    def to_native(self, value: int) -> int:
        """Convert a value of the X series to the nearest native value."""
        if self.codes:
            return self.codes.get(value, value)
        if self.bits:
            return sum(native for bit, native in self.bits.items() if bit & value)
        native = round((value - self.zero) / self.scale)
        largest = (1 << (8 * self.size if self.sign_bit is None else self.sign_bit)) - 1
        return max(0 if self.sign_bit is None else -largest, min(native, largest))

    def from_native(self, native: int) -> int:
        """Convert a native value to the value of the X series."""
        if self.codes:
            return next((value for value, code in self.codes.items() if code == native), native)
        if self.bits:
            return sum(bit for bit, other in self.bits.items() if other & native)
        return round(self.scale * native + self.zero)

    def pack(self, value: int, *, order: Literal["little", "big"]) -> bytes:
        """Encode a value of the X series as bytes of this register."""
        native = self.to_native(value)
        if self.sign_bit is not None and native < 0:
            native = -native | 1 << self.sign_bit
        return native.to_bytes(self.size, order)

    def unpack(self, data: bytes, *, order: Literal["little", "big"]) -> int:
        """Decode the bytes of this register to an X series value."""
        native = int.from_bytes(data, order)
        if self.sign_bit is not None and native >> self.sign_bit & 1:
            native = -(native & (1 << self.sign_bit) - 1)
        elif self.sign_bit is not None:
            native &= (1 << self.sign_bit) - 1
        return self.from_native(native)


@dataclass(frozen=True, eq=False)
class FamilyTable:
    """Control table of one servo family, with the abilities of its protocol."""

    name: TableName
    maker: Literal["Feetech", "Dynamixel"]
    fields: Mapping[Register, NativeField]
    bauds: Mapping[int, int]  # native code of the baud rate -> [bit/s]
    errors: Mapping[int, int]  # bit of the error byte -> bit of HARDWARE_ERROR_STATUS
    ram_start: int  # first address that a power failure resets
    sensors: tuple[int, int]  # first address of the sensor registers, and first address after them
    collective: Literal["sync", "bulk", "none"]  # frame that reads several servos; none: each servo needs its own
    order: Literal["little", "big"] = "little"  # byte order of two-byte registers
    lock: int | None = None  # address of the EEPROM lock; 0 in it lets writes persist
    turn: int = TICKS_PER_TURN  # [ticks] range of positions

    def has(self, register: Register) -> bool:
        """Return whether the family has a register."""
        return register in self.fields

    def pack(self, register: Register, value: int) -> bytes:
        """Encode an X series value for a register of this family."""
        return self.fields[register].pack(value, order=self.order)

    def unpack(self, register: Register, data: bytes) -> int:
        """Decode a register of this family to an X series value."""
        return self.fields[register].unpack(data, order=self.order)

    def quantise(self, register: Register, value: int) -> int:
        """Return the value that a register has after a write."""
        return self.unpack(register, self.pack(register, value))

    def hardware_errors(self, error: int) -> int:
        """Convert an error byte to bits of HARDWARE_ERROR_STATUS."""
        return sum(bit for native, bit in self.errors.items() if native & error)

    def error_byte(self, bits: int) -> int:
        """Convert bits of HARDWARE_ERROR_STATUS to an error byte."""
        return sum(native for native, bit in self.errors.items() if bit & bits)

    def baud_code(self, baud: int) -> int | None:
        """Return the native code of a baud rate [bit/s], or None."""
        return next((code for code, rate in self.bauds.items() if rate == baud), None)

    @cached_property
    def record_span(self) -> tuple[int, int]:
        """First address and size of torque switch and sensors together."""
        start = min(self.fields[Register.TORQUE_ENABLE].address, self.sensors[0])
        return start, self.sensors[1] - start

    @cached_property
    def sensor_span(self) -> tuple[int, int]:
        """First address and size of the sensor registers."""
        return self.sensors[0], self.sensors[1] - self.sensors[0]


_VOLTAGE_BIT = HardwareError.VOLTAGE.value
_HEAT_BIT = HardwareError.OVERHEATING.value
_ENCODER_BIT = HardwareError.ENCODER.value
_SHOCK_BIT = HardwareError.ELECTRICAL_SHOCK.value
_OVERLOAD_BIT = HardwareError.OVERLOAD.value
_FEETECH_ERRORS = {0x01: _VOLTAGE_BIT, 0x02: _ENCODER_BIT, 0x04: _HEAT_BIT, 0x08: _SHOCK_BIT, 0x20: _OVERLOAD_BIT}
_FEETECH_BITS = {bit: native for native, bit in _FEETECH_ERRORS.items()}
_PROTOCOL1_ERRORS = {0x01: _VOLTAGE_BIT, 0x04: _HEAT_BIT, 0x20: _OVERLOAD_BIT}
_PROTOCOL1_BITS = {bit: native for native, bit in _PROTOCOL1_ERRORS.items()}
# Sources disagree below 115200 baud, so those codes are left out
_FEETECH_BAUDS = {0: 1_000_000, 1: 500_000, 2: 250_000, 3: 128_000, 4: 115_200}
_PROTOCOL1_BAUDS = {1: 1_000_000, 3: 500_000, 7: 250_000, 16: 115_200, 34: 57_600, 103: 19_200, 207: 9_600}

_FEETECH_COMMON = {
    Register.FIRMWARE_VERSION: NativeField(0),
    Register.MODEL_NUMBER: NativeField(3, 2),
    Register.ID: NativeField(5),
    Register.BAUD_RATE: NativeField(6),
    Register.RETURN_DELAY_TIME: NativeField(7),
    Register.STATUS_RETURN_LEVEL: NativeField(8, codes={0: 0, 1: 0, 2: 1}),
    Register.TEMPERATURE_LIMIT: NativeField(13),
    Register.MAX_VOLTAGE_LIMIT: NativeField(14),
    Register.MIN_VOLTAGE_LIMIT: NativeField(15),
    Register.PWM_LIMIT: NativeField(16, 2, scale=FULL_DUTY_PWM / 1000),
    Register.SHUTDOWN: NativeField(19, bits=_FEETECH_BITS),
    Register.POSITION_P_GAIN: NativeField(21),
    Register.POSITION_D_GAIN: NativeField(22),
    Register.POSITION_I_GAIN: NativeField(23),
    Register.TORQUE_ENABLE: NativeField(40),
    Register.PRESENT_INPUT_VOLTAGE: NativeField(62),
    Register.PRESENT_TEMPERATURE: NativeField(63),
    Register.HARDWARE_ERROR_STATUS: NativeField(65, bits=_FEETECH_BITS),
    Register.MOVING: NativeField(66),
}

STS_TABLE = FamilyTable(
    name="sts",
    maker="Feetech",
    fields=MappingProxyType(
        _FEETECH_COMMON
        | {
            Register.MIN_POSITION_LIMIT: NativeField(9, 2),
            Register.MAX_POSITION_LIMIT: NativeField(11, 2),
            Register.CURRENT_LIMIT: NativeField(28, 2),
            Register.HOMING_OFFSET: NativeField(31, 2, scale=-1.0, sign_bit=11),
            Register.OPERATING_MODE: NativeField(33, codes={3: 0, 1: 1, 16: 2, 4: 3}),
            Register.PROFILE_ACCELERATION: NativeField(41, scale=STS_ACCELERATION_UNIT),
            Register.GOAL_POSITION: NativeField(42, 2, sign_bit=15),
            Register.PROFILE_VELOCITY: NativeField(46, 2, scale=STS_VELOCITY_UNIT, sign_bit=15),
            Register.GOAL_PWM: NativeField(48, 2, scale=FULL_DUTY_PWM / 1000),
            Register.PRESENT_POSITION: NativeField(56, 2, sign_bit=15),
            Register.PRESENT_VELOCITY: NativeField(58, 2, scale=STS_VELOCITY_UNIT, sign_bit=15),
            Register.PRESENT_CURRENT: NativeField(69, 2, sign_bit=15),
        }
    ),
    bauds=MappingProxyType(_FEETECH_BAUDS),
    errors=MappingProxyType(_FEETECH_ERRORS),
    ram_start=40,
    sensors=(56, 71),
    collective="sync",
    lock=55,
)

SCS_TABLE = FamilyTable(
    name="scs",
    maker="Feetech",
    fields=MappingProxyType(
        _FEETECH_COMMON
        | {
            Register.MIN_POSITION_LIMIT: NativeField(9, 2, scale=NARROW_TICK, zero=NARROW_OFFSET),
            Register.MAX_POSITION_LIMIT: NativeField(11, 2, scale=NARROW_TICK, zero=NARROW_OFFSET),
            Register.GOAL_POSITION: NativeField(42, 2, scale=NARROW_TICK, zero=NARROW_OFFSET),
            Register.PROFILE_VELOCITY: NativeField(46, 2, scale=NARROW_TICK * STS_VELOCITY_UNIT),
            Register.PRESENT_POSITION: NativeField(56, 2, scale=NARROW_TICK, zero=NARROW_OFFSET),
            Register.PRESENT_VELOCITY: NativeField(58, 2, scale=NARROW_TICK * STS_VELOCITY_UNIT, sign_bit=15),
            Register.PRESENT_CURRENT: NativeField(60, 2, sign_bit=10),
        }
    ),
    bauds=MappingProxyType(_FEETECH_BAUDS),
    errors=MappingProxyType(_FEETECH_ERRORS),
    ram_start=40,
    sensors=(56, 67),
    collective="none",
    order="big",
    lock=48,
    turn=round(1023 * NARROW_TICK),
)

_PROTOCOL1_COMMON = {
    Register.MODEL_NUMBER: NativeField(0, 2),
    Register.FIRMWARE_VERSION: NativeField(2),
    Register.ID: NativeField(3),
    Register.BAUD_RATE: NativeField(4),
    Register.RETURN_DELAY_TIME: NativeField(5),
    Register.TEMPERATURE_LIMIT: NativeField(11),
    Register.MIN_VOLTAGE_LIMIT: NativeField(12),
    Register.MAX_VOLTAGE_LIMIT: NativeField(13),
    Register.PWM_LIMIT: NativeField(14, 2, scale=FULL_DUTY_PWM / 1023),
    Register.STATUS_RETURN_LEVEL: NativeField(16),
    Register.SHUTDOWN: NativeField(18, bits=_PROTOCOL1_BITS),
    Register.TORQUE_ENABLE: NativeField(24),
    Register.LED: NativeField(25),
    Register.GOAL_PWM: NativeField(34, 2, scale=FULL_DUTY_PWM / 1023),
    Register.PRESENT_CURRENT: NativeField(40, 2, scale=LOAD_UNIT, sign_bit=10),
    Register.PRESENT_INPUT_VOLTAGE: NativeField(42),
    Register.PRESENT_TEMPERATURE: NativeField(43),
    Register.REGISTERED_INSTRUCTION: NativeField(44),
    Register.MOVING: NativeField(46),
}

AX_TABLE = FamilyTable(
    name="ax",
    maker="Dynamixel",
    fields=MappingProxyType(
        _PROTOCOL1_COMMON
        | {
            Register.MIN_POSITION_LIMIT: NativeField(6, 2, scale=NARROW_TICK, zero=NARROW_OFFSET),
            Register.MAX_POSITION_LIMIT: NativeField(8, 2, scale=NARROW_TICK, zero=NARROW_OFFSET),
            Register.GOAL_POSITION: NativeField(30, 2, scale=NARROW_TICK, zero=NARROW_OFFSET),
            Register.PROFILE_VELOCITY: NativeField(32, 2, scale=AX_VELOCITY_UNIT),
            Register.PRESENT_POSITION: NativeField(36, 2, scale=NARROW_TICK, zero=NARROW_OFFSET),
            Register.PRESENT_VELOCITY: NativeField(38, 2, scale=AX_VELOCITY_UNIT, sign_bit=10),
        }
    ),
    bauds=MappingProxyType(_PROTOCOL1_BAUDS),
    errors=MappingProxyType(_PROTOCOL1_ERRORS),
    ram_start=24,
    sensors=(36, 44),
    collective="none",
    turn=round(1023 * NARROW_TICK),
)

MX_TABLE = FamilyTable(
    name="mx",
    maker="Dynamixel",
    fields=MappingProxyType(
        _PROTOCOL1_COMMON
        | {
            Register.MIN_POSITION_LIMIT: NativeField(6, 2),
            Register.MAX_POSITION_LIMIT: NativeField(8, 2),
            Register.POSITION_D_GAIN: NativeField(26),
            Register.POSITION_I_GAIN: NativeField(27),
            Register.POSITION_P_GAIN: NativeField(28),
            Register.GOAL_POSITION: NativeField(30, 2),
            Register.PROFILE_VELOCITY: NativeField(32, 2, scale=MX_VELOCITY_UNIT),
            Register.PRESENT_POSITION: NativeField(36, 2),
            Register.PRESENT_VELOCITY: NativeField(38, 2, scale=MX_VELOCITY_UNIT, sign_bit=10),
            Register.PROFILE_ACCELERATION: NativeField(73, scale=8.583 * 3600 / 360 / 214.577),
        }
    ),
    bauds=MappingProxyType(_PROTOCOL1_BAUDS),
    errors=MappingProxyType(_PROTOCOL1_ERRORS),
    ram_start=24,
    sensors=(36, 44),
    collective="bulk",
)

FAMILY_TABLES: Mapping[str, FamilyTable] = MappingProxyType(
    {table.name: table for table in (STS_TABLE, SCS_TABLE, AX_TABLE, MX_TABLE)}
)
