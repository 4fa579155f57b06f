"""All servos of all buses, in the order of `Manifest`."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Flags, Floats
from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.bus.bus import Bus
from kinesic.hardware.bus.cycle import Cycle, Event, Records
from kinesic.hardware.protocol.device import ServoAccess
from kinesic.hardware.protocol.frame_access import open_access
from kinesic.hardware.protocol.registers import WATCHDOG_TRIPPED, Register
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.manifest import Manifest

MAX_POLL_CYCLES = 3  # cycles within which servos that are read one by one must all answer
RECENT_PERIODS = 4.0  # [cycle periods] largest age of a recent record
Kind = TypeVar("Kind", bound=np.generic)


@dataclass(frozen=True, eq=False)
class Snapshot:
    """Records of all servos from one cycle of all buses."""

    time: float  # [s] start of the cycle
    records: Records  # (m,) last accepted record of each servo
    times: Floats  # (m,) [s] time of each record; minus infinity: no record yet
    recent: Flags  # (m,) whether the record is at most RECENT_PERIODS old
    lost: bool  # whether a port is gone
    signature: bytes  # errors, torque, watchdogs and temperatures of the records, for quick comparison
    events: tuple[tuple[str, Event], ...]  # name of the bus, and the event

    @cached_property
    def positions(self) -> Floats:
        """Positions (m,) [ticks], from PRESENT_POSITION."""
        return self.records["position"].astype(np.float64)

    @cached_property
    def torque(self) -> Flags:
        """Whether each servo has torque (m,)."""
        return np.asarray(self.records["torque"] != 0)

    @cached_property
    def tripped(self) -> Flags:
        """Whether each servo was stopped by its bus watchdog (m,)."""
        return np.asarray(self.records["watchdog"] == WATCHDOG_TRIPPED)


class Axes:
    """All open buses, with their servos in the order of `Manifest`."""

    def __init__(self, manifest: Manifest, buses: Mapping[str, Bus]) -> None:
        self.manifest = manifest
        self.buses: Mapping[str, Bus] = {name: buses[name] for name in manifest.bauds}
        tables = manifest.tables
        self._access = {name: open_access(bus.wire, tables[name]) for name, bus in self.buses.items()}
        self._quick_access = {name: open_access(bus.wire, tables[name], tries=1) for name, bus in self.buses.items()}
        places = {name: [k for k, m in enumerate(manifest.members) if m.bus == name] for name in manifest.bauds}
        self._parts = {name: slice(indices[0], indices[-1] + 1) for name, indices in places.items()}
        self._unidentified: set[str] = set()  # buses whose port was lost and may now lead to other servos
        first = next(iter(self.buses.values()))
        self._wire, self._period = first.wire, first.period

    @property
    def all_places(self) -> tuple[int, ...]:
        """Indices of the servos on all buses."""
        return tuple(range(len(self.manifest.members)))

    @property
    def poll_interval(self) -> float:
        """Additional record age [s] allowed for servos that are polled individually."""
        single = any(table is not None and table.collective == "none" for table in self.manifest.tables.values())
        return MAX_POLL_CYCLES * self._period if single else 0.0

    @property
    def unidentified(self) -> tuple[int, ...]:
        """Indices of servos behind reopened ports, not yet identified.

        Until they are accepted, they are read but not written.
        """
        if not self._unidentified:
            return ()
        return tuple(k for k, member in enumerate(self.manifest.members) if member.bus in self._unidentified)

    def accept_unidentified(self) -> None:
        """Accept the servos behind reopened ports as the expected ones."""
        self._unidentified.clear()

    def drop(self, place: int, reason: BusError) -> None:
        """Close a servo's serial port for a while, after a failed identification."""
        self.buses[self.manifest.members[place].bus].drop(reason)

    def now(self) -> float:
        """Return the clock [s] of the first bus's wire."""
        return self._wire.now()

    def sleep(self, until: float) -> None:
        """Wait until a time [s] of the wires' clock."""
        for bus in self.buses.values():
            bus.wire.sleep(until)

    def put(self, register: Register, values: Mapping[int, int]) -> None:
        """Queue a register write to some servos for the next cycle.

        Members without the register are skipped.

        Args:
            register: register to write.
            values: member index -> raw value.
        """
        members = self.manifest.members
        for name, bus in self.buses.items():
            if name in self._unidentified:
                continue
            bus_values = {
                members[k].id: value
                for k, value in values.items()
                if members[k].bus == name and members[k].model.has(register)
            }
            if bus_values:
                bus.put(register, bus_values)

    def put_all(self, register: Register, places: Sequence[int], value: int) -> None:
        """Queue a write of one register value to several servos."""
        self.put(register, dict.fromkeys(places, value))

    def cycle(self, goals: Ticks | None) -> Snapshot:
        """Run one cycle of every bus.

        Args:
            goals: (m,) [ticks]; None: query only.
        """
        time = self.now()
        parts = {} if goals is None else self._parts
        by_bus = {
            name: goals[part] for name, part in parts.items() if name not in self._unidentified and goals is not None
        }
        cycles = cycle_together(self.buses, by_bus)
        self._unidentified.update(name for name, cycle in cycles.items() if cycle.lost)
        limit = RECENT_PERIODS * self._period
        by_order = tuple(cycles.values())
        return Snapshot(
            time=time,
            records=_row([cycle.records for cycle in by_order]),
            times=_row([cycle.times for cycle in by_order]),
            recent=_row([cycle.ages <= limit for cycle in by_order]),
            lost=any(cycle.lost for cycle in by_order),
            signature=b"".join(cycle.signature for cycle in by_order),
            events=tuple((name, event) for name, cycle in cycles.items() for event in cycle.events),
        )

    def read(self, place: int, registers: Collection[Register]) -> dict[Register, int]:
        """Read some registers of one servo with a single attempt.

        Raises:
            BusError: the member does not answer, or the port is gone.
        """
        member = self.manifest.members[place]
        return self._quick_access[member.bus].read_several(member.id, registers)

    def write(self, place: int, register: Register, value: int) -> None:
        """Set a register of one servo at once, with retries.

        Raises:
            BusError: the member does not answer or refuses, or the port is gone.
        """
        member = self.manifest.members[place]
        self._access[member.bus].write(member.id, register, value)

    def access(self, bus: str) -> ServoAccess:
        """Return the slow, retrying access to the servos of a bus."""
        return self._access[bus]

    def quick_access(self, bus: str) -> ServoAccess:
        """Return servo access without retries, for use between cycles.

        Other servos wait for their goals until it returns.
        """
        return self._quick_access[bus]

    def label(self, place: int) -> str:
        """Return a servo's name for messages."""
        member = self.manifest.members[place]
        return f"{self.buses[member.bus].wire.name}: servo {member.id} ({member.hinge})"

    def close(self) -> None:
        """Close all ports."""
        for bus in self.buses.values():
            bus.wire.close()


def cycle_together(buses: Mapping[str, Bus], goals: Mapping[str, Ticks]) -> dict[str, Cycle]:
    """Run one cycle on every bus at the same time.

    All buses are queried before the first reply is awaited.

    Args:
        buses: open buses, by name.
        goals: (n,) [ticks] by bus name; a bus without goals is only queried.
    """
    for name, bus in buses.items():
        bus.begin(goals.get(name))
    return {name: bus.finish() for name, bus in buses.items()}


def _row(parts: Sequence[NDArray[Kind]]) -> NDArray[Kind]:
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def fold_turns(positions: Floats) -> Floats:
    """Reduce positions [ticks] to one turn, as servos do when energised."""
    turned: Floats = np.mod(positions, TICKS_PER_TURN)
    return turned
