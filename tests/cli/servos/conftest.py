"""Virtual servos of the default robot that is moved by hand."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from importlib import import_module
from math import radians
from pathlib import Path
from threading import Event, Thread

import pytest

from kinesic.body.robot import Robot
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.virtual.faults import NO_FAULTS, FaultPlan
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.physics import FirstOrder
from kinesic.hardware.virtual.pty import PtyPort, serve_wires
from kinesic.hardware.virtual.wiring import build_bus, describe_cables

POSTURE_DURATION = 0.2  # [s] duration of each posture, long enough for several snapshots of the servos
PORT_MODULES = ("servos.ports", "servos.scan", "servos.release", "doctor")  # modules that open ports

Posture = Callable[[str], float]  # hinge name -> angle from the start [deg]


class Table:
    """Virtual servos of the default robot, with scheduled motion by hand."""

    def __init__(self, faults: FaultPlan = NO_FAULTS) -> None:
        robot = Robot.load()
        self.members = Manifest.of(robot).members
        (cable,) = describe_cables(robot)
        self.cable = replace(cable, faults=faults)
        angles = [fitting.ticks * Register.PRESENT_POSITION.field.scale for fitting in self.cable.fittings]
        self.physics = FirstOrder([fitting.motor for fitting in self.cable.fittings], angles)
        self.plant, buses = build_bus([self.cable], self.physics)
        self.bus, self.port = buses["body"], Path("table")
        self._zeros = angles
        self._moves: list[Posture] = []
        self._next = 0.0  # [s] time of the next posture

    def turn(self, *moves: Posture) -> None:
        """Schedule postures into which the robot is moved by hand."""
        self._moves, self._next = list(moves), 0.0

    def move(self, time: float) -> None:
        """Move the robot to the next scheduled posture if it is due."""
        if self._moves and time >= self._next:
            move, self._next = self._moves.pop(0), time + POSTURE_DURATION
            ids = [fitting.servo for fitting in self.cable.fittings]
            for member in self.members:
                k = ids.index(member.id)
                self.physics.turn(k, self._zeros[k] + member.turns * radians(move(member.hinge)))

    def energise(self) -> None:
        for servo in self.plant.servos:
            servo.write(Register.TORQUE_ENABLE.field.address, b"\1")

    @property
    def energised(self) -> int:
        return sum(servo.memory[Register.TORQUE_ENABLE] for servo in self.plant.servos)

    def set(self, servo: int, register: Register, value: int) -> None:
        next(each for each in self.plant.servos if each.id == servo).memory[register] = value


class TableWire(MemoryWire):
    """Wire to virtual servos that moves the robot by hand in time."""

    def __init__(self, table: Table, path: Path, baud: int) -> None:
        super().__init__(table.bus, name=str(path), time=table.plant.time)
        self.baud, self._table = baud, table

    def sleep(self, until: float, /) -> None:
        super().sleep(until)
        self._table.move(until)

    def close(self) -> None:
        """Advance the servos to this wire's time.

        The next wire opens after this one.
        """
        self._table.bus.advance(self.now())


@pytest.fixture
def table(monkeypatch: pytest.MonkeyPatch) -> Table:
    """Connect the ports of all verbs to virtual servos in virtual time."""
    virtual_table = Table()
    for verb in PORT_MODULES:
        module = import_module(f"kinesic.cli.{verb}")
        monkeypatch.setattr(module, "SerialWire", lambda path, baud: TableWire(virtual_table, path, baud))
    return virtual_table


SWITCH_INTERVAL = 2e-4  # [s] short, so that a busy-waiting driver yields to the thread of the servos


@contextmanager
def serving(virtual_table: Table, port: Path) -> Iterator[Table]:
    """Serve virtual servos at a pseudo-terminal in real time."""
    stop, switch_interval = Event(), sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_INTERVAL)
    virtual_table.port = port
    terminal = PtyPort(virtual_table.bus, virtual_table.port)
    terminal.exchange(0.0)
    thread = Thread(target=serve_wires, args=([terminal], lambda: not stop.is_set()))
    thread.start()
    try:
        yield virtual_table
    finally:
        stop.set()
        thread.join()
        sys.setswitchinterval(switch_interval)


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Table]:
    with serving(Table(), tmp_path / "port") as virtual_table:
        yield virtual_table
