"""Dry runs with workers killed at random, and counts of lost documents."""

import os
import random
import resource
import signal
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from threading import Event, Thread
from time import monotonic, process_time

from kinesic.planning.setup import Setup
from kinesic.report.batch import validate_documents
from kinesic.session.setup import set_up
from kinesic.tasks.engine import Engine
from kinesic.tasks.store import JOURNAL_FILE

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>\n'
NOD = '<head id="h" lexeme="NOD" start="{:.4f}" end="0.9"/>'
BEAT = '<gesture id="g" lexeme="beat" stroke="{:.4f}"/>'
KILL_JITTER = 0.5  # largest deviation of a kill from its planned time / time between two kills
REPORT_PERIOD = 30.0  # [s] time between two lines of progress


@dataclass(frozen=True)
class Outcome:
    """Outcome of all documents after workers were killed."""

    documents: int
    lost: int
    doubled: int
    crashed: int
    kills: int
    begun: int  # number of workers that were ready to work
    seconds: float
    cpu: float  # [s] processor time of the calling process
    memory: float  # [MB] peak memory of the calling process

    @property
    def is_good(self) -> bool:
        """Return whether each document was done exactly once."""
        return not (self.lost or self.doubled or self.crashed)

    def __str__(self) -> str:
        return (
            f"{self.documents} documents, {self.lost} lost, {self.doubled} doubled, {self.crashed} called a crash; "
            f"{self.kills} kills, {self.begun} workers begun; {self.seconds:.0f} s, of who called {self.cpu:.0f} s "
            f"of CPU and {self.memory:.0f} MB"
        )


def write_documents(folder: Path, count: int) -> list[Path]:
    """Write different short documents: seven nods per beat."""
    files = [folder / f"{number:06}.bml" for number in range(count)]
    for number, file in enumerate(files):
        shift = 1e-4 * (number % 1000)
        file.write_text(BLOCK.format(BEAT.format(0.5 + shift) if number % 8 == 7 else NOD.format(0.1 + shift)))
    return files


def perform_under_fire(
    engine: Engine,
    count: int,
    every: float,
    folder: Path,
    *,
    seed: int = 0,
    tell: Callable[[str], None] = lambda line: None,
) -> Outcome:
    """Dry-run documents while random workers are killed at intervals.

    Args:
        engine: its workers are processes of this machine.
        count: of documents.
        every: [s] between two kills.
        folder: an empty one.
        seed: of who is killed, and when.
        tell: gets a line now and then.
    """
    for name in ("documents", "reports", "workers"):
        (folder / name).mkdir()
    files = write_documents(folder / "documents", count)
    began, seen, crashed, result = monotonic(), Counter[str](), 0, 0.0
    with _kills(folder / "workers", every, random.Random(seed)) as kills:
        made = partial(_noted, folder / "workers")
        for verdict in validate_documents(files, made, engine=engine, folder=folder / "reports"):
            seen[verdict.file] += 1
            if verdict.outcome != "performed":
                crashed += 1
                tell(f"{verdict.outcome} {verdict.error}")
            if monotonic() - began > result + REPORT_PERIOD:
                result = monotonic() - began
                tell(f"{result:.0f} s: {len(seen)} of {count}, {len(kills)} kills")
    lines = Counter((folder / "reports" / JOURNAL_FILE).read_bytes().splitlines())
    reports = sum(1 for path in (folder / "reports").glob("*.json"))
    return Outcome(
        documents=count,
        lost=count - min(len(seen), len(lines) + crashed, reports + crashed),
        doubled=sum(seen.values()) - len(seen) + sum(lines.values()) - len(lines),
        crashed=crashed,
        kills=len(kills),
        begun=sum(1 for _ in (folder / "workers").iterdir()),
        seconds=monotonic() - began,
        cpu=process_time(),
        memory=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    )


def _noted(folder: Path) -> Setup:
    """Prepare a worker, and record its process id."""
    (folder / f"{os.getpid()} {_age(os.getpid())}").touch()
    return set_up()


def _age(pid: int) -> str:
    """Return the start time of a process, or None if it ended."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[19]
    except (FileNotFoundError, ProcessLookupError):
        return ""


@contextmanager
def _kills(folder: Path, every: float, chance: random.Random) -> Iterator[list[int]]:
    """Kill a worker at intervals, and record each kill."""
    killed: list[int] = []
    over = Event()

    def kill() -> None:
        while not over.wait(every * chance.uniform(1.0 - KILL_JITTER, 1.0 + KILL_JITTER)):
            notes = [note.name.split() for note in sorted(folder.iterdir())]
            alive = [int(pid) for pid, age in notes if _age(int(pid)) == age]
            if alive:
                killed.append(chance.choice(alive))
                os.kill(killed[-1], signal.SIGKILL)

    killer = Thread(target=kill)
    killer.start()
    try:
        yield killed
    finally:
        over.set()
        killer.join()
