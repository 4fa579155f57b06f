"""Assignment of test files to processes: waiting tests run beside calculating ones.

`make test` starts two processes more than there are processors. Realtime tests wait for three quarters of their time,
so they run in these two processes; the others calculate at a lower priority, except on a machine that is busy at the
start, where low priority would stall the run. Files with pages share one process, which starts the browser once. Files
of a folder that share a server run in succession, so that it starts once. Otherwise large files come first, so that all
processes end together.

Each process imports all tests. After a change, all would compile the same file at the same time, so each starts with
another file and finds compiled files of the others.
"""

import os
from collections.abc import Collection
from functools import cache
from pathlib import Path
from typing import Literal

import pytest
from xdist.scheduler import LoadFileScheduling
from xdist.workermanage import WorkerController

Kind = Literal["page", "clock", "calculation"]

CLOCK_WORKERS = ("gw0", "gw1")
FILE_ORDER: dict[str, tuple[Kind, ...]] = {  # kinds of files that a process prefers, the first most
    "gw0": ("page", "clock", "calculation"),
    "gw1": ("clock", "calculation", "page"),
}
OTHER_ORDER: tuple[Kind, ...] = ("calculation", "clock", "page")  # of all other processes
STUDIO_FOLDER = "tests/studio/"
SERVER_FOLDERS = (STUDIO_FOLDER, "tests/serve/")  # folders whose tests share a server while they run in succession
CALCULATION_NICENESS = 5  # niceness of calculating processes
MAX_BUSY_PROCESSES = 3  # runnable processes per processor above which no process lowers its priority


@cache
def rank(file: Path, root: Path) -> tuple[int, int, str]:
    """Rank test files: folders that share a server first, then by size."""
    name = file.relative_to(root).as_posix()
    folders = (number for number, folder in enumerate(SERVER_FOLDERS) if name.startswith(folder))
    return next(folders, len(SERVER_FOLDERS)), -file.stat().st_size, name


def begin_elsewhere(nodes: list, worker: str, count: int) -> list:
    """Rotate a list by another offset for each of several processes."""
    first = len(nodes) * int(worker.removeprefix("gw")) // count
    return nodes[first:] + nodes[:first]


@cache
def kind_of(file: str, root: Path) -> Kind:
    """Return whether tests of a file show pages in a browser, are realtime tests, or calculate."""
    text = (root / file).read_text(encoding="utf-8")
    if "chromium import" in text or file.startswith(STUDIO_FOLDER):
        return "page"
    return "clock" if "mark.realtime" in text else "calculation"


def choose_file(files: Collection[str], worker: str, root: Path) -> str:
    """Return the first file of the kind that a process prefers."""
    order = FILE_ORDER.get(worker, OTHER_ORDER)
    return next(file for kind in order for file in files if kind_of(file, root) == kind)


class ClockBesideCalculation(LoadFileScheduling):
    """Scheduler that gives each process files of its kind first."""

    def _assign_work_unit(self, node: WorkerController) -> None:
        if self.workqueue:
            mine = choose_file(self.workqueue, node.gateway.id, Path(self.config.rootpath))
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
