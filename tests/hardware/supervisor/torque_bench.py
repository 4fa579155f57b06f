"""Virtual servos for tests of procedures that switch torque, cycle by cycle."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.supervisor.axes import Axes, Snapshot
from kinesic.hardware.supervisor.preflight import configure, take_over
from kinesic.hardware.supervisor.torque import (
    Procedure,
    energise,
)
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.shaft_simulation import ShaftSimulation
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus

from .conftest import MODEL, PERIOD, manifest_of

COUNT = 4  # number of servos
FULL_PWM = 885  # [counts] GOAL_PWM at full power
WATCHDOG = 5  # value of BUS_WATCHDOG of servos with torque
ALL_PLACES = range(COUNT)
Change = Callable[[Snapshot, int], Snapshot]  # replacement of a procedure's snapshot by cycle number


class Bench:
    """Four servos, and a torque procedure that runs on them."""

    def __init__(self) -> None:
        cable = Cable("body", tuple(ServoFitting(k + 1, model=MODEL) for k in ALL_PLACES))
        self.plant: ShaftSimulation
        self.plant, buses = build_bus([cable])
        self.wire = MemoryWire(buses["body"])
        self.axes: Axes
        self.axes, tables = take_over(manifest_of(COUNT, self.wire.baud), lambda name: self.wire, period=PERIOD)
        configure(self.axes, tables)
        self.goals: Ticks | None = None
        self.power = np.full(COUNT, FULL_PWM)
        self.seen: list[dict[Register, list[int]]] = []  # after each cycle, see CHECKED_REGISTERS
        self.last = self.cycle()

    def true(self, register: Register) -> list[int]:
        return [servo.memory[register] for servo in self.plant.servos]

    def cycle(self) -> Snapshot:
        due = self.wire.now() + PERIOD
        snapshot = self.axes.cycle(self.goals)
        self.wire.sleep(due)
        self.seen.append({register: self.true(register) for register in CHECKED_REGISTERS})
        return snapshot

    def run(
        self,
        procedure: Procedure,
        change: Change = lambda snapshot, cycle: snapshot,
        *,
        places: Sequence[int] = ALL_PLACES,
    ) -> int:
        """Run a procedure for some servos, and return its number of cycles."""
        self.seen = []
        given, cycles = next(procedure, None), 0
        while True:
            if given is not None:
                self.goals = np.array(self.true(Register.PRESENT_POSITION) if self.goals is None else self.goals)
                self.goals[list(places)] = np.rint(given)
            self.last, cycles = self.cycle(), cycles + 1
            try:
                given = procedure.send(change(self.last, cycles))
            except StopIteration:
                return cycles

    def energised(self, *places: int) -> None:
        chosen = places or ALL_PLACES
        self.run(energise(self.axes, chosen, self.last, self.power, watchdog=WATCHDOG, steps=3), places=chosen)


CHECKED_REGISTERS = (Register.TORQUE_ENABLE, Register.GOAL_PWM, Register.GOAL_POSITION, Register.BUS_WATCHDOG)


def moved(snapshot: Snapshot, ticks: float) -> Snapshot:
    """Return the snapshot with the second servo moved."""
    records = snapshot.records.copy()
    records["position"][1] += round(ticks)
    return replace(snapshot, records=records)
