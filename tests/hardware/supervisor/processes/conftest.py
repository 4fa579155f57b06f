"""Virtual servos behind pseudo-terminals in a separate process."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.address import find_supervisor
from kinesic.hardware.supervisor.channel import Channel, Status
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.supervisor.state_machine import Stage

from .opening import BUS_NAMES, open_servos

HERE = Path(__file__).parent
ROOT = Path(__file__).parents[4]
PATIENCE = 60.0  # [s] longest wait for any event on a loaded machine
WATCHDOG = 0.2
POLL_INTERVAL = 0.02  # [s] pause between two looks at logs and records, which are parsed each time
SETTINGS = SupervisorSettings(watchdog=WATCHDOG, patient_watchdog=WATCHDOG, pace=3.0)
SERVO_COUNT = 5  # number of servos of the small robot
JOINTS = 4  # number of hinges of the small robot
MAX_REST_DISTANCE = 10  # [ticks] largest distance of a servo at rest from its rest position, less than a degree
MIN_RAISED_DISTANCE = (
    60  # [ticks] distance from its first position above which a servo counts as raised, more than five degrees
)
TRANSFER_TIME = 0.05  # [s] until written bytes have reached the servos


@dataclass
class Record:
    """Recorded torque and motion of the servos over time."""

    times: np.ndarray  # (m,) [s] time of each record
    plugged: np.ndarray  # (m, 2) whether each of the two ports is plugged in
    torque: np.ndarray  # (m, 5) whether each of the five servos has torque
    goals: np.ndarray
    watchdogs: np.ndarray
    places: np.ndarray

    @property
    def stopped(self) -> bool:
        """Return whether the bus watchdogs stopped all servos in the end."""
        return bool((self.watchdogs[-1] == -1).all())

    def stall(self, start: float, end: float) -> float:
        """Return the longest pause [s] of the process that simulates the servos."""
        return longest_gap(self.times, start, end)


def longest_gap(times: Iterable[float], start: float, end: float) -> float:
    """Return the longest gap [s] between successive times in a period."""
    near = [each for each in times if start - 0.05 <= each <= end + 0.05]
    return float(np.diff(near).max())


def lateness(history: Iterable[Status], start: float, end: float) -> float:
    """Return the largest delay [s] of a supervisor cycle."""
    return max(0.0, longest_gap((item.clock for item in history), start, end) - SETTINGS.period)


class Table:
    """Virtual servos in a separate process, reused by later tests unless damaged."""

    def __init__(self, robot: Robot, folder: Path) -> None:
        self.folder, self.in_order = folder, True
        command = [sys.executable, str(HERE / "served.py"), str(robot.path), str(folder)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        Rig.wait(lambda: all((folder / name).exists() for name in BUS_NAMES))
        self._file = (folder / "record").open()
        self._rows, self._begun = np.empty((0, 3 + 4 * SERVO_COUNT)), ""  # whole lines; what there is of the next

    def tell(self, line: str) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(line.encode() + b"\n")
        self._process.stdin.flush()

    def record(self, since: float) -> Record:
        """Return the record from a time [s] until now."""
        assert self._process.stdout is not None
        self.tell("show")
        assert self._process.stdout.readline() == b"shown\n"
        text, self._begun = (self._begun + self._file.read()).rsplit("\n", 1)
        news = np.fromstring(text, sep=" ").reshape(-1, 3 + 4 * SERVO_COUNT)
        rows = self._rows = np.concatenate([self._rows[self._rows[:, 0] >= since], news[news[:, 0] >= since]])
        shown = rows[:, 3:].reshape(len(rows), SERVO_COUNT, 4)
        return Record(rows[:, 0], rows[:, 1:3], shown[:, :, 0], shown[:, :, 1], shown[:, :, 2], shown[:, :, 3])

    def close(self) -> None:
        self._process.communicate(timeout=PATIENCE)
        self._file.close()


class Rig:
    """Access of a test to the servos of a table."""

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
            time.sleep(POLL_INTERVAL)

    @staticmethod
    def kill(pid: int) -> float:
        """Kill a process with SIGKILL, and return the time [s]."""
        os.kill(pid, signal.SIGKILL)
        return time.monotonic()

    def moving(self, servos: Servos) -> None:
        """Wait until the performance runs."""
        self.wait(lambda: self.goes_on(servos) and servos.state().time > 0.4)

    def raised(self) -> bool:
        """Return whether a servo is far from its position at the start of the test."""
        places = self.record().places
        return bool(np.abs(places[-1] - places[0]).max() > MIN_RAISED_DISTANCE)

    @staticmethod
    def goes_on(servos: Servos) -> bool:
        """Return whether the performance time advances.

        After a long stall of this machine, the test gives its consent.
        """
        status = servos.state()
        if status.waits == "consent":
            servos.resume()
        return status.stage is Stage.ACTIVE

    def write(self, servos: Servos, seconds: float) -> None:
        """Write a motion that starts at rest and continues."""
        rest = self.robot.skeleton.rest
        still = np.zeros(len(rest))
        for tick in range(round(seconds * 100) + 1):
            goals = rest + 0.3 * (1 - np.cos(2 * tick * 0.01))
            servos.write(Command(tick * 0.01, goals, still, still, goals))

    @property
    def ports(self) -> dict[str, Path]:
        return {name: self.folder / name for name in BUS_NAMES}

    def opened(self, settings: SupervisorSettings = SETTINGS) -> Servos:
        self._opened.append(open_servos(self.robot, self.folder, settings=settings, log=self.log))
        return self._opened[-1]

    def planner(self, *seconds: str, **environment: str) -> subprocess.Popen[bytes]:
        """Start a planner process in the middle of a performance."""
        arguments = [str(self.robot.path), str(self.folder), str(self.log), *seconds]
        command = [sys.executable, "-m", f"{__package__}.planner", *arguments]
        process = subprocess.Popen(command, env=os.environ | environment, cwd=ROOT)
        self._planners.append(process)

        def performs() -> float | None:
            assert process.poll() is None, f"the planner ended with {process.returncode} before it performed"
            return self.entered(Stage.ACTIVE)

        self.wait(performs)
        return process

    def supervisor(self) -> Channel:
        """Return the channel of the supervisor, even after its end."""
        channel = find_supervisor(self.ports["left"], JOINTS)
        assert channel is not None
        return channel

    def freeze(self, servos: Servos) -> float:
        """Suspend the supervisor in its performance, and return the time [s].

        Bus watchdogs are active then.
        """
        while True:
            self.moving(servos)
            frozen = time.monotonic()
            os.kill(servos.pid, signal.SIGSTOP)
            time.sleep(TRANSFER_TIME)
            if self.record().watchdogs[-1].all() and servos.state().stage is Stage.ACTIVE:
                return frozen
            os.kill(servos.pid, signal.SIGCONT)

    def strike(self, line: str) -> None:
        self._table.in_order = self._table.in_order and not line.startswith("alert")  # which only a reboot ends
        self._table.tell(line)

    def record(self) -> Record:
        """Return the recorded motion of the servos in this test."""
        return self._table.record(self._began)

    def ends_at_rest(self) -> None:
        """Assert that the arms end at rest without torque."""
        record, manifest = self.record(), Manifest.of(self.robot)
        rest = manifest.scale.ticks(manifest.rest[manifest.joints])
        last_events = "\n".join(text for _, _, text in self.events()[-20:])
        assert not record.torque[-1].any(), last_events
        assert np.abs(record.places[-1] - rest).max() <= MAX_REST_DISTANCE, f"{record.places[-1] - rest}\n{last_events}"

    def events(self) -> list[tuple[float, str, str]]:
        lines = [json.loads(line) for line in self.log.read_text().splitlines()] if self.log.exists() else []
        return [(line["time"], line["kind"], line["text"]) for line in lines]

    def entered(self, stage: Stage, after: float = 0.0) -> float | None:
        """Return when a stage was first entered after a time [s]."""
        for moment, kind, text in self.events():
            if kind == "stage" and moment >= after and f"-> {stage.value} " in text:
                return moment
        return None

    def end(self) -> None:
        """Kill the processes that a failed test left running.

        Its table is then not in order any more.
        """
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
    """Return the previous test's virtual servos if intact, or new servos."""
    made: list[Table] = []

    def table() -> Table:
        if made and not made[-1].in_order:
            made.pop().close()
        if not made:
            made.append(Table(robot, tmp_path_factory.mktemp("table")))
        return made[-1]

    yield table
    for item in made:
        item.close()


@pytest.fixture
def rig(robot: Robot, tables: Callable[[], Table], tmp_path: Path) -> Iterator[Rig]:
    table = tables()
    made = Rig(robot, table, tmp_path)
    yield made
    made.end()
    table.in_order = table.in_order and not made.record().torque[-1].any()
