"""Assignment of test files to processes, by kind and size.

`make test` starts two processes more than there are processors. Realtime tests wait for three quarters of their time,
so they run in these two processes; the others calculate at a lower priority, except on a machine that is busy at the
start, where low priority would stall the run. Files with pages share one process, which starts the browser once. A
process stays in a package as long as it has files: they share servers, caches and imported modules. Otherwise large
files come first. A process can only run files that it has imported (`tests/partition.py`). It runs files that several
calculating processes have imported after its other files, so that all processes end together.
"""

import os
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
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


def choose_file(
    files: Collection[str],
    worker: str,
    root: Path,
    packages: Mapping[str, str],
    shared: Collection[str] = frozenset(),
) -> str:
    """Return the next file for a process.

    It has the kind that the process prefers. Shared files come after the others. Among these, files of its last package
    come first, those of other processes last.

    Args:
        files: files that remain, the largest first.
        worker: name of the process.
        root: root folder of the project.
        packages: last package of each process.
        shared: files that several calculating processes can run.
    """
    order, last = FILE_ORDER.get(worker, OTHER_ORDER), packages.get(worker)
    kind = next(kind for kind in order if any(kind_of(file, root) == kind for file in files))
    taken = {package for other, package in packages.items() if other != worker}
    return min(
        (file for file in files if kind_of(file, root) == kind),
        key=lambda file: (file in shared, package_of(file) != last, package_of(file) in taken),
    )


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
        self._shared: frozenset[str] = frozenset()  # files that several calculating processes have collected

    def add_node_collection(self, node: WorkerController, collection: Sequence[str]) -> None:
        super().add_node_collection(node, collection)
        self.registered_collections[node] = IndexedTests(collection)
        self._files[node] = {self._split_scope(name) for name in collection}

    def schedule(self) -> None:
        """Distribute the tests of all processes, the largest files first."""
        if self.collection is not None:
            super().schedule()
        elif self._check_nodes_have_same_collection():
            files = self._merge_files()
            self.collection = [name for names in files.values() for name in names]
            self.workqueue.update({file: dict.fromkeys(names, False) for file, names in files.items()})
            self.config.pluginmanager.get_plugin("dsession")._session.testscollected = len(self.collection)
            calculating = [files for node, files in self._files.items() if node.gateway.id not in CLOCK_WORKERS]
            counts = Counter(file for files in calculating for file in files)
            self._shared = frozenset(file for file, count in counts.items() if count > 1)
            for node in [*self.nodes, *self.nodes]:  # twice, because a process must know the test after the current one
                self._reschedule(node)

    def mark_test_complete(self, node: WorkerController, item_index: int, duration: float = 0) -> None:
        """Record a completed test, and forget files without pending tests, which xdist would count after each test."""
        super().mark_test_complete(node, item_index, duration)
        file, work = self._split_scope(self.registered_collections[node][item_index]), self.assigned_work[node]
        if all(work.get(file, {"": False}).values()):
            del work[file]

    def _merge_files(self) -> dict[str, Sequence[str]]:
        """Return the tests of all files, the largest file first, as a process collects them that collects all."""
        files: dict[str, dict[str, None]] = {}
        for names in self.registered_collections.values():
            files = self._split_files(names) | files
        root = Path(self.config.rootpath)
        return {file: list(files[file]) for file in sorted(files, key=lambda file: rank(root / file, root))}

    def _split_files(self, names: Iterable[str]) -> dict[str, dict[str, None]]:
        """Return the tests of each file, in their order."""
        files: dict[str, dict[str, None]] = {}
        for name in names:
            files.setdefault(self._split_scope(name), {})[name] = None
        return files

    def _check_nodes_have_same_collection(self) -> bool:
        """Return whether all processes collected the same tests of each file, or report a file that differs."""
        first: dict[str, dict[str, None]] = {}
        for names in self.registered_collections.values():
            for file, tests in self._split_files(names).items():
                if first.setdefault(file, tests).keys() != tests.keys():
                    return self._report_difference(file)
        return True

    def _report_difference(self, file: str) -> bool:
        """Report a file whose tests differ between processes, and return False."""
        whole = self.registered_collections
        self.registered_collections = {
            node: [name for name in names if self._split_scope(name) == file]
            for node, names in whole.items()
            if file in self._files[node]
        }
        try:
            return super()._check_nodes_have_same_collection()
        finally:
            self.registered_collections = whole  # with fewer collections, xdist would wait for more of them for ever

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
            mine = choose_file(files, worker, Path(self.config.rootpath), self._packages, self._shared)
            self._packages[worker] = package_of(mine)
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
