"""Checks before torque that these are the servos of the manifest, and sets their registers. Nothing is energised."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import ceil

from kinesic.body.limits import DUTY
from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.bus.bring_up import open_bus
from kinesic.hardware.bus.bus import Bus
from kinesic.hardware.protocol.device import Change, Cold, demand_answers
from kinesic.hardware.protocol.registers import SPEED, HardwareError, Register
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.supervisor.axes import Axes
from kinesic.hardware.supervisor.manifest import Manifest, Member

SPEED_SHARE = 0.8  # of the speed without load that plans use
CURRENT_SHARE = 0.5  # of the factory's limit of the current, below which time would always run slowly
COOLEST = 50  # [C] least temperature limit: a servo at work is warmer than most rooms
PLACING = (Register.DRIVE_MODE, Register.OPERATING_MODE, Register.HOMING_OFFSET)  # without which ticks mean nothing
VITAL = (*PLACING, Register.SECONDARY_ID)  # without which a servo with torque may not be driven
BOTTOM, TOPS = Register.MIN_VOLTAGE_LIMIT, (Register.MAX_VOLTAGE_LIMIT, Register.TEMPERATURE_LIMIT)  # as made
_END = Register.PRESENT_TEMPERATURE.field.end


@dataclass(frozen=True)
class Table:
    """The registers of one servo, read at once."""

    member: Member
    data: bytes

    @classmethod
    def read(cls, cold: Cold, member: Member) -> "Table":
        """Reads the registers of a servo.

        Raises:
            BusError: it does not answer.
        """
        return cls(member, cold.read_span(member.id, 0, _END))

    def __getitem__(self, register: Register) -> int:
        return register.field.unpack(self.data[register.field.address : register.field.end])


def take_over(manifest: Manifest, opens: Callable[[str], Wire], *, period: float) -> tuple[Axes, tuple[Table, ...]]:
    """Opens the ports, and checks that everything is as it must be.

    Args:
        manifest: who must be there.
        opens: the wire of a bus, by its name; raises BusError.
        period: [s] of cycles.

    Raises:
        BusError: a port or a servo is missing or wrong; one line each, and no port stays open.
    """
    wires = open_wires(manifest, opens)
    try:
        axes = prepare_servos(manifest, wires, period=period)
        found = control_tables(axes)
        check_servos(axes, found)
    except BusError:
        for wire in wires.values():
            wire.close()
        raise
    return axes, found


def open_wires(manifest: Manifest, opens: Callable[[str], Wire]) -> dict[str, Wire]:
    """Opens the wires of all buses.

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
    """Checks who hangs on the wires, and lets them show their records.

    Args:
        manifest: who must.
        wires: open ones, by bus.
        period: [s] of cycles.

    Raises:
        BusError: servos are missing, wrong, shut down or outside their ranges; one line each.
    """
    buses: dict[str, Bus] = {}
    lines: list[str] = []
    for name, wire in wires.items():
        members = [member for member in manifest.members if member.bus == name]
        demand_answers(wire)
        try:
            buses[name] = open_bus(wire, [member.servo for member in members], period=period)
        except BusError as error:
            lines += str(error).splitlines()
    if lines:
        raise BusError("\n".join(lines))
    return Axes(manifest, buses)


def control_tables(axes: Axes) -> tuple[Table, ...]:
    """Reads the registers of all servos.

    Raises:
        BusError: a servo does not answer.
    """
    return tuple(Table.read(axes.cold(member.bus), member) for member in axes.manifest.members)


def check_servos(axes: Axes, found: tuple[Table, ...]) -> None:
    """Checks that the servos, which are the right ones, may be driven.

    Raises:
        BusError: some may not; one line for each reason.
    """
    lines = [f"{axes.where(k)}: {reason}" for k, table in enumerate(found) for reason in reasons(table)]
    if lines:
        raise BusError("\n".join(lines))


def reasons(table: Table) -> tuple[str, ...]:
    """Returns why a servo may not be driven, and what mends it; empty if it may."""
    looks = (_error, _range, _speed, _power, _current, _heat, _place, _mode)
    return tuple(reason for look in looks if (reason := look(table)))


def _error(table: Table) -> str:
    error = table[Register.HARDWARE_ERROR_STATUS]
    if not error:
        return ""
    return f"has shut down ({', '.join(HardwareError.names(error))}); find out why, then switch its power off and on"


def _range(table: Table) -> str:
    member, least, most = table.member, table[Register.MIN_POSITION_LIMIT], table[Register.MAX_POSITION_LIMIT]
    if least <= member.lower and member.upper <= most:
        return ""
    return (
        f"takes {least}..{most} ticks, but its hinge needs {member.lower}..{member.upper}; "
        "widen its position limits with `kinesic servos calibrate`, or narrow range_deg"
    )


def _speed(table: Table) -> str:
    limit, needed = table[Register.VELOCITY_LIMIT] * SPEED, SPEED_SHARE * table.member.speed
    if limit >= needed:
        return ""
    return f"its velocity limit is {limit:.2f} rad/s, but plans use {needed:.2f}; raise it with DYNAMIXEL Wizard"


def _power(table: Table) -> str:
    limit, needed = table[Register.PWM_LIMIT], ceil(DUTY * table.member.model.starts(Register.PWM_LIMIT))
    if limit >= needed:
        return ""
    return f"its PWM limit is {limit}, but plans use {needed}; raise it with DYNAMIXEL Wizard"


def _current(table: Table) -> str:
    model, limit = table.member.model, table[Register.CURRENT_LIMIT]
    needed = ceil(CURRENT_SHARE * model.starts(Register.CURRENT_LIMIT))
    if not model.has(Register.CURRENT_LIMIT) or limit >= needed:
        return ""
    return f"its current limit is {limit}, must be {needed} at least; raise it with DYNAMIXEL Wizard"


def _heat(table: Table) -> str:
    limit = table[Register.TEMPERATURE_LIMIT]
    if limit >= COOLEST:
        return ""
    return f"its temperature limit is {limit} C, must be {COOLEST} C at least; raise it with DYNAMIXEL Wizard"


def _place(table: Table) -> str:
    if any(table[r] != table.member.lasting[r] for r in PLACING):
        return ""  # where it stands is known when these are set
    lower, upper = table.member.span
    here = table[Register.PRESENT_POSITION] % TICKS_PER_TURN
    if lower <= here <= upper:
        return ""
    return (
        f"stands at {here} ticks, outside {lower}..{upper}; "
        "move it by hand, or calibrate it with `kinesic servos calibrate`"
    )


def _mode(table: Table) -> str:
    """A servo with torque cannot be set: it must be right already."""
    wrong = [r.name for r in VITAL if table[r] != table.member.lasting[r]]
    if not table[Register.TORQUE_ENABLE] or not wrong:
        return ""
    return f"has torque, but another {', '.join(wrong)}; let it go with `kinesic servos release`"


def configure(axes: Axes, found: tuple[Table, ...]) -> tuple[Change, ...]:
    """Sets what EEPROM must hold where it differs, in servos without torque. Limits are only narrowed.

    Raises:
        BusError: a servo does not answer, does not take a value, or stands outside its range once its ticks count.
    """
    limp = [table for table in found if not table[Register.TORQUE_ENABLE]]
    wishes = [{r: value for r, value in required_registers(table).items() if table[r] != value} for table in limp]
    changes: list[Change] = []
    for aliases in (True, False):  # before all others: who has an alias would take what is meant for another
        for table, wished in zip(limp, wishes, strict=True):
            part = {r: value for r, value in wished.items() if (r is Register.SECONDARY_ID) is aliases}
            changes += axes.cold(table.member.bus).configure(table.member.id, part)
    moved = {change.servo for change in changes if change.register in PLACING}
    check_servos(axes, tuple(_read_again(axes, table) if table.member.id in moved else table for table in found))
    return tuple(changes)


def _read_again(axes: Axes, table: Table) -> Table:
    return Table.read(axes.cold(table.member.bus), table.member)


def required_registers(table: Table) -> dict[Register, int]:
    """Returns what the EEPROM of a servo must hold."""
    member, model, startup = table.member, table.member.model, Register.STARTUP_CONFIGURATION
    lower, upper = member.span
    wishes = dict(member.lasting)
    if model.family == "330" or table[Register.FIRMWARE_VERSION] >= startup.field.firmware:
        wishes[startup] = 0
    least = {Register.MIN_POSITION_LIMIT: lower, BOTTOM: model.starts(BOTTOM)}
    most = {Register.MAX_POSITION_LIMIT: upper} | {r: model.starts(r) for r in TOPS}
    return wishes | {r: max(v, table[r]) for r, v in least.items()} | {r: min(v, table[r]) for r, v in most.items()}
