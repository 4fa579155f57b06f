"""Assignment of test files to processes: waiting tests run beside calculating ones.

`make test` starts two processes more than there are processors. Realtime tests wait for three quarters of their time,
so they run in these two processes; the others calculate at a lower priority, except on a machine that is busy at the
start, where low priority would stall the run. Large files come first, so that all processes end together.

Each process imports all tests. After a change, all would compile the same file at the same time, so each starts with
another file and finds compiled files of the others.
"""

import os
from functools import cache
from pathlib import Path

import pytest
from xdist.scheduler import LoadFileScheduling
from xdist.workermanage import WorkerController

CLOCK_WORKERS = ("gw0", "gw1")
SLOWEST_FILES = ("tests/serve/test_server.py", "tests/bench/bml/test_server.py")  # started first, in this order
CALCULATION_NICENESS = 5  # niceness of calculating processes
MAX_BUSY_PROCESSES = 3  # runnable processes per processor above which no process lowers its priority


@cache
def rank(file: Path, root: Path) -> tuple[int, int, str]:
    """Rank test files: longest known duration first, then by size."""
    name = file.relative_to(root).as_posix()
    return (SLOWEST_FILES.index(name) if name in SLOWEST_FILES else len(SLOWEST_FILES)), -file.stat().st_size, name


def begin_elsewhere(nodes: list, worker: str, count: int) -> list:
    """Rotate a list by another offset for each of several processes."""
    first = len(nodes) * int(worker.removeprefix("gw")) // count
    return nodes[first:] + nodes[:first]


@cache
def waits(file: Path) -> bool:
    """Return whether a file contains realtime tests."""
    return "mark.realtime" in file.read_text(encoding="utf-8")


class ClockBesideCalculation(LoadFileScheduling):
    """Scheduler that gives each process files of its kind first."""

    def _assign_work_unit(self, node: WorkerController) -> None:
        clock, root = node.gateway.id in CLOCK_WORKERS, Path(self.config.rootpath)
        mine = next((file for file in self.workqueue if waits(root / file) == clock), None)
        if mine is not None:
            self.workqueue.move_to_end(mine, last=False)
        super()._assign_work_unit(node)


def step_back(config: pytest.Config) -> None:
    """Lower the priority of a calculating process."""
    worker = getattr(config, "workerinput", {}).get("workerid", CLOCK_WORKERS[0])
    if worker not in CLOCK_WORKERS and wanting() < MAX_BUSY_PROCESSES * (os.cpu_count() or 1):
        os.nice(CALCULATION_NICENESS)


def wanting() -> float:
    """Return the number of runnable processes, currently or in the last minute."""
    loads = Path("/proc/loadavg")
    return float(loads.read_text().split()[3].split("/")[0]) if loads.exists() else os.getloadavg()[0]
