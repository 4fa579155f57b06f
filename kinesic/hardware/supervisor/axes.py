"""Drives all servos of all buses as one row, in the manifest's order."""

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
from kinesic.hardware.protocol.device import Cold
from kinesic.hardware.protocol.registers import WATCHDOG_TRIPPED, Register
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.manifest import Manifest

RECENT = 4.0  # periods
Kind = TypeVar("Kind", bound=np.generic)


@dataclass(frozen=True, eq=False)
class Snapshot:
    """What came of one cycle of all buses, by members."""

    time: float  # [s] when it began
    records: Records  # (m,)
    times: Floats  # (m,) [s] when each record was taken; minus infinity: never
    recent: Flags  # (m,) whose record is at most `RECENT` periods old
    lost: bool  # whether a port is gone
    signature: bytes  # while it stays, torque, errors, watchdogs and temperatures do
    events: tuple[tuple[str, Event], ...]  # with the name of the bus

    @cached_property
    def positions(self) -> Floats:
        """(m,) PRESENT_POSITION [ticks]."""
        return self.records["position"].astype(np.float64)

    @cached_property
    def torque(self) -> Flags:
        """(m,) who has torque."""
        return np.asarray(self.records["torque"] != 0)

    @cached_property
    def tripped(self) -> Flags:
        """(m,) who was stopped by the bus watchdog."""
        return np.asarray(self.records["watchdog"] == WATCHDOG_TRIPPED)


class Axes:
    """Open buses, whose servos stand in the order of the manifest."""

    def __init__(self, manifest: Manifest, buses: Mapping[str, Bus]) -> None:
        self.manifest = manifest
        self.buses: Mapping[str, Bus] = {name: buses[name] for name in manifest.bauds}
        self._cold = {name: Cold(bus.wire) for name, bus in self.buses.items()}
        self._brief = {name: Cold(bus.wire, tries=1) for name, bus in self.buses.items()}
        places = {name: [k for k, m in enumerate(manifest.members) if m.bus == name] for name in manifest.bauds}
        self._parts = {name: slice(found[0], found[-1] + 1) for name, found in places.items()}
        self._strange: set[str] = set()  # buses whose port was lost: who is behind it now?
        first = next(iter(self.buses.values()))
        self._wire, self._period = first.wire, first.period

    @property
    def everybody(self) -> tuple[int, ...]:
        """The places of all members."""
        return tuple(range(len(self.manifest.members)))

    @property
    def strangers(self) -> tuple[int, ...]:
        """The places of members whose port was lost, until they are welcome: they are asked, and told nothing."""
        if not self._strange:
            return ()
        return tuple(k for k, member in enumerate(self.manifest.members) if member.bus in self._strange)

    def welcome(self) -> None:
        """Takes the servos behind ports that were lost for those of the manifest."""
        self._strange.clear()

    def drop(self, place: int, reason: BusError) -> None:
        """Gives up a member's port for a while: other servos are behind it."""
        self.buses[self.manifest.members[place].bus].drop(reason)

    def now(self) -> float:
        """Returns the time [s] of the first wire."""
        return self._wire.now()

    def sleep(self, until: float) -> None:
        """Waits until a time [s]."""
        for bus in self.buses.values():
            bus.wire.sleep(until)

    def put(self, register: Register, values: Mapping[int, int]) -> None:
        """Writes a register of some members (place -> raw value) with the next cycle; who lacks it is left out."""
        members = self.manifest.members
        for name, bus in self.buses.items():
            if name in self._strange:
                continue
            mine = {
                members[k].id: value
                for k, value in values.items()
                if members[k].bus == name and members[k].model.has(register)
            }
            if mine:
                bus.put(register, mine)

    def put_all(self, register: Register, places: Sequence[int], value: int) -> None:
        """Writes the same value for several."""
        self.put(register, dict.fromkeys(places, value))

    def cycle(self, goals: Ticks | None) -> Snapshot:
        """Runs one cycle of every bus.

        Args:
            goals: (m,) [ticks]; None: asks only.
        """
        time = self.now()
        parts = {} if goals is None else self._parts
        by_bus = {name: goals[part] for name, part in parts.items() if name not in self._strange and goals is not None}
        cycles = cycle_together(self.buses, by_bus)
        self._strange.update(name for name, cycle in cycles.items() if cycle.lost)
        limit = RECENT * self._period
        each = tuple(cycles.values())
        return Snapshot(
            time=time,
            records=_row([cycle.records for cycle in each]),
            times=_row([cycle.times for cycle in each]),
            recent=_row([cycle.ages <= limit for cycle in each]),
            lost=any(cycle.lost for cycle in each),
            signature=b"".join(cycle.signature for cycle in each),
            events=tuple((name, event) for name, cycle in cycles.items() for event in cycle.events),
        )

    def read(self, place: int, registers: Collection[Register]) -> dict[Register, int]:
        """Reads some registers of one member, as `brief` does.

        Raises:
            BusError: it does not answer, or the port is gone.
        """
        member = self.manifest.members[place]
        return self._brief[member.bus].read_several(member.id, registers)

    def write(self, place: int, register: Register, value: int) -> None:
        """Sets a register of one member, alone.

        Raises:
            BusError: it does not answer, refuses, or the port is gone.
        """
        member = self.manifest.members[place]
        self._cold[member.bus].write(member.id, register, value)

    def cold(self, bus: str) -> Cold:
        """Returns the slow access (`Cold`) to the servos of a bus."""
        return self._cold[bus]

    def brief(self, bus: str) -> Cold:
        """Returns the access that asks once, for use between cycles: other servos wait for their goals meanwhile."""
        return self._brief[bus]

    def where(self, place: int) -> str:
        """Names a member in messages."""
        member = self.manifest.members[place]
        return f"{self.buses[member.bus].wire.name}: servo {member.id} ({member.hinge})"

    def close(self) -> None:
        """Gives all ports back."""
        for bus in self.buses.values():
            bus.wire.close()


def cycle_together(buses: Mapping[str, Bus], goals: Mapping[str, Ticks]) -> dict[str, Cycle]:
    """Runs one cycle on every bus: all are asked before the first is heard, so that they wait together.

    Args:
        buses: open ones, by name.
        goals: (n,) [ticks] by the name of the bus; one without goals is only asked.
    """
    for name, bus in buses.items():
        bus.begin(goals.get(name))
    return {name: bus.finish() for name, bus in buses.items()}


def _row(parts: Sequence[NDArray[Kind]]) -> NDArray[Kind]:
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def fold_turns(positions: Floats) -> Floats:
    """Folds positions [ticks] into one turn, as torque coming on does."""
    turned: Floats = np.mod(positions, TICKS_PER_TURN)
    return turned
