"""Buses in virtual time, with kinesic's virtual servos and with independent ones."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
import pytest

from kinesic.hardware.bus.bring_up import open_bus
from kinesic.hardware.bus.bus import Bus
from kinesic.hardware.bus.cycle import Cycle
from kinesic.hardware.bus.dialect import Servo
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.ticks import Ticks
from kinesic.hardware.virtual.faults import NO_FAULTS, FaultPlan
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.shaft_simulation import ShaftSimulation
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus

from .manual.adapter import ManualWire, Plant, build_manual

BUILDERS = {"kinesic": (build_bus, MemoryWire), "manual": (build_manual, ManualWire)}


@dataclass
class Rig:
    """Bus in virtual time, with the servos connected to this bus."""

    bus: Bus
    wire: MemoryWire | ManualWire
    plant: ShaftSimulation | Plant

    def true(self, register: Register) -> Ticks:
        """Return the actual register values of the servos."""
        return np.array([servo.memory[register] for servo in self.plant.servos])

    def run(self, cycles: int, goals: Ticks | None = None) -> list[Cycle]:
        """Run cycles at the bus's period."""
        done = []
        for _ in range(cycles):
            due = self.wire.now() + self.bus.period
            done.append(self.bus.cycle(goals))
            self.wire.sleep(due)
        return done

    def energise(self) -> None:
        """Switch torque on with the goal of each servo at its position."""
        goals = self.true(Register.PRESENT_POSITION)
        self.bus.cycle(goals)
        self.bus.put(Register.TORQUE_ENABLE, dict.fromkeys(self.bus.ids, 1))
        self.run(3, goals)


def rig_of(
    count: int = 7,
    *,
    baud: int = 1_000_000,
    period: float = 0.01,
    model: str = "xm430_w350",
    firmware: int = 52,
    faults: FaultPlan = NO_FAULTS,
    mixed: bool = False,
    latency: float = 0.001,
    servos: str = "kinesic",
) -> Rig:
    models = ["xc330_t288" if mixed and k % 2 else model for k in range(count)]
    fitted = tuple(ServoFitting(k + 1, model=name, firmware=firmware) for k, name in enumerate(models))
    build, wire_of = BUILDERS[servos]
    plant, buses = build([Cable("body", fitted, baud=baud, latency=latency, faults=faults)])
    wire = wire_of(buses["body"])
    members = [Servo(k + 1, SERVO_MODELS[name]) for k, name in enumerate(models)]
    return Rig(open_bus(wire, members, period=period), wire, plant)


@pytest.fixture(params=list(BUILDERS))
def servos(request: pytest.FixtureRequest) -> str:
    """Return the name of the implementation of virtual servos under test."""
    return str(request.param)


@pytest.fixture
def rig(servos: str) -> Callable[..., Rig]:
    """Return a function that opens a bus of virtual servos without torque."""
    return partial(rig_of, servos=servos)
