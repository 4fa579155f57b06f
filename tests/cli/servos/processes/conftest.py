"""Commands in terminals of their own, the default robot's virtual servos in another process, and what both did."""

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

SERVED = Path(__file__).parents[3] / "hardware" / "supervisor" / "processes" / "served.py"
PATIENCE = 60.0  # [s] that a loaded machine may take for anything
LOOK = 0.1  # [s] between two looks
EVERY = 0.05  # [s] between two lines of the record
NEAR = 10  # [ticks] of rest: less than a degree
RAISED = 250  # [ticks] more than 20 degrees
RAISE = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><gesture id="g" lexeme="offer" mode="RIGHT_HAND" '
    'start="0" stroke="1" strokeEnd="{0}" relax="{0}" end="{1}"/></bml>'
)


def wait(until: Callable[[], object], seconds: float = PATIENCE) -> None:
    limit = time.monotonic() + seconds
    while not until():
        assert time.monotonic() < limit, "waited in vain"
        time.sleep(LOOK)


@dataclass
class Record:
    """What the servos did, and when."""

    times: np.ndarray  # (m,) [s]
    torque: np.ndarray  # (m, n)
    goals: np.ndarray  # (m, n) [ticks]
    places: np.ndarray  # (m, n) [ticks]


class Arms:
    """The default robot's virtual servos, one after another test."""

    def __init__(self, folder: Path) -> None:
        robot = Robot.load()
        manifest = Manifest.of(robot)
        self.folder, self.port, self._joints = folder, folder / "body", len(manifest.rest)
        self._order = np.argsort(np.argsort([member.id for member in manifest.members]))
        self._rest = manifest.scale.ticks(manifest.rest[manifest.joints])
        command = [sys.executable, str(SERVED), str(robot.path), str(folder), str(EVERY)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        wait(self.port.exists)
        self._file = (folder / "record").open()
        self._rows: list[list[float]] = []
        self._begun = ""  # what there is of a line that is still being written

    def forget(self) -> None:
        """Another test begins."""
        self.record()
        self._rows = []

    def record(self) -> Record:
        """What they have done in this test until now."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(b"show\n")
        self._process.stdin.flush()
        assert self._process.stdout.readline() == b"shown\n"
        *lines, self._begun = (self._begun + self._file.read()).split("\n")
        self._rows += [[float(word) for word in line.split()] for line in lines]
        rows = np.array(self._rows)
        shown = rows[:, 2:].reshape(len(rows), -1, 4)[:, self._order]
        return Record(rows[:, 0], shown[:, :, 0], shown[:, :, 1], shown[:, :, 3])

    def away(self) -> int:
        """[ticks] how far the farthest is from rest."""
        return int(np.abs(self.record().places[-1] - self._rest).max())

    @property
    def home(self) -> bool:
        """Whether all are at rest and limp."""
        record = self.record()
        return not record.torque[-1].any() and bool((np.abs(record.places[-1] - self._rest) <= NEAR).all())

    def supervisor(self) -> Channel:
        """What somebody sees who looks on."""
        found = find_supervisor(self.port, self._joints)
        assert found is not None
        return found

    def raised(self) -> bool:
        return self.away() > RAISED

    def still(self, seconds: float) -> bool:
        """Whether nothing moves for a while."""
        began = time.monotonic()
        time.sleep(seconds)
        record = self.record()
        return bool(np.ptp(record.places[record.times >= began], axis=0).max() <= 2)

    def close(self) -> None:
        self._process.communicate(timeout=PATIENCE)
        self._file.close()


@dataclass
class Command:
    """`kinesic ...` as a shell runs it in the foreground of a terminal, with places of its own for temporary files."""

    folder: Path
    arguments: tuple[str, ...]
    environment: dict[str, str] = field(default_factory=dict)
    said: str = ""

    def __post_init__(self) -> None:
        self.temporary = Path(mkdtemp(prefix="kinesic-"))  # sockets need a short path
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
        """What it has said so far."""
        while self._keys >= 0 and select.select([self._keys], [], [], 0)[0]:
            try:
                self.said += os.read(self._keys, 65536).decode(errors="replace")
            except OSError:  # nobody has the terminal any more
                break
        return self.said

    def wait(self, until: Callable[[], object]) -> None:
        """Waits until something is so, while it lives."""

        def seen() -> bool:
            self.listen()
            return bool(until()) or self.process.poll() is not None

        wait(seen)
        assert self.process.poll() is None, self.said

    def press(self, keys: bytes) -> None:
        os.write(self._keys, keys)

    def close_terminal(self) -> None:
        """The window is closed: the kernel says so to the shell, here to the command, and the shell to its group."""
        os.close(self._keys)
        self._keys = -1
        self.signal_all(signal.SIGHUP)

    def signal_all(self, number: signal.Signals) -> None:
        """To the command and all that it has begun in its group."""
        os.killpg(self.process.pid, number)

    def end(self) -> int:
        """Its exit code, when it has ended."""
        wait(lambda: (self.listen(), self.process.poll())[1] is not None)
        self.listen()
        return self.process.returncode

    def processes(self, word: str = "") -> list[int]:
        """Ids of all processes that it, or who it has begun, has begun; with a word in their command lines."""
        found = []
        for place in Path("/proc").glob("[0-9]*"):
            try:
                marked = self.mark.encode() in (place / "environ").read_bytes().split(b"\0")
                if marked and word.encode() in (place / "cmdline").read_bytes():
                    found.append(int(place.name))
            except OSError:
                continue
        return found

    def supervisor(self) -> int:
        (found,) = self.processes("kinesic.hardware.supervisor")
        return found

    def leaves_nothing(self) -> bool:
        """Whether no process and no temporary file is left; processes may still be ending."""
        wait(lambda: not self.processes())
        return not list(self.temporary.iterdir())

    def close(self) -> None:
        for process in self.processes():
            os.kill(process, signal.SIGKILL)
        self.process.wait(PATIENCE)
        shutil.rmtree(self.temporary, ignore_errors=True)
        if self._keys >= 0:
            os.close(self._keys)


@pytest.fixture(scope="module")
def served_arms(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Arms]:
    made = Arms(tmp_path_factory.mktemp("arms"))
    yield made
    made.close()


@pytest.fixture
def arms(served_arms: Arms) -> Arms:
    served_arms.forget()
    return served_arms


@pytest.fixture
def run(tmp_path: Path) -> Iterator[Callable[..., Command]]:
    """Starts a command in an empty folder."""
    begun: list[Command] = []

    def start(*arguments: object, **environment: str) -> Command:
        begun.append(Command(tmp_path, tuple(map(str, arguments)), environment))
        return begun[-1]

    yield start
    for command in begun:
        command.close()


@pytest.fixture
def perform(run: Callable[..., Command], arms: Arms, tmp_path: Path) -> Callable[..., Command]:
    """Starts a performance that raises the right hand, and holds it until a time [s]."""

    def start(until: float, **environment: str) -> Command:
        (tmp_path / "raise.bml").write_text(RAISE.format(until, until + 1.0), encoding="utf-8")
        options = ("--on", "servos", "--port", f"body={arms.port}", "--no-film", "--out", "out")
        return run("perform", "raise.bml", *options, **environment)

    return start
