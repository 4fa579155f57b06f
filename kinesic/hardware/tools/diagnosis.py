"""Finds what keeps servos from being driven, from the port to the last register, and says what mends it."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from kinesic.hardware.bus.bring_up import problems
from kinesic.hardware.bus.host import SYSTEM, latency
from kinesic.hardware.protocol.device import Cold
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.supervisor.manifest import Manifest, Member
from kinesic.hardware.supervisor.preflight import Table, reasons
from kinesic.hardware.tools.survey import find_unexpected_servos, open_slow_access

COOL = 10  # [K] below its limit that a resting servo should be


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at, and how it is."""

    bus: str
    about: str
    well: bool
    text: str  # how it is, and what mends it


def diagnose(
    manifest: Manifest, ports: dict[str, Path], opens: Callable[[str], Wire], *, system: Path = SYSTEM
) -> Iterator[Finding]:
    """Examines ports, adapters and servos; nothing is changed, and nothing stops at the first fault.

    Args:
        manifest: of the robot.
        ports: by the names of buses.
        opens: opens the port of a bus.
        system: where adapters tell their latency.
    """
    for bus in manifest.bauds:
        if bus not in ports:
            yield Finding(bus, "port", False, f"none given; --port {bus}=PATH")
            continue
        try:
            wire = opens(bus)
        except BusError as error:
            yield Finding(bus, "port", False, str(error))
            continue
        yield Finding(bus, "port", True, f"{wire.name} at {wire.baud} baud is ours")
        yield _adapter(bus, ports[bus], system)
        try:
            members = [member for member in manifest.members if member.bus == bus]
            yield from _servos(bus, open_slow_access(wire), members)
        except BusError as error:
            yield Finding(bus, "port", False, str(error))
        finally:
            wire.close()


def _adapter(bus: str, port: Path, system: Path) -> Finding:
    found = latency(port, system=system)
    if found is None:
        return Finding(bus, "latency", True, "the adapter has no latency timer")
    text = f"USB latency timer is {found.timer_ms} ms" if found.good else found.remedy
    return Finding(bus, "latency", found.good, text)


def _servos(bus: str, cold: Cold, members: list[Member]) -> Iterator[Finding]:
    wrong = problems(cold, [member.servo for member in members])
    nobody = len(wrong) == 1 and "no servo of ids" in wrong[0]
    well = 0
    for line in wrong:
        yield Finding(bus, "servos", False, line)
    for member in members:
        where = f"{cold.wire.name}: servo {member.id}"
        if nobody or any(line.startswith(f"{where}:") for line in wrong):
            continue
        lines = [f"{where} ({member.hinge}): {line}" for line in _doubts(cold, member)]
        for line in lines:
            yield Finding(bus, "servos", False, line)
        well += not lines
    others = find_unexpected_servos(cold, [member.id for member in members])
    if others and not nobody:
        text = f"the robot knows nothing of servo {', '.join(others)}; unplug it, or give it an id of [bus.ids]"
        yield Finding(bus, "servos", False, text)
    if well:
        yield Finding(bus, "servos", True, f"{well} of {len(members)} are as they should be")


def _doubts(cold: Cold, member: Member) -> list[str]:
    try:
        table = Table.read(cold, member)
    except BusError as error:
        return [str(error)]
    lines = list(reasons(table))
    limit, now = table[Register.TEMPERATURE_LIMIT], table[Register.PRESENT_TEMPERATURE]
    if now > limit - COOL:
        lines.append(f"is at {now} C, and shuts down at {limit} C; let it cool, and look what it works against")
    if table[Register.TORQUE_ENABLE]:
        lines.append("has torque, and nobody drives it; hold the robot, then `kinesic servos release`")
    return lines
