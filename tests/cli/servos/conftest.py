"""The default robot's servos on a table, and hands that turn them: in virtual time, or behind a pseudo-terminal."""

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
from kinesic.hardware.virtual.faults import CALM, FaultPlan
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.physics import FirstOrder
from kinesic.hardware.virtual.pty import PtyPort, serve_wires
from kinesic.hardware.virtual.wiring import build_bus, cables

STAY = 0.2  # [s] that hands stay in each posture: some looks
VERBS = ("servos.ports", "servos.scan", "servos.release", "doctor")  # modules that open ports

Posture = Callable[[str], float]  # hinge -> [deg] from where it stood


class Table:
    """Servos that lie on a table."""

    def __init__(self, faults: FaultPlan = CALM) -> None:
        robot = Robot.load()
        self.members = Manifest.of(robot).members
        (cable,) = cables(robot)
        self.cable = replace(cable, faults=faults)
        places = [fitting.ticks * Register.PRESENT_POSITION.field.scale for fitting in self.cable.fittings]
        self.physics = FirstOrder([fitting.motor for fitting in self.cable.fittings], places)
        self.plant, buses = build_bus([self.cable], self.physics)
        self.bus, self.port = buses["body"], Path("table")
        self._zeros = places
        self._moves: list[Posture] = []
        self._next = 0.0  # [s] when hands move again

    def turn(self, *moves: Posture) -> None:
        """Hands bring the robot into these postures, one after another."""
        self._moves, self._next = list(moves), 0.0

    def move(self, time: float) -> None:
        """Hands go on [s]."""
        if self._moves and time >= self._next:
            move, self._next = self._moves.pop(0), time + STAY
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
    """A wire to the table, whose clock moves the hands."""

    def __init__(self, table: Table, path: Path, baud: int) -> None:
        super().__init__(table.bus, name=str(path), time=table.plant.time)
        self.baud, self._table = baud, table

    def sleep(self, until: float, /) -> None:
        super().sleep(until)
        self._table.move(until)


@pytest.fixture
def table(monkeypatch: pytest.MonkeyPatch) -> Table:
    """The verbs' ports lead to a table, and nothing takes time."""
    found = Table()
    for verb in VERBS:
        module = import_module(f"kinesic.cli.{verb}")
        monkeypatch.setattr(module, "SerialWire", lambda path, baud: TableWire(found, path, baud))
    return found


TURN = 2e-4  # [s] after which a driver that waits busily lets the servos, a thread of the same process, answer


@contextmanager
def serving(found: Table, port: Path) -> Iterator[Table]:
    """A table behind a port of this machine, in real time."""
    stop, usual = Event(), sys.getswitchinterval()
    sys.setswitchinterval(TURN)
    found.port = port
    terminal = PtyPort(found.bus, found.port)
    terminal.exchange(0.0)
    thread = Thread(target=serve_wires, args=([terminal], lambda: not stop.is_set()))
    thread.start()
    try:
        yield found
    finally:
        stop.set()
        thread.join()
        sys.setswitchinterval(usual)


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Table]:
    with serving(Table(), tmp_path / "port") as found:
        yield found
