"""Control table of the Dynamixel X series (ROBOTIS e-Manual).

Addresses below 64 are EEPROM, writable only with torque off; the others are RAM, which a reboot resets. Differences
between models (values, missing registers, indirect cells) are in `models`.
"""

from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from math import pi

from kinesic.body.servo import FULL_DUTY_PWM, TICKS_PER_TURN

RAM_START = 64  # First address of the RAM area in the control table
RPM_TO_RADIANS = 2 * pi / 60  # [rad/s] angular velocity of 1 rev/min
VELOCITY_UNIT = 0.229 * RPM_TO_RADIANS  # [rad/s] velocity per count
PROFILE_ACCELERATION_UNIT = 214.577 * RPM_TO_RADIANS / 60  # [rad/s^2] acceleration per count
TICK_ANGLE = 2 * pi / TICKS_PER_TURN  # [rad] per tick of position
DUTY_UNIT = 1 / FULL_DUTY_PWM  # Duty per count of PWM
WATCHDOG_UNIT = 0.020  # [s] per count of the bus watchdog
WATCHDOG_TRIPPED = -1  # Value of BUS_WATCHDOG after it has stopped the servo
CLOCK_WRAP = 32768  # [ms] period after which a servo's REALTIME_TICK restarts at 0
MAX_OFFSET = 1_044_479  # [ticks] limit of HOMING_OFFSET
MAX_GAIN = 16_383  # [counts] largest value of the gain registers
MAX_PROFILE = 32_767  # [counts] largest value of the profile registers


@dataclass(frozen=True)
class Field:
    """Address, size, range and unit of a register.

    `initial`, `lower` and `upper` are raw counts, as in most models.
    """

    address: int
    size: int  # [bytes] 1, 2 or 4, little endian
    signed: bool = False
    writable: bool = True
    initial: int = 0
    lower: int = 0
    upper: int = 0  # largest writable value; 0 for read-only registers
    unit: str = ""
    scale: float = 1.0  # units per count
    firmware: int = 0  # first firmware version with this register, in the larger servo families

    @cached_property
    def end(self) -> int:
        """First address after the register."""
        return self.address + self.size

    @cached_property
    def eeprom(self) -> bool:
        """Whether the register is in EEPROM.

        Its value then survives a reboot and is locked while torque is on.
        """
        return self.address < RAM_START

    def pack(self, value: int) -> bytes:
        """Encode a value as the bytes of this register.

        Raises:
            ValueError: the value does not fit into the register.
        """
        try:
            return value.to_bytes(self.size, "little", signed=self.signed)
        except OverflowError:
            kind = "a signed" if self.signed else "an unsigned"
            message = f"{value} does not fit into {kind} register of {self.size} bytes at {self.address}"
            raise ValueError(message) from None

    def unpack(self, data: bytes) -> int:
        """Decode a register value from exactly `size` bytes.

        Raises:
            ValueError: the number of bytes differs.
        """
        if len(data) != self.size:
            raise ValueError(f"register at {self.address} has {self.size} bytes, not {len(data)}")
        return int.from_bytes(data, "little", signed=self.signed)


def _read_only(address: int, size: int, *, signed: bool = False, unit: str = "", scale: float = 1.0) -> Field:
    return Field(address, size, signed=signed, writable=False, unit=unit, scale=scale)


class Register(Enum):
    """Registers of the X series except the indirect cells."""

    __hash__ = object.__hash__  # members are unique, and Enum's own hash is slow Python
    field: Field
    """Address, size, range and unit of the register."""

    def __init__(self, field: Field) -> None:
        self.field = field  # read at every access, where Enum's `value` is slow

    MODEL_NUMBER = _read_only(0, 2)
    MODEL_INFORMATION = _read_only(2, 4)
    FIRMWARE_VERSION = _read_only(6, 1)
    ID = Field(7, 1, initial=1, upper=252)
    BAUD_RATE = Field(8, 1, initial=1, upper=7)
    RETURN_DELAY_TIME = Field(9, 1, initial=250, upper=254, unit="s", scale=2e-6)
    DRIVE_MODE = Field(10, 1, upper=13)
    OPERATING_MODE = Field(11, 1, initial=3, upper=16)
    SECONDARY_ID = Field(12, 1, initial=255, upper=255)
    PROTOCOL_TYPE = Field(13, 1, initial=2, lower=1, upper=2)
    HOMING_OFFSET = Field(20, 4, signed=True, lower=-MAX_OFFSET, upper=MAX_OFFSET, unit="rad", scale=TICK_ANGLE)
    MOVING_THRESHOLD = Field(24, 4, initial=10, upper=1023, unit="rad/s", scale=VELOCITY_UNIT)
    TEMPERATURE_LIMIT = Field(31, 1, initial=80, upper=100, unit="C")
    MAX_VOLTAGE_LIMIT = Field(32, 2, initial=160, lower=95, upper=160, unit="V", scale=0.1)
    MIN_VOLTAGE_LIMIT = Field(34, 2, initial=95, lower=95, upper=160, unit="V", scale=0.1)
    PWM_LIMIT = Field(36, 2, initial=885, upper=885, unit="duty", scale=DUTY_UNIT)
    CURRENT_LIMIT = Field(38, 2, initial=2047, upper=2047, unit="A", scale=2.69e-3)
    VELOCITY_LIMIT = Field(44, 4, initial=128, upper=1023, unit="rad/s", scale=VELOCITY_UNIT)
    MAX_POSITION_LIMIT = Field(48, 4, initial=4095, upper=4095, unit="rad", scale=TICK_ANGLE)
    MIN_POSITION_LIMIT = Field(52, 4, upper=4095, unit="rad", scale=TICK_ANGLE)
    EXTERNAL_PORT_MODE_1 = Field(56, 1, initial=3, upper=3)
    EXTERNAL_PORT_MODE_2 = Field(57, 1, initial=3, upper=3)
    EXTERNAL_PORT_MODE_3 = Field(58, 1, initial=3, upper=3)
    STARTUP_CONFIGURATION = Field(60, 1, upper=3, firmware=45)
    PWM_SLOPE = Field(62, 1, initial=140, lower=1, upper=255)
    SHUTDOWN = Field(63, 1, initial=52, upper=63)

    TORQUE_ENABLE = Field(64, 1, upper=1)
    LED = Field(65, 1, upper=1)
    STATUS_RETURN_LEVEL = Field(68, 1, initial=2, upper=2)
    REGISTERED_INSTRUCTION = _read_only(69, 1)
    HARDWARE_ERROR_STATUS = _read_only(70, 1)
    VELOCITY_I_GAIN = Field(76, 2, initial=1920, upper=MAX_GAIN)
    VELOCITY_P_GAIN = Field(78, 2, initial=100, upper=MAX_GAIN)
    POSITION_D_GAIN = Field(80, 2, upper=MAX_GAIN)
    POSITION_I_GAIN = Field(82, 2, upper=MAX_GAIN)
    POSITION_P_GAIN = Field(84, 2, initial=800, upper=MAX_GAIN)
    FEEDFORWARD_2ND_GAIN = Field(88, 2, upper=MAX_GAIN)
    FEEDFORWARD_1ST_GAIN = Field(90, 2, upper=MAX_GAIN)
    BUS_WATCHDOG = Field(98, 1, signed=True, upper=127, unit="s", scale=WATCHDOG_UNIT, firmware=38)
    GOAL_PWM = Field(100, 2, signed=True, initial=885, lower=-885, upper=885, unit="duty", scale=DUTY_UNIT)
    GOAL_CURRENT = Field(102, 2, signed=True, initial=2047, lower=-2047, upper=2047, unit="A", scale=2.69e-3)
    GOAL_VELOCITY = Field(104, 4, signed=True, lower=-1023, upper=1023, unit="rad/s", scale=VELOCITY_UNIT)
    PROFILE_ACCELERATION = Field(108, 4, upper=MAX_PROFILE, unit="rad/s^2", scale=PROFILE_ACCELERATION_UNIT)
    PROFILE_VELOCITY = Field(112, 4, upper=MAX_PROFILE, unit="rad/s", scale=VELOCITY_UNIT)
    GOAL_POSITION = Field(116, 4, signed=True, upper=4095, unit="rad", scale=TICK_ANGLE)
    REALTIME_TICK = _read_only(120, 2, unit="s", scale=1e-3)
    MOVING = _read_only(122, 1)
    MOVING_STATUS = _read_only(123, 1)
    PRESENT_PWM = _read_only(124, 2, signed=True, unit="duty", scale=DUTY_UNIT)
    PRESENT_CURRENT = _read_only(126, 2, signed=True, unit="A", scale=2.69e-3)
    PRESENT_VELOCITY = _read_only(128, 4, signed=True, unit="rad/s", scale=VELOCITY_UNIT)
    PRESENT_POSITION = _read_only(132, 4, signed=True, unit="rad", scale=TICK_ANGLE)
    VELOCITY_TRAJECTORY = _read_only(136, 4, signed=True, unit="rad/s", scale=VELOCITY_UNIT)
    POSITION_TRAJECTORY = _read_only(140, 4, signed=True, unit="rad", scale=TICK_ANGLE)
    PRESENT_INPUT_VOLTAGE = _read_only(144, 2, unit="V", scale=0.1)
    PRESENT_TEMPERATURE = _read_only(146, 1, unit="C")
    BACKUP_READY = _read_only(147, 1)
    EXTERNAL_PORT_DATA_1 = Field(152, 2, upper=4095)
    EXTERNAL_PORT_DATA_2 = Field(154, 2, upper=4095)
    EXTERNAL_PORT_DATA_3 = Field(156, 2, upper=4095)


class HardwareError(Enum):
    """Bit of HARDWARE_ERROR_STATUS and of SHUTDOWN.

    An error whose bit is set in SHUTDOWN switches torque off until a reboot.
    """

    VOLTAGE = 0x01
    OVERHEATING = 0x04
    ENCODER = 0x08
    ELECTRICAL_SHOCK = 0x10
    OVERLOAD = 0x20

    @classmethod
    def names(cls, bits: int) -> tuple[str, ...]:
        """Return the names of the errors whose bits are set."""
        return tuple(bit.name.lower().replace("_", " ") for bit in cls if bit.value & bits)


class Mode(Enum):
    """Values of OPERATING_MODE."""

    CURRENT = 0
    VELOCITY = 1
    POSITION = 3
    EXTENDED_POSITION = 4
    CURRENT_POSITION = 5
    PWM = 16


BAUD_RATES = (9_600, 57_600, 115_200, 1_000_000, 2_000_000, 3_000_000, 4_000_000, 4_500_000)
"""Baud rates [bit/s], indexed by the value of BAUD_RATE."""
