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
        """Whether the model has this register at all."""
        return register not in self.missing

    def starts(self, register: Register) -> int:
        """Its factory value."""
        return self.initial.get(register, register.field.initial)

    def range(self, register: Register) -> tuple[int, int]:
        """The least and the largest value that may be written."""
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


def _model(
    name: str,
    number: int,
    volts: tuple[int, int],
    *,
    amperes: int | None,
    speed: int,
    gains: tuple[int, int, int],
    inner: tuple[int, int] = (1920, 100),
    hottest: int = 80,
    lowest: int | None = None,
    shutdown: int = 52,
    threshold: int = 10,
    ports: bool = False,
    light: bool = True,
) -> Model:
    """One row of the table.

    Args:
        name: as in `configs/servos.toml`.
        number: of the model.
        volts: factory limits [0.1 V].
        amperes: factory current limit [counts]; None: has none.
        speed: factory velocity limit.
        gains: position P, I, D.
        inner: velocity I, P.
        hottest: factory temperature limit [C].
        lowest: least voltage that may be set as a limit [0.1 V], where it is not the factory limit.
        shutdown: factory mask.
        threshold: factory moving threshold.
        ports: whether it has external ports.
        light: whether it has a LED.
    """
    family: Family = "330" if "330" in name else "540" if "540" in name else "430"
    small = family == "330"
    span = (volts[0] if lowest is None else lowest, volts[1])
    initial = {
        Register.MODEL_NUMBER: number,
        Register.MAX_VOLTAGE_LIMIT: volts[1],
        Register.MIN_VOLTAGE_LIMIT: volts[0],
        Register.TEMPERATURE_LIMIT: hottest,
        Register.MOVING_THRESHOLD: threshold,
        Register.VELOCITY_LIMIT: speed,
        Register.SHUTDOWN: shutdown,
        Register.VELOCITY_I_GAIN: inner[0],
        Register.VELOCITY_P_GAIN: inner[1],
        Register.POSITION_P_GAIN: gains[0],
        Register.POSITION_I_GAIN: gains[1],
        Register.POSITION_D_GAIN: gains[2],
        Register.PWM_SLOPE: 140 if volts[1] == 70 else 255,
    }
    ranges = {
        Register.MAX_VOLTAGE_LIMIT: span,
        Register.MIN_VOLTAGE_LIMIT: span,
        Register.VELOCITY_LIMIT: (0, 2047 if small else 1023),
        Register.GOAL_VELOCITY: (-2047, 2047) if small else (-1023, 1023),
        Register.BAUD_RATE: (0, 6 if small else 7),
        Register.PROTOCOL_TYPE: (2, 22) if small else (1, 2),
        Register.DRIVE_MODE: (0, 15 if family == "540" else 13),
    }
    missing = set() if ports else set(_PORTS)
    missing |= set() if small else {Register.PWM_SLOPE}
    missing |= set() if light else {Register.LED}
    modes = set(Mode)
    if amperes is None:
        missing |= set(_CURRENTS)
        modes -= {Mode.CURRENT, Mode.CURRENT_POSITION}
    else:
        initial |= dict.fromkeys(_CURRENTS, amperes)
        ranges |= {Register.CURRENT_LIMIT: (0, amperes), Register.GOAL_CURRENT: (-amperes, amperes)}
    return Model(
        name=name,
        number=number,
        family=family,
        amperes=None if amperes is None else 1e-3 if small else 2.69e-3,
        initial=MappingProxyType(initial),
        ranges=MappingProxyType(ranges),
        missing=frozenset(missing),
        modes=frozenset(modes),
    )


_V5, _V12, _V14, _V16 = (35, 70), (55, 140), (60, 140), (60, 160)
_V95 = (95, 160)

_ROWS = (
    _model(
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
    _model(
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
    _model("xc330_t181", 1210, _V12, amperes=910, speed=510, gains=(900, 0, 0), inner=(1200, 40), hottest=70),
    _model("xc330_t288", 1220, _V12, amperes=910, speed=320, gains=(900, 0, 0), inner=(1200, 40), hottest=70),
    _model(
        "xc330_m181", 1230, _V5, amperes=2352, speed=545, gains=(1200, 0, 500), inner=(1400, 100), hottest=70, lowest=31
    ),
    _model(
        "xc330_m288", 1240, _V5, amperes=2352, speed=350, gains=(1100, 0, 500), inner=(1600, 50), hottest=70, lowest=31
    ),
    _model("xl430_w250", 1060, _V14, amperes=None, speed=265, gains=(640, 0, 4000), inner=(1000, 100), hottest=72),
    _model("2xl430_w250", 1090, _V14, amperes=None, speed=250, gains=(640, 0, 2000), inner=(1800, 100), hottest=72),
    _model("xc430_w150", 1070, _V16, amperes=None, speed=460, gains=(460, 0, 0), threshold=20),
    _model("xc430_w240", 1080, _V16, amperes=None, speed=306, gains=(700, 0, 0)),
    _model("xm430_w350", 1020, _V95, amperes=1193, speed=350, gains=(800, 0, 0)),  # an older table's speed
    _model("xm430_w210", 1030, _V95, amperes=1193, speed=330, gains=(800, 0, 0)),
    _model("xh430_w350", 1000, _V95, amperes=648, speed=130, gains=(900, 0, 0)),
    _model("xh430_w210", 1010, _V95, amperes=648, speed=360, gains=(900, 0, 0)),  # an older table's speed
    _model("xm540_w270", 1120, _V95, amperes=2047, speed=128, gains=(800, 0, 0), ports=True),
    _model("xm540_w150", 1130, _V95, amperes=2047, speed=230, gains=(800, 0, 0), ports=True),
    _model("xh540_w270", 1100, _V95, amperes=2047, speed=167, gains=(800, 0, 0), ports=True),
    _model("xh540_w150", 1110, _V95, amperes=2047, speed=300, gains=(800, 0, 0), ports=True),
    _model("xw540_t260", 1170, _V95, amperes=2047, speed=167, gains=(800, 0, 0), light=False),
)

MODELS: Mapping[str, Model] = MappingProxyType({model.name: model for model in _ROWS})
BY_NUMBER: Mapping[int, Model] = MappingProxyType({model.number: model for model in _ROWS})
