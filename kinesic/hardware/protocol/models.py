"""Servo models of all families: registers, factory values, ranges and baud rates.

The sheets of the models are in `x_series` and `native_models`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from kinesic.body.config import ConfigError
from kinesic.body.servo import ServoModel
from kinesic.hardware.protocol.native_models import NATIVE_SHEETS, NativeSheet
from kinesic.hardware.protocol.registers import BAUD_RATES, Mode, Register
from kinesic.hardware.protocol.tables import FamilyTable
from kinesic.hardware.protocol.x_series import FACTORY_SHEETS, FactorySheet

Family = Literal["330", "430", "540", "native"]  # native: a family with its own control table

WATCHDOG_FIRMWARE = 38  # First firmware with a bus watchdog, which stops servos when the host fails
UNREACHABLE_FIRMWARE = 256  # First firmware of a feature that a model never gets; real versions are one byte


@dataclass(frozen=True)
class IndirectCells:
    """Address range of a model's indirect addresses and indirect data.

    The two-byte address at `addresses` + 2 k selects the byte that shows at `data` + k.
    """

    addresses: int  # first address of the indirect addresses
    data: int  # first address of the indirect data
    count: int  # number of cells, one byte each


@dataclass(frozen=True)
class Model:
    """Servo model: its registers, their ranges, and its operating modes.

    Values of a register are those of its field, unless `initial` or `ranges` override them.
    """

    name: str
    number: int  # model number, as in register MODEL_NUMBER
    family: Family
    amperes: float | None  # [A] per count of current; None: no current limit, and load in 0.1 % per count
    initial: Mapping[Register, int]
    ranges: Mapping[Register, tuple[int, int]]
    missing: frozenset[Register]
    modes: frozenset[Mode]
    table: FamilyTable | None = None  # control table with Protocol 1.0 frames; None: X series with Protocol 2.0

    def has(self, register: Register) -> bool:
        """Return whether the model has this register."""
        return register not in self.missing

    def factory_value(self, register: Register) -> int:
        """Return the factory value of a register."""
        return self.initial.get(register, register.field.initial)

    def allowed_range(self, register: Register) -> tuple[int, int]:
        """Return the smallest and the largest writable value of a register."""
        return self.ranges.get(register, (register.field.lower, register.field.upper))

    def quantise(self, register: Register, value: int) -> int:
        """Return the value that a register stores for a written value."""
        return value if self.table is None or not self.has(register) else self.table.quantise(register, value)

    @property
    def native_table(self) -> FamilyTable:
        """Control table of a family with Protocol 1.0 frames.

        Raises:
            ValueError: the model is of the X series.
        """
        if self.table is None:
            raise ValueError(f"{self.name} speaks Protocol 2.0, and has no table of another family")
        return self.table

    def baud_code(self, baud: int) -> int:
        """Return the value of BAUD_RATE for a baud rate [bit/s].

        Raises:
            ValueError: the model has no such rate.
        """
        code = _RATE_CODES.get(baud) if self.table is None else self.table.baud_code(baud)
        if code is None:
            raise ValueError(f"{self.name} has no baud rate {baud}; there are {', '.join(map(str, self.bauds))}")
        return code

    def baud_rate(self, code: int) -> int:
        """Return the baud rate [bit/s] of a BAUD_RATE value.

        It is 0 for an unknown value.
        """
        rates = dict(enumerate(BAUD_RATES)) if self.table is None else self.table.bauds
        return rates.get(code, 0)

    @property
    def bauds(self) -> tuple[int, ...]:
        """Baud rates of the model [bit/s]."""
        return BAUD_RATES if self.table is None else tuple(self.table.bauds.values())

    @property
    def registers(self) -> tuple[Register, ...]:
        """All registers of the model, by address."""
        return tuple(register for register in Register if self.has(register))

    @property
    def cells(self) -> tuple[IndirectCells, ...]:
        """Ranges of indirect cells in the control table of the model.

        An older table of the 330 has the data at 224; the bus checks the servo itself.
        """
        if self.family == "330":
            return (IndirectCells(168, 208, 20),)
        return (IndirectCells(168, 224, 28), IndirectCells(578, 634, 28))

    @property
    def fast_firmware(self) -> int:
        """First firmware with fast reads, according to the manual.

        UNREACHABLE_FIRMWARE if no version has them. The bus tests the servo itself.
        """
        if self.name.startswith("2") or self.table is not None:
            return UNREACHABLE_FIRMWARE
        return 46 if self.family == "330" else 45

    @property
    def min_firmware(self) -> int:
        """First firmware version with the required bus watchdog.

        It is 0 for a family without a bus watchdog.
        """
        return WATCHDOG_FIRMWARE if self.has(Register.BUS_WATCHDOG) else 0


_RATE_CODES = {rate: code for code, rate in enumerate(BAUD_RATES)}  # [bit/s] -> value of BAUD_RATE, X series


def _x_model(sheet: FactorySheet) -> Model:
    """Make the X series model with the factory settings of a sheet."""
    has_sensor = sheet.amperes is not None
    return Model(
        name=sheet.name,
        number=sheet.number,
        family=sheet.family,
        amperes=None if not has_sensor else 1e-3 if sheet.family == "330" else 2.69e-3,
        initial=sheet.initial,
        ranges=sheet.ranges,
        missing=sheet.missing,
        modes=frozenset(set(Mode) if has_sensor else set(Mode) - {Mode.CURRENT, Mode.CURRENT_POSITION}),
    )


def _native_model(sheet: NativeSheet) -> Model:
    """Make the model of another family from its sheet."""
    return Model(
        name=sheet.name,
        number=sheet.number,
        family="native",
        amperes=sheet.amperes,
        initial=sheet.initial,
        ranges=sheet.ranges,
        missing=frozenset(register for register in Register if not sheet.table.has(register)),
        modes=frozenset({Mode.POSITION}),
        table=sheet.table,
    )


_ALL_MODELS = (*(_x_model(sheet) for sheet in FACTORY_SHEETS), *(_native_model(sheet) for sheet in NATIVE_SHEETS))
SERVO_MODELS: Mapping[str, Model] = MappingProxyType({model.name: model for model in _ALL_MODELS})
ALL_BAUD_RATES = tuple(sorted({rate for model in _ALL_MODELS for rate in model.bauds}))  # [bit/s] of all families
MODELS_BY_NUMBER: Mapping[int, Model] = MappingProxyType({model.number: model for model in SERVO_MODELS.values()})


def control_table_of(servo: ServoModel, where: str) -> Model:
    """Return the `Model` with a servo's model number.

    Args:
        servo: servo of a robot.
        where: file and place for the error message.

    Raises:
        ConfigError: no `FactorySheet` has this number.
    """
    named = SERVO_MODELS.get(servo.name)  # versions for several supply voltages share a number
    model = named if named is not None and named.number == servo.model else MODELS_BY_NUMBER.get(servo.model)
    if model is None:
        names = ", ".join(sorted(SERVO_MODELS))
        raise ConfigError(
            f"{where}: servo {servo.name} has model number {servo.model}, which has no FactorySheet; "
            f"add one to kinesic/hardware/protocol/x_series.py, or mount one of {names}"
        )
    return model
