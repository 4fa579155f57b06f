"""Virtual servos behind pseudo-terminals in a process of their own, and what they did."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.supervisor.state_machine import Stage

HERE = Path(__file__).parent
PATIENCE = 60.0  # [s] that a loaded machine may take for anything
WATCHDOG = 0.2
SETTINGS = SupervisorSettings(watchdog=WATCHDOG, patient_watchdog=WATCHDOG, pace=3.0)
BUSES = ("left", "right")


@dataclass
class Record:
    """What the servos did, and when."""

    times: np.ndarray  # (m,) [s]
    plugged: np.ndarray  # (m, 2)
    torque: np.ndarray  # (m, 5)
    goals: np.ndarray
    watchdogs: np.ndarray
    places: np.ndarray

    def stall(self, start: float, end: float) -> float:
        """[s] the longest time that the servos' own process did nothing."""
        times = self.times[(self.times >= start - 0.05) & (self.times <= end + 0.05)]
        return float(np.diff(times).max())


class Table:
    """Virtual servos in a process of their own, for one test after another until one leaves them out of order."""

    def __init__(self, robot: Robot, folder: Path) -> None:
        self.folder, self.in_order = folder, True
        command = [sys.executable, str(HERE / "served.py"), str(robot.path), str(folder)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        Rig.wait(lambda: all((folder / name).exists() for name in BUSES))

    def tell(self, line: str) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(line.encode() + b"\n")
        self._process.stdin.flush()

    def record(self, since: float) -> Record:
        """From a time [s] until now."""
        assert self._process.stdout is not None
        self.tell("show")
        assert self._process.stdout.readline() == b"shown\n"
        rows = np.loadtxt(self.folder / "record")
        rows = rows[rows[:, 0] >= since]
        shown = rows[:, 3:].reshape(len(rows), 5, 4)
        return Record(rows[:, 0], rows[:, 1:3], shown[:, :, 0], shown[:, :, 1], shown[:, :, 2], shown[:, :, 3])

    def close(self) -> None:
        self._process.communicate(timeout=PATIENCE)


class Rig:
    """What a test does with the servos on a table, and what it learns of them."""

    def __init__(self, robot: Robot, table: Table, folder: Path) -> None:
        self.robot, self.folder, self.log = robot, table.folder, folder / "events.jsonl"
        self._table, self._began = table, time.monotonic()
        self._planners: list[subprocess.Popen[bytes]] = []
        self._opened: list[Servos] = []

    @staticmethod
    def wait(until: Callable[[], object]) -> None:
        limit = time.monotonic() + PATIENCE
        while not until():
            assert time.monotonic() < limit, "waited in vain"
            time.sleep(0.005)

    @staticmethod
    def kill(pid: int) -> float:
        """kill -9; when [s]."""
        os.kill(pid, signal.SIGKILL)
        return time.monotonic()

    def moving(self, servos: Servos) -> None:
        """Waits until the performance runs."""
        self.wait(lambda: self.goes_on(servos) and servos.state().time > 0.4)

    @staticmethod
    def goes_on(servos: Servos) -> bool:
        """Whether it performs; where this machine stood still for so long that somebody has to consent, we do."""
        status = servos.state()
        if status.waits == "consent":
            servos.resume()
        return status.stage is Stage.ACTIVE

    def write(self, servos: Servos, seconds: float) -> None:
        """A motion that begins at rest and goes on."""
        rest = self.robot.skeleton.rest
        still = np.zeros(len(rest))
        for tick in range(round(seconds * 100) + 1):
            goals = rest + 0.3 * (1 - np.cos(2 * tick * 0.01))
            servos.write(Command(tick * 0.01, goals, still, still, goals))

    @property
    def ports(self) -> dict[str, Path]:
        return {name: self.folder / name for name in BUSES}

    def opened(self) -> Servos:
        """Opens them, once more where the machine did not let the servos answer in time."""
        for _ in range(4):
            try:
                self._opened.append(Servos(self.robot, self.ports, settings=SETTINGS, log=self.log))
                return self._opened[-1]
            except BusError as error:
                if "no status packet" not in str(error):
                    raise
        raise AssertionError("the servos did not answer four times")

    def planner(self, *seconds: str, **environment: str) -> subprocess.Popen[bytes]:
        """A planner in a process of its own, in the middle of a performance."""
        arguments = [str(self.robot.path), str(self.folder), str(self.log), *seconds]
        command = [sys.executable, str(HERE / "planner.py"), *arguments]
        process = subprocess.Popen(command, env=os.environ | environment)
        self._planners.append(process)
        self.wait(lambda: self.log.exists() and self.entered(Stage.ACTIVE))
        return process

    def strike(self, line: str) -> None:
        self._table.in_order = self._table.in_order and not line.startswith("alert")  # which only a reboot ends
        self._table.tell(line)

    def record(self) -> Record:
        """What the servos have done in this test."""
        return self._table.record(self._began)

    def events(self) -> list[tuple[float, str, str]]:
        lines = [json.loads(line) for line in self.log.read_text().splitlines()]
        return [(line["time"], line["kind"], line["text"]) for line in lines]

    def entered(self, stage: Stage, after: float = 0.0) -> float | None:
        """[s] when a stage was entered first after a time."""
        for moment, kind, text in self.events():
            if kind == "stage" and moment >= after and f"-> {stage.value} " in text:
                return moment
        return None

    def end(self) -> None:
        """Kills what a test that failed has left running; its table is not in order any more."""
        for planner in self._planners:
            if planner.poll() is None:
                self._table.in_order = False
                planner.kill()
                planner.wait(PATIENCE)
        for servos in self._opened:
            if servos.running:
                self._table.in_order = False
                self.kill(servos.pid)
                with suppress(BusError):
                    servos.close()


@pytest.fixture(scope="session")
def tables(robot: Robot, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[[], Table]]:
    """The table of the test before, or a new one."""
    made: list[Table] = []

    def table() -> Table:
        if made and not made[-1].in_order:
            made.pop().close()
        if not made:
            made.append(Table(robot, tmp_path_factory.mktemp("table")))
        return made[-1]

    yield table
    for each in made:
        each.close()


@pytest.fixture
def rig(robot: Robot, tables: Callable[[], Table], tmp_path: Path) -> Iterator[Rig]:
    table = tables()
    made = Rig(robot, table, tmp_path)
    yield made
    made.end()
    table.in_order = table.in_order and not made.record().torque[-1].any()
