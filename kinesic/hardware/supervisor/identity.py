"""Finds out whether the servos behind a port that was lost are those from before: names of ports are used again."""

from kinesic.hardware.protocol.registers import WATCHDOG_TRIPPED, Register
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.axes import Axes
from kinesic.hardware.supervisor.preflight import Table
from kinesic.hardware.supervisor.torque import Procedure

LASTING = tuple(register for register in Register if register.field.end <= Register.TORQUE_ENABLE.field.address)
"""What a servo keeps without power."""

TRIES = 4  # cycles in which a servo is asked


def identify(axes: Axes, tables: tuple[Table, ...], *, watchdog: int) -> Procedure:
    """Compares the servos behind ports that were lost with those from before, one read in each cycle.

    Args:
        axes: all servos.
        tables: (m,) their registers from before.
        watchdog: BUS_WATCHDOG that they had with torque.

    Raises:
        BusError: a servo is another one, or none answers; the port is given up for a while.
    """
    seen: set[str] = set()
    for place in axes.strangers:
        member, now = axes.manifest.members[place], None
        for _ in range(TRIES):
            yield None
            try:
                now = Table.read(axes.brief(member.bus), member)
            except BusError:
                continue
            break
        if now is None:
            continue  # it may still be starting: the others tell whose bus this is
        if other := difference(tables[place], now, watchdog=watchdog):
            yield from _refuse(axes, place, f"{other}; another robot is behind this port")
        seen.add(member.bus)
    for place in axes.strangers:
        if axes.manifest.members[place].bus not in seen:
            yield from _refuse(axes, place, "no servo answers since the port is back; is the power on?")
    axes.welcome()


def _refuse(axes: Axes, place: int, why: str) -> Procedure:
    """Gives a port up, which the next cycle shows.

    Raises:
        BusError: why.
    """
    reason = BusError(f"{axes.where(place)}: {why}")
    axes.drop(place, reason)
    yield None
    raise reason


def difference(before: Table, now: Table, *, watchdog: int) -> str:
    """Says how a servo differs from the one before; empty if it may be the same."""
    for register in LASTING:
        if before[register] != now[register]:
            return f"its {register.name} is {now[register]}, must be {before[register]}"
    found = now[Register.BUS_WATCHDOG]
    if now[Register.TORQUE_ENABLE] and found not in (watchdog, WATCHDOG_TRIPPED):
        return f"it has torque and a BUS_WATCHDOG of {found}, must be {watchdog}, or have tripped"
    return ""
