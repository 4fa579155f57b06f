from collections.abc import Callable, Mapping
from dataclasses import dataclass

import pytest

from kinesic.body.robot import Robot
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.virtual.faults import NO_FAULTS, FaultPlan
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.servo import VirtualServo
from kinesic.hardware.virtual.wiring import build_bus, describe_cables


@dataclass
class Bench:
    """Default robot's servos without load, in virtual time."""

    manifest: Manifest
    wire: MemoryWire
    servos: Mapping[int, VirtualServo]

    def set(self, servo: int, register: Register, value: int) -> None:
        """Set a register to another value than the robot file requires."""
        self.servos[servo].memory[register] = value

    @property
    def energised(self) -> list[int]:
        return [servo.id for servo in self.servos.values() if servo.memory[Register.TORQUE_ENABLE]]


def bench_of(faults: FaultPlan = NO_FAULTS) -> Bench:
    robot = Robot.load()
    (cable,) = describe_cables(robot)
    plant, buses = build_bus([cable])
    buses[cable.name].expose(faults)
    wire = MemoryWire(buses[cable.name])
    return Bench(Manifest.of(robot), wire, {servo.id: servo for servo in plant.servos})


@pytest.fixture
def bench() -> Callable[..., Bench]:
    return bench_of
