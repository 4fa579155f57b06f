"""Check that the servos behind a reopened port are the previous ones.

A port name may be reused by another adapter.
"""

from kinesic.hardware.protocol.registers import WATCHDOG_TRIPPED, Register
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.axes import Axes
from kinesic.hardware.supervisor.preflight import RegisterTable
from kinesic.hardware.supervisor.torque import Procedure

PERSISTENT_REGISTERS = tuple(
    register for register in Register if register.field.end <= Register.TORQUE_ENABLE.field.address
)
"""Registers that keep their value without power."""

IDENTIFY_TRIES = 4  # Attempts to read the registers of a servo behind a reopened port


def identify(axes: Axes, tables: tuple[RegisterTable, ...], *, watchdog: int) -> Procedure:
    """Check that servos behind reopened ports have their earlier register values.

    It reads one servo per cycle.

    Args:
        axes: all servos.
        tables: (m,) earlier registers.
        watchdog: BUS_WATCHDOG that they had with torque.

    Raises:
        BusError: a servo differs, or none answers; the port is closed for a while.
    """
    seen: set[str] = set()
    for place in axes.unidentified:
        member, now = axes.manifest.members[place], None
        for _ in range(IDENTIFY_TRIES):
            yield None
            try:
                now = RegisterTable.read(axes.quick_access(member.bus), member)
            except BusError:
                continue
            break
        if now is None:
            continue  # it may still be starting; the others identify the bus
        if other := describe_difference(tables[place], now, watchdog=watchdog):
            yield from _refuse(axes, place, f"{other}; another robot is behind this port")
        seen.add(member.bus)
    for place in axes.unidentified:
        if axes.manifest.members[place].bus not in seen:
            yield from _refuse(axes, place, "no servo answers on the reopened port; is the power on?")
    axes.accept_unidentified()


def _refuse(axes: Axes, place: int, why: str) -> Procedure:
    """Close a servo's port for a while, and raise the reason.

    Raises:
        BusError: always, after the next cycle.
    """
    reason = BusError(f"{axes.label(place)}: {why}")
    axes.drop(place, reason)
    yield None
    raise reason


def describe_difference(before: RegisterTable, now: RegisterTable, *, watchdog: int) -> str:
    """Describe how a servo differs from its earlier registers, or return ""."""
    for register in PERSISTENT_REGISTERS:
        if before[register] != now[register]:
            return f"its {register.name} is {now[register]}, must be {before[register]}"
    actual_watchdog = now[Register.BUS_WATCHDOG]
    if not now.member.model.has(Register.BUS_WATCHDOG):
        return ""
    if now[Register.TORQUE_ENABLE] and actual_watchdog not in (watchdog, WATCHDOG_TRIPPED):
        return f"it has torque and a BUS_WATCHDOG of {actual_watchdog}, must be {watchdog} or tripped"
    return ""
