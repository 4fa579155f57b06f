"""Checks of bus load and supply voltage before a port is opened."""

from collections.abc import Sequence
from dataclasses import dataclass

from kinesic.body.robot import Robot
from kinesic.hardware.bus.cycle import BLOCK_DTYPE, RECORD_SIZE
from kinesic.hardware.bus.dialect import SERVO_TURNAROUND, cycle_size
from kinesic.hardware.protocol.models import MODELS_BY_NUMBER, UNREACHABLE_FIRMWARE
from kinesic.hardware.protocol.packet import PACKET_OVERHEAD, STATUS_OVERHEAD
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.wire import BITS_PER_BYTE, BusError
from kinesic.hardware.supervisor.axes import MAX_POLL_CYCLES
from kinesic.hardware.supervisor.manifest import Manifest, Member

MAX_BUS_LOAD = 0.95  # largest wire time of a cycle / cycle period
ADAPTER_LATENCY = 0.001  # [s] latency timer of an adapter in its recommended setting
SPAN_SIZE = 4  # [bytes] size of address and length in a collective packet
FAST_HEADER_SIZE = 8  # [bytes] size of a fast reply before its first block


@dataclass(frozen=True)
class BusLoad:
    """Wire time of one control cycle on a bus."""

    bus: str
    baud: int  # [bit/s]
    servos: int  # number of servos
    octets: int  # [bytes] of goals, query and replies of all servos
    period: float  # [s] cycle period
    bauds: tuple[int, ...]  # [bit/s] baud rates of the servos
    idle: float = 0.0  # [s] pauses while the host waits for single servos
    cycles: int = 1  # number of cycles in which all servos are read

    @property
    def ratio(self) -> float:
        """Time that goals, queries and replies take / time available for them."""
        return self._duration(self.baud) / (self.cycles * self.period)

    def _duration(self, baud: int) -> float:
        return self.octets * BITS_PER_BYTE / baud + self.idle

    @property
    def fits(self) -> bool:
        """Whether all goals and records of a cycle fit into its period."""
        return self.ratio <= MAX_BUS_LOAD

    @property
    def text(self) -> str:
        """Load in words, with a remedy for an overloaded bus."""
        load = f"{self.servos} servos at {self.baud} baud use {100 * self.ratio:.0f} % of the bus"
        if self.fits:
            return load
        budget = MAX_BUS_LOAD * self.cycles * self.period
        rate = next((rate for rate in sorted(self.bauds) if self._duration(rate) <= budget), None)
        if rate is None:
            return f"{load}; distribute them over several buses"
        return f"{load}; set servos and robot file to {rate} baud: `kinesic servos set-baud`"


def compute_bus_loads(manifest: Manifest, *, period: float) -> tuple[BusLoad, ...]:
    """Compute the wire time of a control cycle on each bus.

    Args:
        manifest: servos of the robot.
        period: [s] cycle period.
    """
    loads: list[BusLoad] = []
    for name, baud in manifest.bauds.items():
        members = [member for member in manifest.members if member.bus == name]
        model = members[0].model
        if model.table is None:
            loads.append(BusLoad(name, baud, len(members), _cycle_size(members), period, model.bauds))
            continue
        octets = cycle_size(model.table, len(members), full=False)
        single = model.table.collective == "none"
        pauses = len(members) * (SERVO_TURNAROUND + (ADAPTER_LATENCY if single else 0.0))
        cycles = MAX_POLL_CYCLES if single else 1
        loads.append(BusLoad(name, baud, len(members), octets, period, model.bauds, idle=pauses, cycles=cycles))
    return tuple(loads)


def explain_missing_watchdog(manifest: Manifest) -> str:
    """Describe how servos without a bus watchdog react to a host failure.

    The text is empty if all servos have one.
    """
    if not manifest.unwatched:
        return ""
    buses = ", ".join(manifest.unwatched)
    return (
        f"servos of bus {buses} have no bus watchdog: if the supervisor process, the computer or the adapter fails, "
        "they move to their last goal and hold it with torque; keep the power switch within reach"
    )


def explain_rare_answers(manifest: Manifest, silent: Sequence[str], *, period: float) -> str:
    """Explain that servos answer too rarely, with the probable cause first.

    Args:
        manifest: servos of the robot.
        silent: names of these servos.
        period: [s] cycle period.
    """
    overloads = [load for load in compute_bus_loads(manifest, period=period) if not load.fits]
    causes = "; ".join(f"bus {load.bus}: {load.text}" for load in overloads)
    cause = causes or "check plugs, cable length and latency timer"
    counted = f"{len(silent)} of {len(manifest.members)} servos"
    return f"{counted} answer too rarely; {cause} ({', '.join(silent)})"


def _cycle_size(members: list[Member]) -> int:
    """Return the bytes of one cycle: goals, query and replies."""
    count = len(members)
    goals = PACKET_OVERHEAD + SPAN_SIZE + count * (1 + Register.GOAL_POSITION.field.size)
    is_common = len({member.servo.cells for member in members}) == 1  # otherwise each id has its own address and size
    query = PACKET_OVERHEAD + (SPAN_SIZE + count if is_common else (1 + SPAN_SIZE) * count)
    is_fast = count > 1 and all(member.model.fast_firmware < UNREACHABLE_FIRMWARE for member in members)
    fast_reply = FAST_HEADER_SIZE + count * BLOCK_DTYPE.itemsize
    return goals + query + (fast_reply if is_fast else count * (STATUS_OVERHEAD + RECORD_SIZE))


def find_supply_faults(robot: Robot) -> tuple[str, ...]:
    """Return one line per servo model unsuited to the supply voltage.

    A robot without `[supply]` has no such line, nor has a servo of an unknown model.
    """
    if robot.supply is None:
        return ()
    hinges: dict[str, list[str]] = {}
    voltage_ranges: dict[str, tuple[float, float]] = {}
    for hinge, mount in zip(robot.skeleton.names, robot.mounts, strict=True):
        servo = mount.drive.servo
        model = MODELS_BY_NUMBER.get(servo.model)
        if model is None:
            continue
        scale = Register.MIN_VOLTAGE_LIMIT.field.scale
        voltage_ranges[servo.name] = (
            scale * model.factory_value(Register.MIN_VOLTAGE_LIMIT),
            scale * model.factory_value(Register.MAX_VOLTAGE_LIMIT),
        )
        hinges.setdefault(servo.name, []).append(hinge)
    volts, lines = robot.supply.volts, list[str]()
    for name, (lowest, highest) in voltage_ranges.items():
        if not lowest <= volts <= highest:
            lines.append(
                f"[supply] has {volts:g} V, but {name} takes {lowest:.1f}..{highest:.1f} V ({', '.join(hinges[name])})"
            )
    return tuple(lines)


def check_bus_loads(manifest: Manifest, *, period: float) -> None:
    """Check that each bus can serve all its servos every cycle.

    Args:
        manifest: servos of the robot.
        period: [s] cycle period.

    Raises:
        BusError: a bus is too slow; one line per bus, with a remedy.
    """
    loads = compute_bus_loads(manifest, period=period)
    if lines := [f"bus {load.bus} is too slow: {load.text}" for load in loads if not load.fits]:
        raise BusError("\n".join(lines))
