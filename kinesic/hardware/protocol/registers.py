"""The control table of the Dynamixel X series: what stands at which address (ROBOTIS e-Manual).

Below address 64 is EEPROM, writable only with torque off; from there on is RAM, which a reboot forgets. What differs
between models (figures, missing registers, indirect cells) is in `models`.
"""

from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from math import pi

from kinesic.body.servo import DUTY_FULL, TICKS_PER_TURN

RAM_START = 64
RPM = 2 * pi / 60
SPEED = 0.229 * RPM  # [rad/s] per count
PROFILE_ACCELERATION = 214.577 * RPM / 60  # [rad/s^2] per count
TICK = 2 * pi / TICKS_PER_TURN  # [rad]
DUTY = 1 / DUTY_FULL
WATCHDOG = 0.020  # [s] per count
WATCHDOG_TRIPPED = -1
CLOCK_WRAP = 32768  # [ms] the realtime tick starts again
LARGEST_OFFSET = 1_044_479
GAIN_MAX = 16_383
PROFILE_MAX = 32_767


@dataclass(frozen=True)
class Field:
    """One register. `initial`, `lower` and `upper` are raw counts, as in most models."""

    address: int
    size: int  # [bytes] 1, 2 or 4, little endian
    signed: bool = False
    writable: bool = True
    initial: int = 0
    lower: int = 0
    upper: int = 0  # writable ones only
    unit: str = ""
    scale: float = 1.0  # units per count
    firmware: int = 0  # the first that has it, in the larger families

    @cached_property
    def end(self) -> int:
        """The first address behind it."""
        return self.address + self.size

    @property
    def eeprom(self) -> bool:
        """Whether it outlives a reboot, and is locked while torque is on."""
        return self.address < RAM_START

    def pack(self, value: int) -> bytes:
        """Returns the bytes of a value.

        Raises:
            ValueError: it does not fit into the register's size.
        """
        try:
            return value.to_bytes(self.size, "little", signed=self.signed)
        except OverflowError:
            kind = "a signed" if self.signed else "an unsigned"
            message = f"{value} does not fit into {kind} register of {self.size} bytes at {self.address}"
            raise ValueError(message) from None

    def unpack(self, data: bytes) -> int:
        """Returns the value of `size` bytes.

        Raises:
            ValueError: there are more or fewer bytes.
        """
        if len(data) != self.size:
            raise ValueError(f"register at {self.address} has {self.size} bytes, not {len(data)}")
        return int.from_bytes(data, "little", signed=self.signed)


def _read_only(address: int, size: int, *, signed: bool = False, unit: str = "", scale: float = 1.0) -> Field:
    return Field(address, size, signed=signed, writable=False, unit=unit, scale=scale)


class Register(Enum):
    """Every register of the series but the indirect cells."""

    __hash__ = object.__hash__  # members are unique, and Enum's own hash is Python
    field: Field
    """Where it stands and what it holds."""

    def __init__(self, field: Field) -> None:
        self.field = field  # asked for at every access, where Enum's `value` is slow

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
    HOMING_OFFSET = Field(20, 4, signed=True, lower=-LARGEST_OFFSET, upper=LARGEST_OFFSET, unit="rad", scale=TICK)
    MOVING_THRESHOLD = Field(24, 4, initial=10, upper=1023, unit="rad/s", scale=SPEED)
    TEMPERATURE_LIMIT = Field(31, 1, initial=80, upper=100, unit="C")
    MAX_VOLTAGE_LIMIT = Field(32, 2, initial=160, lower=95, upper=160, unit="V", scale=0.1)
    MIN_VOLTAGE_LIMIT = Field(34, 2, initial=95, lower=95, upper=160, unit="V", scale=0.1)
    PWM_LIMIT = Field(36, 2, initial=885, upper=885, unit="duty", scale=DUTY)
    CURRENT_LIMIT = Field(38, 2, initial=2047, upper=2047, unit="A", scale=2.69e-3)
    VELOCITY_LIMIT = Field(44, 4, initial=128, upper=1023, unit="rad/s", scale=SPEED)
    MAX_POSITION_LIMIT = Field(48, 4, initial=4095, upper=4095, unit="rad", scale=TICK)
    MIN_POSITION_LIMIT = Field(52, 4, upper=4095, unit="rad", scale=TICK)
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
    VELOCITY_I_GAIN = Field(76, 2, initial=1920, upper=GAIN_MAX)
    VELOCITY_P_GAIN = Field(78, 2, initial=100, upper=GAIN_MAX)
    POSITION_D_GAIN = Field(80, 2, upper=GAIN_MAX)
    POSITION_I_GAIN = Field(82, 2, upper=GAIN_MAX)
    POSITION_P_GAIN = Field(84, 2, initial=800, upper=GAIN_MAX)
    FEEDFORWARD_2ND_GAIN = Field(88, 2, upper=GAIN_MAX)
    FEEDFORWARD_1ST_GAIN = Field(90, 2, upper=GAIN_MAX)
    BUS_WATCHDOG = Field(98, 1, signed=True, upper=127, unit="s", scale=WATCHDOG, firmware=38)
    GOAL_PWM = Field(100, 2, signed=True, initial=885, lower=-885, upper=885, unit="duty", scale=DUTY)
    GOAL_CURRENT = Field(102, 2, signed=True, initial=2047, lower=-2047, upper=2047, unit="A", scale=2.69e-3)
    GOAL_VELOCITY = Field(104, 4, signed=True, lower=-1023, upper=1023, unit="rad/s", scale=SPEED)
    PROFILE_ACCELERATION = Field(108, 4, upper=PROFILE_MAX, unit="rad/s^2", scale=PROFILE_ACCELERATION)
    PROFILE_VELOCITY = Field(112, 4, upper=PROFILE_MAX, unit="rad/s", scale=SPEED)
    GOAL_POSITION = Field(116, 4, signed=True, upper=4095, unit="rad", scale=TICK)
    REALTIME_TICK = _read_only(120, 2, unit="s", scale=1e-3)
    MOVING = _read_only(122, 1)
    MOVING_STATUS = _read_only(123, 1)
    PRESENT_PWM = _read_only(124, 2, signed=True, unit="duty", scale=DUTY)
    PRESENT_CURRENT = _read_only(126, 2, signed=True, unit="A", scale=2.69e-3)
    PRESENT_VELOCITY = _read_only(128, 4, signed=True, unit="rad/s", scale=SPEED)
    PRESENT_POSITION = _read_only(132, 4, signed=True, unit="rad", scale=TICK)
    VELOCITY_TRAJECTORY = _read_only(136, 4, signed=True, unit="rad/s", scale=SPEED)
    POSITION_TRAJECTORY = _read_only(140, 4, signed=True, unit="rad", scale=TICK)
    PRESENT_INPUT_VOLTAGE = _read_only(144, 2, unit="V", scale=0.1)
    PRESENT_TEMPERATURE = _read_only(146, 1, unit="C")
    BACKUP_READY = _read_only(147, 1)
    EXTERNAL_PORT_DATA_1 = Field(152, 2, upper=4095)
    EXTERNAL_PORT_DATA_2 = Field(154, 2, upper=4095)
    EXTERNAL_PORT_DATA_3 = Field(156, 2, upper=4095)


class HardwareError(Enum):
    """A bit of HARDWARE_ERROR_STATUS, and of SHUTDOWN, which says what takes the torque away until a reboot."""

    VOLTAGE = 0x01
    OVERHEATING = 0x04
    ENCODER = 0x08
    ELECTRICAL_SHOCK = 0x10
    OVERLOAD = 0x20

    @classmethod
    def names(cls, bits: int) -> tuple[str, ...]:
        """Names the bits of HARDWARE_ERROR_STATUS in words."""
        return tuple(bit.name.lower().replace("_", " ") for bit in cls if bit.value & bits)


class Mode(Enum):
    """OPERATING_MODE."""

    CURRENT = 0
    VELOCITY = 1
    POSITION = 3
    EXTENDED_POSITION = 4
    CURRENT_POSITION = 5
    PWM = 16


BAUD_RATES = (9_600, 57_600, 115_200, 1_000_000, 2_000_000, 3_000_000, 4_000_000, 4_500_000)
"""[bit/s] by the value of BAUD_RATE."""
