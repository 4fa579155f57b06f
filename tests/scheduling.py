"""Which process runs which file of tests: what waits for a clock runs beside what calculates.

`make test` starts two processes more than there are processors. Three quarters of what tests in real time take is
waiting, so they get these two while there are any; the others calculate, and step back where both want a processor.
They do not where others calculate too when the tests begin: they would step back behind these as well, and a run would
hardly go on. Large files come first, so that all processes end together.

Every process reads all tests. After a change each would compile the same file at the same moment: so each begins
elsewhere, and finds compiled what the others have read.
"""

import os
from functools import cache
from pathlib import Path

import pytest
from xdist.scheduler import LoadFileScheduling
from xdist.workermanage import WorkerController

CLOCK_WORKERS = ("gw0", "gw1")
LONGEST = ("tests/serve/test_server.py", "tests/bench/bml/test_server.py")  # to wait for, in order
STEP_BACK = 5  # of niceness
CROWD = 3  # processes for each processor that want to calculate, from which on nobody steps back


@cache
def rank(file: Path, root: Path) -> tuple[int, int, str]:
    """Ranks files of tests, the one to begin first lowest: the longest by their times, the others by their sizes."""
    name = file.relative_to(root).as_posix()
    return (LONGEST.index(name) if name in LONGEST else len(LONGEST)), -file.stat().st_size, name


def begin_elsewhere(nodes: list, worker: str, count: int) -> list:
    """Turns what is to be read round, for each of so many processes by another share."""
    first = len(nodes) * int(worker.removeprefix("gw")) // count
    return nodes[first:] + nodes[:first]


@cache
def waits(file: Path) -> bool:
    """Whether a file has tests in real time."""
    return "mark.realtime" in file.read_text(encoding="utf-8")


class ClockBesideCalculation(LoadFileScheduling):
    """Files in order, each process those of its kind first."""

    def _assign_work_unit(self, node: WorkerController) -> None:
        clock, root = node.gateway.id in CLOCK_WORKERS, Path(self.config.rootpath)
        mine = next((file for file in self.workqueue if waits(root / file) == clock), None)
        if mine is not None:
            self.workqueue.move_to_end(mine, last=False)
        super()._assign_work_unit(node)


def step_back(config: pytest.Config) -> None:
    """Lets a process that calculates give way to those that keep time."""
    worker = getattr(config, "workerinput", {}).get("workerid", CLOCK_WORKERS[0])
    if worker not in CLOCK_WORKERS and wanting() < CROWD * (os.cpu_count() or 1):
        os.nice(STEP_BACK)


def wanting() -> float:
    """How many processes want to calculate, just now where the system says that, else in the last minute."""
    loads = Path("/proc/loadavg")
    return float(loads.read_text().split()[3].split("/")[0]) if loads.exists() else os.getloadavg()[0]
