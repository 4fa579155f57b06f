"""The models of the X series as they differ on the wire: figures of the ROBOTIS e-Manual's tables, in raw counts.

What a model can do (torque, speed, mass) stands in `configs/servos.toml` under the same names.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from kinesic.hardware.protocol.registers import Mode, Register

Family = Literal["330", "430", "540"]

WATCHDOG_FIRMWARE = 38  # older ones have no bus watchdog, and nothing would stop them
NEVER = 256  # no version, which is one byte, reaches it
_PORTS = tuple(register for register in Register if register.name.startswith("EXTERNAL_PORT"))
_CURRENTS = (Register.CURRENT_LIMIT, Register.GOAL_CURRENT)


@dataclass(frozen=True)
class Cells:
    """A block of indirect cells: two bytes of address at `addresses` + 2 k show through at `data` + k."""

    addresses: int
    data: int
    count: int


@dataclass(frozen=True)
class Model:
    """One model. A register's figures are those of its field, unless `initial` or `range` say otherwise."""

    name: str
    number: int  # MODEL_NUMBER
    family: Family
    amperes: float | None  # [A] per count of current; None: it reports load, 0.1 % per count, and limits no current
    initial: Mapping[Register, int]
    ranges: Mapping[Register, tuple[int, int]]
    missing: frozenset[Register]
    modes: frozenset[Mode]

    def has(self, register: Register) -> bool:
        """Returns whether the model has this register at all."""
        return register not in self.missing

    def starts(self, register: Register) -> int:
        """Returns the factory value of a register."""
        return self.initial.get(register, register.field.initial)

    def range(self, register: Register) -> tuple[int, int]:
        """Returns the least and the largest value that may be written."""
        return self.ranges.get(register, (register.field.lower, register.field.upper))

    @property
    def registers(self) -> tuple[Register, ...]:
        """All it has, by address."""
        return tuple(register for register in Register if self.has(register))

    @property
    def cells(self) -> tuple[Cells, ...]:
        """Its indirect cells. An older table of the 330 puts the data at 224; the bus asks the servo itself."""
        if self.family == "330":
            return (Cells(168, 208, 20),)
        return (Cells(168, 224, 28), Cells(578, 634, 28))

    @property
    def fast_firmware(self) -> int:
        """The first firmware that answers fast reads, by the manual; the bus believes only the servo."""
        if self.name.startswith("2"):
            return NEVER
        return 46 if self.family == "330" else 45

    @property
    def least_firmware(self) -> int:
        """The first firmware that may be driven: it has the bus watchdog."""
        return WATCHDOG_FIRMWARE


@dataclass(frozen=True)
class FactorySheet:
    """One row of the manual's table: what a model comes with out of its box, in raw counts."""

    name: str  # as in `configs/servos.toml`
    number: int  # MODEL_NUMBER
    volts: tuple[int, int]  # [0.1 V] limits
    amperes: int | None  # limit of the current; None: has none
    speed: int  # velocity limit
    gains: tuple[int, int, int]  # position P, I, D
    inner: tuple[int, int] = (1920, 100)  # velocity I, P
    hottest: int = 80  # [C] temperature limit
    lowest: int | None = None  # [0.1 V] least voltage that may be set as a limit, where it is not the factory limit
    shutdown: int = 52  # mask
    threshold: int = 10  # of moving
    ports: bool = False  # whether it has external ports
    light: bool = True  # whether it has a LED

    @property
    def family(self) -> Family:
        """Which control table it has."""
        return "330" if "330" in self.name else "540" if "540" in self.name else "430"

    @property
    def initial(self) -> Mapping[Register, int]:
        """Factory values where they differ from those of the fields."""
        currents = {} if self.amperes is None else dict.fromkeys(_CURRENTS, self.amperes)
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
        """What may be written where it differs from the fields."""
        small, most = self.family == "330", self.amperes
        span = (self.volts[0] if self.lowest is None else self.lowest, self.volts[1])
        currents = {} if most is None else {Register.CURRENT_LIMIT: (0, most), Register.GOAL_CURRENT: (-most, most)}
        return MappingProxyType(
            {
                Register.MAX_VOLTAGE_LIMIT: span,
                Register.MIN_VOLTAGE_LIMIT: span,
                Register.VELOCITY_LIMIT: (0, 2047 if small else 1023),
                Register.GOAL_VELOCITY: (-2047, 2047) if small else (-1023, 1023),
                Register.BAUD_RATE: (0, 6 if small else 7),
                Register.PROTOCOL_TYPE: (2, 22) if small else (1, 2),
                Register.DRIVE_MODE: (0, 15 if self.family == "540" else 13),
                **currents,
            }
        )

    @property
    def missing(self) -> frozenset[Register]:
        """Registers that it does not have."""
        absent = set() if self.ports else set(_PORTS)
        absent |= set() if self.family == "330" else {Register.PWM_SLOPE}
        absent |= set() if self.light else {Register.LED}
        return frozenset(absent | (set(_CURRENTS) if self.amperes is None else set()))

    def model(self) -> Model:
        """Returns the model that it describes."""
        senses = self.amperes is not None
        return Model(
            name=self.name,
            number=self.number,
            family=self.family,
            amperes=None if not senses else 1e-3 if self.family == "330" else 2.69e-3,
            initial=self.initial,
            ranges=self.ranges,
            missing=self.missing,
            modes=frozenset(set(Mode) if senses else set(Mode) - {Mode.CURRENT, Mode.CURRENT_POSITION}),
        )


_V5, _V12, _V14, _V16 = (35, 70), (55, 140), (60, 140), (60, 160)
_V95 = (95, 160)

_SHEETS = (
    FactorySheet(
        "xl330_m077",
        1190,
        _V5,
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
        _V5,
        amperes=1750,
        speed=445,
        gains=(400, 0, 0),
        inner=(1600, 180),
        hottest=70,
        lowest=31,
        shutdown=53,
    ),
    FactorySheet("xc330_t181", 1210, _V12, amperes=910, speed=510, gains=(900, 0, 0), inner=(1200, 40), hottest=70),
    FactorySheet("xc330_t288", 1220, _V12, amperes=910, speed=320, gains=(900, 0, 0), inner=(1200, 40), hottest=70),
    FactorySheet(
        "xc330_m181", 1230, _V5, amperes=2352, speed=545, gains=(1200, 0, 500), inner=(1400, 100), hottest=70, lowest=31
    ),
    FactorySheet(
        "xc330_m288", 1240, _V5, amperes=2352, speed=350, gains=(1100, 0, 500), inner=(1600, 50), hottest=70, lowest=31
    ),
    FactorySheet(
        "xl430_w250", 1060, _V14, amperes=None, speed=265, gains=(640, 0, 4000), inner=(1000, 100), hottest=72
    ),
    FactorySheet(
        "2xl430_w250", 1090, _V14, amperes=None, speed=250, gains=(640, 0, 2000), inner=(1800, 100), hottest=72
    ),
    FactorySheet("xc430_w150", 1070, _V16, amperes=None, speed=460, gains=(460, 0, 0), threshold=20),
    FactorySheet("xc430_w240", 1080, _V16, amperes=None, speed=306, gains=(700, 0, 0)),
    FactorySheet("xm430_w350", 1020, _V95, amperes=1193, speed=350, gains=(800, 0, 0)),  # an older table's speed
    FactorySheet("xm430_w210", 1030, _V95, amperes=1193, speed=330, gains=(800, 0, 0)),
    FactorySheet("xh430_w350", 1000, _V95, amperes=648, speed=130, gains=(900, 0, 0)),
    FactorySheet("xh430_w210", 1010, _V95, amperes=648, speed=360, gains=(900, 0, 0)),  # an older table's speed
    FactorySheet("xm540_w270", 1120, _V95, amperes=2047, speed=128, gains=(800, 0, 0), ports=True),
    FactorySheet("xm540_w150", 1130, _V95, amperes=2047, speed=230, gains=(800, 0, 0), ports=True),
    FactorySheet("xh540_w270", 1100, _V95, amperes=2047, speed=167, gains=(800, 0, 0), ports=True),
    FactorySheet("xh540_w150", 1110, _V95, amperes=2047, speed=300, gains=(800, 0, 0), ports=True),
    FactorySheet("xw540_t260", 1170, _V95, amperes=2047, speed=167, gains=(800, 0, 0), light=False),
)

MODELS: Mapping[str, Model] = MappingProxyType({sheet.name: sheet.model() for sheet in _SHEETS})
BY_NUMBER: Mapping[int, Model] = MappingProxyType({model.number: model for model in MODELS.values()})
