"""Factory settings of the X series, from the ROBOTIS e-Manual.

Values are raw counts. Mechanical data (torque, velocity, mass) are in `configs/servos.toml` under the same names.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from kinesic.hardware.protocol.registers import Register

Family = Literal["330", "430", "540"]

# Registers of external ports, which only some models have
_PORT_REGISTERS = tuple(register for register in Register if register.name.startswith("EXTERNAL_PORT"))
_CURRENT_REGISTERS = (Register.CURRENT_LIMIT, Register.GOAL_CURRENT)  # missing without a current sensor


@dataclass(frozen=True)
class FactorySheet:
    """Factory settings of a servo model, in raw counts.

    It is a row of the manual's table.
    """

    name: str  # as in `configs/servos.toml`
    number: int  # model number, as in register MODEL_NUMBER
    volts: tuple[int, int]  # [0.1 V] lower and upper limit of the supply voltage
    amperes: int | None  # current limit; None: no current sensor
    speed: int  # [counts] velocity limit
    gains: tuple[int, int, int]  # P, I and D gain of the position loop
    inner: tuple[int, int] = (1920, 100)  # I and P gain of the velocity loop
    hottest: int = 80  # [C] temperature limit
    lowest: int | None = None  # [0.1 V] smallest allowed voltage limit, if it differs from the factory limit
    shutdown: int = 52  # bit mask of the errors that switch torque off
    threshold: int = 10  # [counts] velocity from which the servo reports motion
    ports: bool = False  # whether the model has external ports
    light: bool = True  # whether the model has an LED

    @property
    def family(self) -> Family:
        """Servo series that determines the control table: 330, 430 or 540."""
        return "330" if "330" in self.name else "540" if "540" in self.name else "430"

    @property
    def initial(self) -> Mapping[Register, int]:
        """Factory values of the registers that vary between models."""
        currents = {} if self.amperes is None else dict.fromkeys(_CURRENT_REGISTERS, self.amperes)
        return MappingProxyType(
            {
                Register.MODEL_NUMBER: self.number,
                Register.MAX_VOLTAGE_LIMIT: self.volts[1],
                Register.MIN_VOLTAGE_LIMIT: self.volts[0],
                Register.TEMPERATURE_LIMIT: self.hottest,
                Register.MOVING_THRESHOLD: self.threshold,
                Register.VELOCITY_LIMIT: self.speed,
                Register.SHUTDOWN: self.shutdown,
                Register.VELOCITY_I_GAIN: self.inner[0],
                Register.VELOCITY_P_GAIN: self.inner[1],
                Register.POSITION_P_GAIN: self.gains[0],
                Register.POSITION_I_GAIN: self.gains[1],
                Register.POSITION_D_GAIN: self.gains[2],
                Register.PWM_SLOPE: 140 if self.volts[1] == 70 else 255,
                **currents,
            }
        )

    @property
    def ranges(self) -> Mapping[Register, tuple[int, int]]:
        """Writable ranges of the registers that vary between models."""
        is_small, max_current = self.family == "330", self.amperes
        span = (self.volts[0] if self.lowest is None else self.lowest, self.volts[1])
        currents = (
            {}
            if max_current is None
            else {Register.CURRENT_LIMIT: (0, max_current), Register.GOAL_CURRENT: (-max_current, max_current)}
        )
        return MappingProxyType(
            {
                Register.MAX_VOLTAGE_LIMIT: span,
                Register.MIN_VOLTAGE_LIMIT: span,
                Register.VELOCITY_LIMIT: (0, 2047 if is_small else 1023),
                Register.GOAL_VELOCITY: (-2047, 2047) if is_small else (-1023, 1023),
                Register.BAUD_RATE: (0, 6 if is_small else 7),
                Register.PROTOCOL_TYPE: (2, 22) if is_small else (1, 2),
                Register.DRIVE_MODE: (0, 15 if self.family == "540" else 13),
                **currents,
            }
        )

    @property
    def missing(self) -> frozenset[Register]:
        """Registers that the model lacks."""
        absent = set() if self.ports else set(_PORT_REGISTERS)
        absent |= set() if self.family == "330" else {Register.PWM_SLOPE}
        absent |= set() if self.light else {Register.LED}
        return frozenset(absent | (set(_CURRENT_REGISTERS) if self.amperes is None else set()))


_RANGE_5V = (35, 70)  # [0.1 V] supply limits of 5 V models
_RANGE_12V = (55, 140)  # [0.1 V] supply limits of 12 V models
_RANGE_14V = (60, 140)  # [0.1 V] supply limits of 14 V models
_RANGE_16V = (60, 160)  # [0.1 V] supply limits of 16 V models
_RANGE_9V5 = (95, 160)  # [0.1 V] supply limits of models for at least 9.5 V

FACTORY_SHEETS = (
    FactorySheet(
        "xl330_m077",
        1190,
        _RANGE_5V,
        amperes=1750,
        speed=1620,
        gains=(400, 400, 0),
        inner=(400, 40),
        hottest=70,
        lowest=31,
        shutdown=53,
    ),
    FactorySheet(
        "xl330_m288",
        1200,
        _RANGE_5V,
        amperes=1750,
        speed=445,
        gains=(400, 0, 0),
        inner=(1600, 180),
        hottest=70,
        lowest=31,
        shutdown=53,
    ),
    FactorySheet(
        "xc330_t181", 1210, _RANGE_12V, amperes=910, speed=510, gains=(900, 0, 0), inner=(1200, 40), hottest=70
    ),
    FactorySheet(
        "xc330_t288", 1220, _RANGE_12V, amperes=910, speed=320, gains=(900, 0, 0), inner=(1200, 40), hottest=70
    ),
    FactorySheet(
        "xc330_m181",
        1230,
        _RANGE_5V,
        amperes=2352,
        speed=545,
        gains=(1200, 0, 500),
        inner=(1400, 100),
        hottest=70,
        lowest=31,
    ),
    FactorySheet(
        "xc330_m288",
        1240,
        _RANGE_5V,
        amperes=2352,
        speed=350,
        gains=(1100, 0, 500),
        inner=(1600, 50),
        hottest=70,
        lowest=31,
    ),
    FactorySheet(
        "xl430_w250", 1060, _RANGE_14V, amperes=None, speed=265, gains=(640, 0, 4000), inner=(1000, 100), hottest=72
    ),
    FactorySheet(
        "2xl430_w250", 1090, _RANGE_14V, amperes=None, speed=250, gains=(640, 0, 2000), inner=(1800, 100), hottest=72
    ),
    FactorySheet("xc430_w150", 1070, _RANGE_16V, amperes=None, speed=460, gains=(460, 0, 0), threshold=20),
    FactorySheet("xc430_w240", 1080, _RANGE_16V, amperes=None, speed=306, gains=(700, 0, 0)),
    FactorySheet(
        "xm430_w350", 1020, _RANGE_9V5, amperes=1193, speed=350, gains=(800, 0, 0)
    ),  # velocity limit of an older table
    FactorySheet("xm430_w210", 1030, _RANGE_9V5, amperes=1193, speed=330, gains=(800, 0, 0)),
    FactorySheet("xh430_w350", 1000, _RANGE_9V5, amperes=648, speed=130, gains=(900, 0, 0)),
    FactorySheet(
        "xh430_w210", 1010, _RANGE_9V5, amperes=648, speed=360, gains=(900, 0, 0)
    ),  # velocity limit of an older table
    FactorySheet("xm540_w270", 1120, _RANGE_9V5, amperes=2047, speed=128, gains=(800, 0, 0), ports=True),
    FactorySheet("xm540_w150", 1130, _RANGE_9V5, amperes=2047, speed=230, gains=(800, 0, 0), ports=True),
    FactorySheet("xh540_w270", 1100, _RANGE_9V5, amperes=2047, speed=167, gains=(800, 0, 0), ports=True),
    FactorySheet("xh540_w150", 1110, _RANGE_9V5, amperes=2047, speed=300, gains=(800, 0, 0), ports=True),
    FactorySheet("xw540_t260", 1170, _RANGE_9V5, amperes=2047, speed=167, gains=(800, 0, 0), light=False),
)
