"""Factory settings of servos with Protocol 1.0 frames.

The families are Feetech STS, SMS and SCS, and Dynamixel AX and MX. Values are those of the X series' registers, which
`tables` converts. Sources: Feetech memory tables, ROBOTIS e-Manual. Mechanical data are in `configs/servos.toml` under
the same names.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from kinesic.body.servo import FULL_DUTY_PWM, TICKS_PER_TURN
from kinesic.hardware.protocol.registers import RPM_TO_RADIANS, VELOCITY_UNIT, Register
from kinesic.hardware.protocol.tables import (
    AX_TABLE,
    MX_TABLE,
    SCS_TABLE,
    STS_TABLE,
    FamilyTable,
)

STS_CURRENT_UNIT = 6.5e-3  # [A] per count of current of the STS and SMS series
FEETECH_SHUTDOWN = 0x3C  # Mask of errors that switch torque off: overheating, encoder, current, overload
PROTOCOL1_SHUTDOWN = 0x24  # Mask of errors that switch torque off: overheating, overload
SPEED_MARGIN = 1.2  # velocity limit / no-load velocity, for servos without a register for it


@dataclass(frozen=True)
class NativeSheet:
    """Factory settings of one servo model."""

    name: str  # as in `configs/servos.toml`
    number: int  # model number
    table: FamilyTable
    volts: tuple[int, int]  # [0.1 V] lower and upper limit of the supply voltage
    rpm: float  # [rev/min] no-load velocity
    gains: tuple[int, int, int]  # P, I and D gain of the position loop; zeros without such registers
    hottest: int  # [C] temperature limit
    max_current: int | None = None  # [counts] current limit; None: no current sensor
    return_delay: int = 250  # [counts of 2 us] delay of replies

    @property
    def amperes(self) -> float | None:
        """Current per count [A], or None without a current sensor.

        Without a sensor, the servo reports its load in 0.1 % per count.
        """
        return None if self.max_current is None else STS_CURRENT_UNIT

    @property
    def position_range(self) -> tuple[int, int]:
        """Smallest and largest position [ticks]."""
        lower = max(0, self.table.quantise(Register.GOAL_POSITION, -TICKS_PER_TURN))
        return lower, min(TICKS_PER_TURN - 1, lower + self.table.turn)

    @property
    def initial(self) -> Mapping[Register, int]:
        """Factory values of the registers."""
        lower, upper = self.position_range
        values = {
            Register.MODEL_NUMBER: self.number,
            Register.RETURN_DELAY_TIME: self.return_delay,
            Register.MAX_VOLTAGE_LIMIT: self.volts[1],
            Register.MIN_VOLTAGE_LIMIT: self.volts[0],
            Register.TEMPERATURE_LIMIT: self.hottest,
            Register.VELOCITY_LIMIT: round(SPEED_MARGIN * self.rpm * RPM_TO_RADIANS / VELOCITY_UNIT),
            Register.GOAL_POSITION: TICKS_PER_TURN // 2,
            Register.MIN_POSITION_LIMIT: lower,
            Register.MAX_POSITION_LIMIT: upper,
            Register.SHUTDOWN: FEETECH_SHUTDOWN if self.table.maker == "Feetech" else PROTOCOL1_SHUTDOWN,
            Register.POSITION_P_GAIN: self.gains[0],
            Register.POSITION_I_GAIN: self.gains[1],
            Register.POSITION_D_GAIN: self.gains[2],
            Register.PWM_LIMIT: FULL_DUTY_PWM,
            Register.SECONDARY_ID: 255,
            Register.PWM_SLOPE: 255,
        }
        if self.max_current is not None:
            values |= {Register.CURRENT_LIMIT: self.max_current, Register.GOAL_CURRENT: self.max_current}
        return MappingProxyType(values)

    @property
    def ranges(self) -> Mapping[Register, tuple[int, int]]:
        """Writable ranges of the registers that differ from the X series."""
        return MappingProxyType(
            {
                Register.MAX_VOLTAGE_LIMIT: self.volts,
                Register.MIN_VOLTAGE_LIMIT: self.volts,
                Register.BAUD_RATE: (0, max(self.table.bauds)),
                Register.GOAL_POSITION: self.position_range,
            }
        )


NATIVE_SHEETS = (
    NativeSheet("sts3215_12v", 777, STS_TABLE, (40, 140), 45, (32, 0, 32), hottest=70, max_current=500),
    NativeSheet("sts3215", 777, STS_TABLE, (40, 80), 55.4, (32, 0, 32), hottest=70, max_current=500),
    NativeSheet("sts3250", 2825, STS_TABLE, (60, 140), 75, (32, 0, 32), hottest=70, max_current=800),
    NativeSheet("sm8512bl", 11272, STS_TABLE, (90, 260), 45, (32, 0, 32), hottest=70, max_current=1600),
    NativeSheet("scs0009", 1284, SCS_TABLE, (40, 75), 111, (15, 0, 0), hottest=80),
    NativeSheet("ax12", 12, AX_TABLE, (60, 140), 59, (0, 0, 0), hottest=70),
    NativeSheet("ax18", 18, AX_TABLE, (60, 140), 97, (0, 0, 0), hottest=75),
    NativeSheet("mx28", 29, MX_TABLE, (60, 160), 55, (32, 0, 0), hottest=80),
    NativeSheet("mx64", 310, MX_TABLE, (60, 160), 63, (32, 0, 0), hottest=80),
    NativeSheet("mx106", 320, MX_TABLE, (60, 160), 45, (32, 0, 0), hottest=80),
)
