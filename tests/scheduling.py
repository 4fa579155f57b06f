"""Assignment of test files to processes, by kind and size.

`make test` starts two processes more than there are processors. Realtime tests wait for three quarters of their time,
so they run in these two processes; the others calculate at a lower priority, except on a machine that is busy at the
start, where low priority would stall the run. Files with pages share one process, which starts the browser once. A
process stays in a package as long as it has files: they share servers, caches and imported modules. Otherwise large
files come first, so that all processes end together.

Importing all tests takes ten seconds of a processor. In a run of the whole suite, the processes for waiting tests
import only these, and end when none are left. After a change, all processes would compile the same file at the same
time, so each starts with another file and finds compiled files of the others.
"""

import os
from collections.abc import Collection, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Literal

import pytest
from xdist.remote import Producer
from xdist.scheduler import LoadFileScheduling
from xdist.workermanage import WorkerController

Kind = Literal["page", "clock", "calculation"]

CLOCK_WORKERS = ("gw0", "gw1")
FILE_ORDER: dict[str, tuple[Kind, ...]] = {  # kinds of files that a test process takes, the preferred kind first
    "gw0": ("page", "clock", "calculation"),
    "gw1": ("clock", "calculation", "page"),
}
OTHER_ORDER: tuple[Kind, ...] = (
    "calculation",
    "clock",
    "page",
)  # kinds of files that all other test processes take, the preferred kind first
STUDIO_FOLDER = "tests/studio/"  # folder whose tests open browser pages in a fixture
CALCULATION_NICENESS = 5  # niceness of calculating processes
MAX_BUSY_PROCESSES = 3  # runnable processes per processor above which no process lowers its priority


@cache
def rank(file: Path, root: Path) -> tuple[int, str]:
    """Rank test files by size, the largest first."""
    return -file.stat().st_size, file.relative_to(root).as_posix()


def begin_elsewhere(nodes: list, worker: str, count: int) -> list:
    """Rotate a list by a different offset for each of several processes."""
    first = len(nodes) * int(worker.removeprefix("gw")) // count
    return nodes[first:] + nodes[:first]


@cache
def kind_of(file: str, root: Path) -> Kind:
    """Return whether tests of a file show pages in a browser, are realtime tests, or calculate."""
    text = (root / file).read_text(encoding="utf-8")
    if "chromium import" in text or file.startswith(STUDIO_FOLDER):
        return "page"
    return "clock" if "mark.realtime" in text else "calculation"


@cache
def package_of(file: str) -> str:
    """Return the folder below `tests` that contains a test file, or the file itself."""
    return "/".join(file.split("/")[:2])


def choose_file(files: Collection[str], worker: str, root: Path, packages: Mapping[str, str]) -> str:
    """Return the next file for a process.

    It has the kind that the process prefers. Files of its last package come first, those of other processes last.

    Args:
        files: files that remain, the largest first.
        worker: name of the process.
        root: root folder of the project.
        packages: last package of each process.
    """
    order, last = FILE_ORDER.get(worker, OTHER_ORDER), packages.get(worker)
    kind = next(kind for kind in order if any(kind_of(file, root) == kind for file in files))
    taken = {package for other, package in packages.items() if other != worker}
    return min(
        (file for file in files if kind_of(file, root) == kind),
        key=lambda file: (package_of(file) != last, package_of(file) in taken),
    )


def runs_only_waiting_tests(config: pytest.Config, worker: str, count: int) -> bool:
    """Return whether a process collects only waiting tests, in a run of the whole suite.

    Args:
        config: configuration of the process that starts the others.
        worker: name of the process.
        count: number of processes.
    """
    is_whole_suite = config.args_source is pytest.Config.ArgsSource.TESTPATHS
    return is_whole_suite and worker in CLOCK_WORKERS and count > len(CLOCK_WORKERS)


def is_calculation(path: Path, root: Path) -> bool:
    """Return whether a path is a file of tests that neither wait nor show pages."""
    is_test = path.name.startswith("test_") and path.suffix == ".py"
    return is_test and kind_of(path.relative_to(root).as_posix(), root) == "calculation"


class IndexedTests(list[str]):
    """List of collected tests that finds positions without a search."""

    def __init__(self, names: Sequence[str]) -> None:
        super().__init__(names)
        self._positions = {name: position for position, name in enumerate(names)}

    def index(self, name: str, *_range: int) -> int:
        return self._positions[name]


class ClockBesideCalculation(LoadFileScheduling):
    """Scheduler that gives each process files of its kind and package first."""

    def __init__(self, config: pytest.Config, log: Producer) -> None:
        super().__init__(config, log)
        self._packages: dict[str, str] = {}  # last package of each process
        self._files: dict[WorkerController, set[str]] = {}  # files that each process has collected

    def add_node_collection(self, node: WorkerController, collection: Sequence[str]) -> None:
        super().add_node_collection(node, collection)
        self.registered_collections[node] = IndexedTests(collection)
        self._files[node] = {self._split_scope(name) for name in collection}

    def schedule(self) -> None:
        """Distribute the tests of the process that has collected most."""
        if self.collection is None:
            by_size = sorted(self.registered_collections.items(), key=lambda entry: -len(entry[1]))
            self.registered_collections = dict(by_size)
            session = self.config.pluginmanager.get_plugin("dsession")
            session._session.testscollected = len(by_size[0][1])
        super().schedule()

    def _check_nodes_have_same_collection(self) -> bool:
        names = {node.gateway.id: tests for node, tests in self.registered_collections.items()}
        return is_consistent(names) or super()._check_nodes_have_same_collection()

    def _remaining(self, node: WorkerController) -> list[str]:
        """Return the queued test files that a process has collected."""
        return [file for file in self.workqueue if file in self._files[node]]

    def _reschedule(self, node: WorkerController) -> None:
        if self._remaining(node):
            super()._reschedule(node)
        elif not node.shutting_down:
            node.shutdown()

    def _assign_work_unit(self, node: WorkerController) -> None:
        if files := self._remaining(node):
            worker = node.gateway.id
            mine = choose_file(files, worker, Path(self.config.rootpath), self._packages)
            self._packages[worker] = package_of(mine)
            self.workqueue.move_to_end(mine, last=False)
            super()._assign_work_unit(node)


def is_consistent(collections: Mapping[str, Sequence[str]]) -> bool:
    """Return whether calculating processes collected equal tests, and others subsets.

    Args:
        collections: tests of each process, by its name.
    """
    whole = [tests for worker, tests in collections.items() if worker not in CLOCK_WORKERS]
    return bool(whole) and all(
        tests == whole[0] if worker not in CLOCK_WORKERS else set(tests) <= set(whole[0])
        for worker, tests in collections.items()
    )


def step_back(config: pytest.Config) -> None:
    """Lower the priority of a calculating process."""
    worker = getattr(config, "workerinput", {}).get("workerid", CLOCK_WORKERS[0])
    if worker not in CLOCK_WORKERS and wanting() < MAX_BUSY_PROCESSES * (os.cpu_count() or 1):
        os.nice(CALCULATION_NICENESS)


def wanting() -> float:
    """Return the number of runnable processes, currently or in the last minute."""
    loads = Path("/proc/loadavg")
    return float(loads.read_text().split()[3].split("/")[0]) if loads.exists() else os.getloadavg()[0]
