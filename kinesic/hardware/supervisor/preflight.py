"""Checks and register settings of the servos before torque is switched on."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil

from kinesic.body.limits import PLANNED_DUTY
from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.bus.bring_up import open_bus
from kinesic.hardware.bus.bus import Bus
from kinesic.hardware.protocol.device import RegisterChange, ServoAccess
from kinesic.hardware.protocol.frame_access import open_access
from kinesic.hardware.protocol.registers import VELOCITY_UNIT, HardwareError, Register
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.supervisor.axes import Axes
from kinesic.hardware.supervisor.manifest import Manifest, Member

PLANNED_VELOCITY_FRACTION = 0.8  # Maximum planned velocity / no-load velocity
MIN_CURRENT_FRACTION = 0.5  # smallest accepted current limit / factory limit; a lower one would slow every performance
MIN_TEMPERATURE_LIMIT = 50  # [C] smallest accepted temperature limit of a servo, because working servos are warm
POSITION_REGISTERS = (
    Register.DRIVE_MODE,
    Register.OPERATING_MODE,
    Register.HOMING_OFFSET,
)  # Registers that determine which angle a position in ticks means
VITAL_REGISTERS = (*POSITION_REGISTERS, Register.SECONDARY_ID)  # Registers that must be correct on a servo with torque
LOWER_LIMIT_REGISTER = Register.MIN_VOLTAGE_LIMIT  # Register whose limit is raised to its factory value if lower
UPPER_LIMIT_REGISTERS = (Register.MAX_VOLTAGE_LIMIT, Register.TEMPERATURE_LIMIT)  # Lowered to factory values if higher


@dataclass(frozen=True)
class RegisterTable:
    """Register values of one servo, read in a single span."""

    member: Member
    data: bytes

    @classmethod
    def read(cls, access: ServoAccess, member: Member) -> "RegisterTable":
        """Read the registers of a servo.

        Raises:
            BusError: the servo does not answer.
        """
        return cls(member, access.read_table(member.id))

    def __getitem__(self, register: Register) -> int:
        return register.field.unpack(self.data[register.field.address : register.field.end])


def take_over(
    manifest: Manifest, opens: Callable[[str], Wire], *, period: float
) -> tuple[Axes, tuple[RegisterTable, ...]]:
    """Open all ports, check all servos, and return axes and registers.

    Args:
        manifest: required servos.
        opens: opens the wire of a bus by its name, or raises BusError.
        period: [s] of cycles.

    Raises:
        BusError: a port or a servo is missing or unsuitable; one line each, and no port stays open.
    """
    wires = open_wires(manifest, opens)
    try:
        axes = prepare_servos(manifest, wires, period=period)
        tables = read_manifest_tables(axes)
        check_servos(axes, tables)
    except BusError:
        for wire in wires.values():
            wire.close()
        raise
    return axes, tables


def open_wires(manifest: Manifest, opens: Callable[[str], Wire]) -> dict[str, Wire]:
    """Open the serial ports of all buses.

    Raises:
        BusError: some do not open; one line each.
    """
    wires: dict[str, Wire] = {}
    lines: list[str] = []
    for name in manifest.bauds:
        try:
            wires[name] = opens(name)
        except BusError as error:
            lines.append(str(error))
    if lines:
        for wire in wires.values():
            wire.close()
        raise BusError("\n".join(lines))
    return wires


def prepare_servos(manifest: Manifest, wires: Mapping[str, Wire], *, period: float) -> Axes:
    """Check and prepare the servos on open ports, and return their axes.

    Args:
        manifest: required servos.
        wires: open wires, by bus.
        period: [s] of cycles.

    Raises:
        BusError: servos are missing, of another model, on another id or undervolted; one line each.
    """
    buses: dict[str, Bus] = {}
    lines: list[str] = []
    for name, wire in wires.items():
        members = [member for member in manifest.members if member.bus == name]
        open_access(wire, manifest.tables[name]).enable_replies()
        try:
            buses[name] = open_bus(wire, [member.servo for member in members], period=period)
        except BusError as error:
            lines += str(error).splitlines()
    if lines:
        raise BusError("\n".join(lines))
    return Axes(manifest, buses)


def read_manifest_tables(axes: Axes) -> tuple[RegisterTable, ...]:
    """Read the registers of all servos.

    Raises:
        BusError: a servo does not answer.
    """
    return tuple(RegisterTable.read(axes.access(member.bus), member) for member in axes.manifest.members)


def check_servos(axes: Axes, tables: tuple[RegisterTable, ...]) -> None:
    """Check that the servos may be driven.

    Raises:
        BusError: some may not; one line per reason.
    """
    lines = [f"{axes.label(k)}: {reason}" for k, table in enumerate(tables) for reason in find_refusals(table)]
    if lines:
        raise BusError("\n".join(lines))


def find_refusals(table: RegisterTable) -> tuple[str, ...]:
    """Return reasons against driving a servo, each with a remedy."""
    checks = (_error, _range, _speed, _power, _current, _heat, _place, _mode)
    return tuple(reason for check in checks if (reason := check(table)))


def _error(table: RegisterTable) -> str:
    error = table[Register.HARDWARE_ERROR_STATUS]
    if not error:
        return ""
    return f"has shut down ({', '.join(HardwareError.names(error))}); find out why, then switch its power off and on"


def _range(table: RegisterTable) -> str:
    member, least, most = table.member, table[Register.MIN_POSITION_LIMIT], table[Register.MAX_POSITION_LIMIT]
    if least <= member.lower and member.upper <= most:
        return ""
    return (
        f"takes {least}..{most} ticks, but its hinge needs {member.lower}..{member.upper}; "
        "widen its position limits with `kinesic servos calibrate`, or narrow range_deg"
    )


def _speed(table: RegisterTable) -> str:
    limit, needed = table[Register.VELOCITY_LIMIT] * VELOCITY_UNIT, PLANNED_VELOCITY_FRACTION * table.member.speed
    if limit >= needed:
        return ""
    return f"its velocity limit is {limit:.2f} rad/s, but plans use {needed:.2f}; raise it with DYNAMIXEL Wizard"


def _power(table: RegisterTable) -> str:
    limit, needed = table[Register.PWM_LIMIT], ceil(PLANNED_DUTY * table.member.model.factory_value(Register.PWM_LIMIT))
    if limit >= needed:
        return ""
    return f"its PWM limit is {limit}, but plans use {needed}; raise it with DYNAMIXEL Wizard"


def _current(table: RegisterTable) -> str:
    model, limit = table.member.model, table[Register.CURRENT_LIMIT]
    needed = ceil(MIN_CURRENT_FRACTION * model.factory_value(Register.CURRENT_LIMIT))
    if not model.has(Register.CURRENT_LIMIT) or limit >= needed:
        return ""
    return f"its current limit is {limit}, must be {needed} at least; raise it with DYNAMIXEL Wizard"


def _heat(table: RegisterTable) -> str:
    limit = table[Register.TEMPERATURE_LIMIT]
    if limit >= MIN_TEMPERATURE_LIMIT:
        return ""
    needed = MIN_TEMPERATURE_LIMIT
    return f"its temperature limit is {limit} C, must be {needed} C at least; raise it with DYNAMIXEL Wizard"


def _place(table: RegisterTable) -> str:
    if _differing(table, POSITION_REGISTERS):
        return ""  # its position is unknown until these are set
    lower, upper = table.member.span
    position = table[Register.PRESENT_POSITION] % TICKS_PER_TURN
    if lower <= position <= upper:
        return ""
    return (
        f"is at {position} ticks, outside {lower}..{upper}; "
        "move it by hand, or calibrate it with `kinesic servos calibrate`"
    )


def _mode(table: RegisterTable) -> str:
    """Describe wrong mode registers of a servo with torque, or return ""."""
    wrong = [register.name for register in _differing(table, VITAL_REGISTERS)]
    if not table[Register.TORQUE_ENABLE] or not wrong:
        return ""
    return f"has torque, but other values of {', '.join(wrong)}; release it with `kinesic servos release`"


def _differing(table: RegisterTable, registers: Sequence[Register]) -> list[Register]:
    """Return the given registers that differ from their required EEPROM values."""
    required = table.member.eeprom_values
    return [register for register in registers if table[register] != required.get(register, table[register])]


def configure(axes: Axes, tables: tuple[RegisterTable, ...]) -> tuple[RegisterChange, ...]:
    """Set the required EEPROM values of servos without torque.

    Only differing registers are written, and limits are only narrowed. The changes are returned.

    Raises:
        BusError: a servo does not answer, does not take a value, or is outside its range with its new zero.
    """
    unpowered = [table for table in tables if not table[Register.TORQUE_ENABLE]]
    required = [
        {r: value for r, value in required_registers(table).items() if table[r] != value} for table in unpowered
    ]
    changes: list[RegisterChange] = []
    for aliases in (True, False):  # aliases first, because a servo with an alias would take the values of another
        for table, differing in zip(unpowered, required, strict=True):
            part = {r: value for r, value in differing.items() if (r is Register.SECONDARY_ID) is aliases}
            changes += axes.access(table.member.bus).configure(table.member.id, part)
    moved = {change.servo for change in changes if change.register in POSITION_REGISTERS}
    check_servos(axes, tuple(_read_again(axes, table) if table.member.id in moved else table for table in tables))
    return tuple(changes)


def _read_again(axes: Axes, table: RegisterTable) -> RegisterTable:
    return RegisterTable.read(axes.access(table.member.bus), table.member)


def required_registers(table: RegisterTable) -> dict[Register, int]:
    """Return the required EEPROM values of a servo."""
    member, model, startup = table.member, table.member.model, Register.STARTUP_CONFIGURATION
    lower, upper = member.span
    values = dict(member.eeprom_values)
    if model.has(startup) and (model.family == "330" or table[Register.FIRMWARE_VERSION] >= startup.field.firmware):
        values[startup] = 0
    least = {Register.MIN_POSITION_LIMIT: lower, LOWER_LIMIT_REGISTER: model.factory_value(LOWER_LIMIT_REGISTER)}
    most = {Register.MAX_POSITION_LIMIT: upper} | {r: model.factory_value(r) for r in UPPER_LIMIT_REGISTERS}
    narrowed = {r: max(v, table[r]) for r, v in least.items()} | {r: min(v, table[r]) for r, v in most.items()}
    return values | {r: model.quantise(r, v) for r, v in narrowed.items()}
