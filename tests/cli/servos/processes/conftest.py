"""Commands in their own terminals, with virtual servos in another process."""

import fcntl
import os
import pty
import select
import shutil
import signal
import subprocess
import sys
import termios
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.hardware.supervisor.address import find_supervisor
from kinesic.hardware.supervisor.channel import Channel
from kinesic.hardware.supervisor.manifest import Manifest

SERVER_PROGRAM = Path(__file__).parents[3] / "hardware" / "supervisor" / "processes" / "served.py"
WAIT_TIMEOUT = 60.0  # [s] longest wait for a condition, sufficient on a loaded machine
POLL_PERIOD = 0.1  # [s] time between two checks of a condition
RECORD_PERIOD = 0.05  # [s] time between two lines of the record
REST_TOLERANCE = 10  # [ticks] largest distance from rest that counts as rest, less than 1 deg
RAISED_DISTANCE = 250  # [ticks] smallest distance from rest that counts as raised, more than 20 deg
RAISE_BML = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><gesture id="g" lexeme="offer" mode="RIGHT_HAND" '
    'start="0" stroke="1" strokeEnd="{0}" relax="{0}" end="{1}"/></bml>'
)


def wait(until: Callable[[], object], seconds: float = WAIT_TIMEOUT) -> None:
    deadline = time.monotonic() + seconds
    while not until():
        assert time.monotonic() < deadline, "condition not met in time"
        time.sleep(POLL_PERIOD)


@dataclass
class Record:
    """Recorded states of the servos over time."""

    times: np.ndarray  # (m,) [s]
    torque: np.ndarray  # (m, n) whether torque is on
    goals: np.ndarray  # (m, n) [ticks] goal positions
    places: np.ndarray  # (m, n) [ticks] measured positions


class Arms:
    """Virtual servos of a robot, which several tests use one after another."""

    def __init__(self, robot: Robot, folder: Path) -> None:
        manifest = Manifest.of(robot)
        self.folder, self.port, self._joints = folder, folder / "body", len(manifest.rest)
        self._order = np.argsort(np.argsort([member.id for member in manifest.members]))
        self._rest = manifest.scale.ticks(manifest.rest[manifest.joints])
        command = [sys.executable, str(SERVER_PROGRAM), str(robot.path), str(folder), str(RECORD_PERIOD)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        wait(self.port.exists)
        self._file = (folder / "record").open()
        self._rows: list[list[float]] = []
        self._begun = ""  # incomplete last line

    def discard_record(self) -> None:
        """Discard the record of earlier tests."""
        self.record()
        self._rows = []

    def record(self) -> Record:
        """Return the record of the servos since the test began."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(b"show\n")
        self._process.stdin.flush()
        assert self._process.stdout.readline() == b"shown\n"
        *lines, self._begun = (self._begun + self._file.read()).split("\n")
        self._rows += [[float(word) for word in line.split()] for line in lines]
        rows = np.array(self._rows)
        states = rows[:, 2:].reshape(len(rows), -1, 4)[:, self._order]
        return Record(rows[:, 0], states[:, :, 0], states[:, :, 1], states[:, :, 3])

    def distance_from_rest(self) -> int:
        """Return the largest distance of a servo from rest [ticks]."""
        return int(np.abs(self.record().places[-1] - self._rest).max())

    @property
    def is_home(self) -> bool:
        """Whether all servos are at rest with torque off."""
        record = self.record()
        return not record.torque[-1].any() and bool((np.abs(record.places[-1] - self._rest) <= REST_TOLERANCE).all())

    def supervisor(self) -> Channel:
        """Return the channel of the supervisor that drives the servos."""
        channel = find_supervisor(self.port, self._joints)
        assert channel is not None
        return channel

    def is_raised(self) -> bool:
        return self.distance_from_rest() > RAISED_DISTANCE

    def is_still(self, seconds: float) -> bool:
        """Return whether no servo moves for a duration [s]."""
        start = time.monotonic()
        time.sleep(seconds)
        record = self.record()
        return bool(np.ptp(record.places[record.times >= start], axis=0).max() <= 2)

    def close(self) -> None:
        self._process.communicate(timeout=WAIT_TIMEOUT)
        self._file.close()


@dataclass
class Command:
    """Process of `kinesic ...` in the foreground of a terminal."""

    folder: Path
    arguments: tuple[str, ...]
    environment: dict[str, str] = field(default_factory=dict)
    output: str = ""

    def __post_init__(self) -> None:
        self.temporary = Path(mkdtemp(prefix="kinesic-"))  # Sockets need a short path.
        self.mark = f"KINESIC_TEST={self.folder}"
        self._keys, terminal = pty.openpty()
        name, _, value = self.mark.partition("=")
        self.process = subprocess.Popen(
            [sys.executable, "-m", "kinesic", *self.arguments],
            stdin=terminal,
            stdout=terminal,
            stderr=terminal,
            cwd=self.folder,
            env={**os.environ, "TMPDIR": str(self.temporary), name: value, **self.environment},
            start_new_session=True,
            preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),  # noqa: PLW1509  # no threads here
        )
        os.close(terminal)

    def listen(self) -> str:
        """Return all output until now."""
        while self._keys >= 0 and select.select([self._keys], [], [], 0)[0]:
            try:
                self.output += os.read(self._keys, 65536).decode(errors="replace")
            except OSError:  # No process has the terminal open any more.
                break
        return self.output

    def wait(self, until: Callable[[], object]) -> None:
        """Wait until a condition holds, while the command runs."""

        def is_over() -> bool:
            self.listen()
            return bool(until()) or self.process.poll() is not None

        wait(is_over)
        assert self.process.poll() is None, self.output

    def press(self, keys: bytes) -> None:
        os.write(self._keys, keys)

    def close_terminal(self) -> None:
        """Close the terminal and send SIGHUP to the command's process group."""
        os.close(self._keys)
        self._keys = -1
        self.signal_all(signal.SIGHUP)

    def signal_all(self, number: signal.Signals) -> None:
        """Send a signal to the command and all processes of its group."""
        os.killpg(self.process.pid, number)

    def end(self) -> int:
        """Wait until the command has ended, and return its exit code."""
        wait(lambda: (self.listen(), self.process.poll())[1] is not None)
        self.listen()
        return self.process.returncode

    def processes(self, word: str = "") -> list[int]:
        """Return the ids of descendant processes whose command lines contain a word."""
        ids = []
        for process_folder in Path("/proc").glob("[0-9]*"):
            try:
                is_descendant = self.mark.encode() in (process_folder / "environ").read_bytes().split(b"\0")
                if is_descendant and word.encode() in (process_folder / "cmdline").read_bytes():
                    ids.append(int(process_folder.name))
            except OSError:
                continue
        return ids

    def supervisor(self) -> int:
        (process,) = self.processes("kinesic.hardware.supervisor")
        return process

    def has_cleaned_up(self) -> bool:
        """Wait for all processes to end, and return whether no files remain."""
        wait(lambda: not self.processes())
        return not list(self.temporary.iterdir())

    def close(self) -> None:
        for process in self.processes():
            os.kill(process, signal.SIGKILL)
        self.process.wait(WAIT_TIMEOUT)
        shutil.rmtree(self.temporary, ignore_errors=True)
        if self._keys >= 0:
            os.close(self._keys)


@pytest.fixture(scope="module")
def robot() -> Robot:
    """The robot whose servos are simulated."""
    return Robot.load()


@pytest.fixture(scope="module")
def served_arms(robot: Robot, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Arms]:
    arms_of_module = Arms(robot, tmp_path_factory.mktemp("arms"))
    yield arms_of_module
    arms_of_module.close()


@pytest.fixture
def arms(served_arms: Arms) -> Arms:
    served_arms.discard_record()
    return served_arms


@pytest.fixture
def run(tmp_path: Path) -> Iterator[Callable[..., Command]]:
    """Return a function that starts a command in an empty folder."""
    commands: list[Command] = []

    def start(*arguments: object, **environment: str) -> Command:
        commands.append(Command(tmp_path, tuple(map(str, arguments)), environment))
        return commands[-1]

    yield start
    for command in commands:
        command.close()


@pytest.fixture
def perform(robot: Robot, run: Callable[..., Command], arms: Arms, tmp_path: Path) -> Callable[..., Command]:
    """Return a function that starts a performance with a raised hand."""

    def start(until: float, **environment: str) -> Command:
        (tmp_path / "raise.bml").write_text(RAISE_BML.format(until, until + 1.0), encoding="utf-8")
        options = ("--robot", robot.path, "--on", "servos", "--port", f"body={arms.port}", "--no-film", "--out", "out")
        return run("perform", "raise.bml", *options, **environment)

    return start
