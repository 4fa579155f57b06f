"""Diagnosis of ports, adapters and servos, with remedies."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from kinesic.hardware.bus.bring_up import find_problems
from kinesic.hardware.bus.host import SYSFS_ROOT, read_latency
from kinesic.hardware.protocol.device import ServoAccess
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.supervisor.manifest import Manifest, Member
from kinesic.hardware.supervisor.preflight import RegisterTable, find_refusals
from kinesic.hardware.supervisor.settings import DEFAULT_SETTINGS
from kinesic.hardware.supervisor.wiring_check import compute_bus_loads, explain_missing_watchdog
from kinesic.hardware.tools.survey import find_unexpected_servos, open_slow_access

MIN_COOLING_MARGIN = 10  # [K] smallest healthy margin between a resting servo's temperature and its limit


@dataclass(frozen=True)
class ServoFinding:
    """Result of one check of a bus: verdict, state and remedy."""

    bus: str
    about: str
    well: bool
    text: str  # state and remedy


def diagnose(
    manifest: Manifest,
    ports: dict[str, Path],
    opens: Callable[[str], Wire],
    *,
    period: float = DEFAULT_SETTINGS.period,
    system: Path = SYSFS_ROOT,
) -> Iterator[ServoFinding]:
    """Check ports, adapters and servos, and yield the findings.

    Only STATUS_RETURN_LEVEL is written. A fault does not stop the other checks.

    Args:
        manifest: servos of the robot.
        ports: ports by bus name.
        opens: opens the port of a bus.
        period: [s] cycle period of a performance, for the load of each bus.
        system: sysfs folder with the adapters' latency timers.
    """
    for bus in manifest.unwatched:
        yield ServoFinding(bus, "safety", True, explain_missing_watchdog(manifest))
    loads = {load.bus: load for load in compute_bus_loads(manifest, period=period)}
    for bus in manifest.bauds:
        yield ServoFinding(bus, "load", loads[bus].fits, loads[bus].text)
        if bus not in ports:
            yield ServoFinding(bus, "port", False, f"missing; give --port {bus}=PATH")
            continue
        try:
            wire = opens(bus)
        except BusError as error:
            yield ServoFinding(bus, "port", False, str(error))
            continue
        yield ServoFinding(bus, "port", True, f"{wire.name} is open at {wire.baud} baud")
        yield _adapter(bus, ports[bus], system)
        try:
            members = [member for member in manifest.members if member.bus == bus]
            yield from _servos(bus, open_slow_access(wire, manifest.tables[bus]), members)
        except BusError as error:
            yield ServoFinding(bus, "port", False, str(error))
        finally:
            wire.close()


def _adapter(bus: str, port: Path, system: Path) -> ServoFinding:
    adapter = read_latency(port, system=system)
    if adapter is None:
        return ServoFinding(bus, "latency", True, "the adapter has no latency timer")
    text = f"USB latency timer is {adapter.timer_ms} ms" if adapter.is_good else adapter.remedy
    return ServoFinding(bus, "latency", adapter.is_good, text)


def _servos(bus: str, access: ServoAccess, members: list[Member]) -> Iterator[ServoFinding]:
    problems = find_problems(access, [member.servo for member in members])
    none_answers = len(problems) == 1 and "no servo of ids" in problems[0]
    sound_count = 0
    for line in problems:
        yield ServoFinding(bus, "servos", False, line)
    for member in members:
        where = f"{access.wire.name}: servo {member.id}"
        if none_answers or any(line.startswith(f"{where}:") for line in problems):
            continue
        lines = [f"{where} ({member.hinge}): {line}" for line in _doubts(access, member)]
        for line in lines:
            yield ServoFinding(bus, "servos", False, line)
        sound_count += not lines
    others = find_unexpected_servos(access, [member.id for member in members])
    if others and not none_answers:
        text = f"servo {', '.join(others)} is not part of the robot; unplug it, or give it an id of [bus.ids]"
        yield ServoFinding(bus, "servos", False, text)
    if sound_count:
        yield ServoFinding(bus, "servos", True, f"{sound_count} of {len(members)} are ready")


def _doubts(access: ServoAccess, member: Member) -> list[str]:
    try:
        table = RegisterTable.read(access, member)
    except BusError as error:
        return [str(error)]
    lines = list(find_refusals(table))
    limit, now = table[Register.TEMPERATURE_LIMIT], table[Register.PRESENT_TEMPERATURE]
    if now > limit - MIN_COOLING_MARGIN:
        lines.append(f"is at {now} C and shuts down at {limit} C; let it cool, and find its load")
    if table[Register.TORQUE_ENABLE]:
        lines.append("has torque, but no program drives it; hold the robot, then `kinesic servos release`")
    return lines
