"""Order of test files in each process."""

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace

import pytest
from xdist.remote import Producer

from .scheduling import (
    ClockBesideCalculation,
    IndexedTests,
    begin_elsewhere,
    choose_file,
    kind_of,
    package_of,
    rank,
)


def test_test_processes_collect_the_same_files_beginning_at_different_positions():
    nodes = list(range(10))
    turned = [begin_elsewhere(nodes, f"gw{k}", 3) for k in range(3)]
    assert all(sorted(own) == nodes for own in turned)
    assert [own[0] for own in turned] == [0, 3, 6]


def test_test_files_are_ranked_by_size_and_then_by_name(tmp_path: Path):
    files = [tmp_path / name for name in ("test_b.py", "test_a.py", "test_large.py")]
    for file, size in zip(files, (3, 3, 9), strict=True):
        file.write_text("#" * size)
    results = sorted(files, key=lambda file: rank(file, tmp_path))
    assert [file.name for file in results] == ["test_large.py", "test_a.py", "test_b.py"]


FILE_TEXTS = {  # test files by size, the largest first
    "tests/sum/test_large.py": "",
    "tests/clock/test_tick.py": "pytest.mark.realtime",
    "tests/page/test_page.py": "from ..chromium import opened",
    "tests/studio/test_words.py": "",
    "tests/sum/test_small.py": "",
    "tests/face/test_eyes.py": "",
}


@pytest.fixture
def root(tmp_path: Path) -> Path:
    for size, (name, text) in enumerate(reversed(FILE_TEXTS.items()), 1):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text.ljust(40 * size))
    return tmp_path


def test_browser_tests_and_realtime_tests_each_have_a_process_beside_calculations(root: Path):
    chosen = {worker: choose_file(FILE_TEXTS, worker, root, {}) for worker in ("gw0", "gw1", "gw2")}
    assert chosen == {
        "gw0": "tests/page/test_page.py",
        "gw1": "tests/clock/test_tick.py",
        "gw2": "tests/sum/test_large.py",
    }
    pages = [name for name in FILE_TEXTS if "test_page" in name or "test_tick" in name]
    assert choose_file(pages, "gw2", root, {}) == "tests/clock/test_tick.py"
    assert choose_file(pages[1:], "gw2", root, {}) == "tests/page/test_page.py"


def test_test_process_stays_in_one_package_while_files_of_its_kind_remain(root: Path):
    assert choose_file(FILE_TEXTS, "gw2", root, {"gw2": "tests/face"}) == "tests/face/test_eyes.py"
    assert choose_file(FILE_TEXTS, "gw0", root, {"gw0": "tests/studio"}) == "tests/studio/test_words.py"
    assert choose_file(FILE_TEXTS, "gw0", root, {"gw0": "tests/sum"}) == "tests/page/test_page.py"


def test_test_process_takes_packages_begun_by_other_processes_last(root: Path):
    assert choose_file(FILE_TEXTS, "gw2", root, {"gw3": "tests/sum"}) == "tests/face/test_eyes.py"
    assert choose_file(list(FILE_TEXTS)[:4], "gw2", root, {"gw3": "tests/sum"}) == "tests/sum/test_large.py"


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="the system does not list threads")
def test_child_processes_of_tests_use_one_thread_for_linear_algebra():
    if os.environ["OPENBLAS_NUM_THREADS"] != "1":
        pytest.skip("the caller has set OPENBLAS_NUM_THREADS")
    code = "import os, numpy; print(len(os.listdir('/proc/self/task')))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, check=True).stdout == b"1\n"


def test_package_of_a_test_is_its_folder_below_tests_or_its_file():
    assert package_of("tests/face/render/test_shadow.py") == "tests/face"
    assert package_of("tests/test_lock.py") == "tests/test_lock.py"


def test_index_list_of_the_test_scheduler_gives_the_same_positions_as_a_plain_list():
    names = ["b", "a", "c"]
    assert [IndexedTests(names).index(name) for name in names] == [0, 1, 2]
    assert IndexedTests(names) == names


class StubNode:
    """Stub test process that records the tests sent to it."""

    def __init__(self, worker: str) -> None:
        self.gateway = SimpleNamespace(id=worker)
        self.shutting_down = False
        self.sent: list[int] = []

    def shutdown(self) -> None:
        self.shutting_down = True

    def send_runtest_some(self, indices: Sequence[int]) -> None:
        self.sent += indices


def start_scheduler(
    root: Path, collections: Mapping[str, list[str]], *, count: int | None = None
) -> tuple[ClockBesideCalculation, dict]:
    """Return a scheduler that has distributed the first files, and its processes by name."""
    session = SimpleNamespace(testscollected=0)
    config = SimpleNamespace(
        rootpath=root,
        option=SimpleNamespace(loadscopereorder=False),
        getvalue={"tx": [f"{len(collections)}*popen"]}.get,
        pluginmanager=SimpleNamespace(get_plugin={"dsession": SimpleNamespace(_session=session)}.get),
        hook=SimpleNamespace(pytest_collectreport=lambda report: pytest.fail(report.longrepr)),
    )
    scheduler = ClockBesideCalculation(config, Producer("scheduler", enabled=False))
    nodes = {worker: StubNode(worker) for worker in collections}
    for worker, tests in collections.items():
        scheduler.add_node(nodes[worker])
        scheduler.add_node_collection(nodes[worker], tests)
    scheduler.schedule()
    names = {name for tests in collections.values() for name in tests}
    assert session.testscollected == (len(names) if count is None else count)
    return scheduler, nodes


def finish_sent_tests(scheduler: ClockBesideCalculation, node: StubNode) -> list[str]:
    """Finish all tests sent to a process, and return their files."""
    done = []
    while len(done) < len(node.sent):
        index = node.sent[len(done)]
        done.append(scheduler.registered_collections[node][index].split("::")[0])
        scheduler.mark_test_complete(node, index)
    return done


def test_process_for_realtime_tests_ends_after_its_last_file_while_other_processes_continue(root: Path):
    tests = [f"{file}::test_{k}" for file in FILE_TEXTS for k in range(3)]
    waiting = [name for name in tests if kind_of(name.split("::")[0], root) != "calculation"]
    scheduler, nodes = start_scheduler(root, {"gw0": waiting, "gw1": waiting, "gw2": tests})
    taken = {worker: finish_sent_tests(scheduler, nodes[worker]) for worker in ("gw0", "gw1")}
    assert {file for files in taken.values() for file in files} == {name.split("::")[0] for name in waiting}
    assert [nodes[worker].shutting_down for worker in ("gw0", "gw1", "gw2")] == [True, True, False]
    assert set(finish_sent_tests(scheduler, nodes["gw2"])) == {
        name for name in FILE_TEXTS if "sum" in name or "face" in name
    }
    assert nodes["gw2"].shutting_down
    assert scheduler.tests_finished


def test_test_file_collected_differently_by_two_test_processes_is_reported(root: Path):
    tests = ["tests/sum/test_large.py::test_one", "tests/page/test_page.py::test_one"]
    with pytest.raises(pytest.fail.Exception, match="Different tests were collected") as failure:
        start_scheduler(root, {"gw0": tests[:1], "gw1": ["tests/page/test_page.py::test_two"], "gw2": tests})
    assert "test_large" not in str(failure.value)


def test_test_run_ends_without_a_test_if_test_processes_collected_different_tests(
    root: Path, monkeypatch: pytest.MonkeyPatch
):
    tests, reports = ["tests/sum/test_large.py::test_one", "tests/page/test_page.py::test_one"], []
    other = ["tests/page/test_page.py::test_two"]
    monkeypatch.setattr(pytest, "fail", reports.append)
    scheduler, nodes = start_scheduler(root, {"gw0": tests[:1], "gw1": other, "gw2": tests}, count=0)
    assert len(reports) == 1
    assert scheduler.tests_finished
    assert not any(node.sent for node in nodes.values())


def test_test_processes_run_shared_test_files_after_their_own(root: Path):
    shared, *own = "tests/sum/test_large.py", "tests/sum/test_small.py", "tests/face/test_eyes.py"
    parts = [[f"{file}::test_{k}" for file in (shared, mine) for k in range(3)] for mine in own]
    scheduler, nodes = start_scheduler(root, {"gw0": [], "gw1": [], "gw2": parts[0], "gw3": parts[1]})
    assert scheduler.collection == [*parts[0], *parts[1][3:]]
    done = {worker: finish_sent_tests(scheduler, nodes[worker]) for worker in ("gw3", "gw2")}
    assert done == {"gw3": 3 * [own[1]] + 3 * [shared], "gw2": 3 * [own[0]]}
    assert scheduler.tests_finished
    assert all(node.shutting_down for node in nodes.values())


def test_new_test_process_takes_the_test_files_of_a_crashed_one(root: Path):
    tests = [
        f"{file}::test_{k}" for file in sorted(FILE_TEXTS, key=lambda file: rank(root / file, root)) for k in (0, 1)
    ]
    parts = {"gw0": [], "gw1": [], "gw2": tests[:8], "gw3": tests[6:]}
    scheduler, nodes = start_scheduler(root, parts)
    scheduler.mark_test_complete(nodes["gw2"], nodes["gw2"].sent[0])
    crashed = scheduler.remove_node(nodes["gw2"])
    assert crashed == tests[nodes["gw2"].sent[1]]
    nodes["gw4"] = StubNode("gw4")
    scheduler.add_node(nodes["gw4"])
    scheduler.add_node_collection(nodes["gw4"], tests)
    scheduler.schedule()
    assert nodes["gw4"].sent
    for worker in ("gw3", "gw4"):
        finish_sent_tests(scheduler, nodes[worker])
    assert scheduler.tests_finished


def test_test_scheduler_drops_completed_files_from_the_assigned_work_of_a_process(root: Path):
    tests = [f"{file}::test_{k}" for file in FILE_TEXTS for k in range(3)]
    scheduler, nodes = start_scheduler(root, {"gw0": [], "gw1": [], "gw2": tests})
    node = nodes["gw2"]
    for index in node.sent[:4]:
        scheduler.mark_test_complete(node, index)
    assert [len(work) for work in scheduler.assigned_work[node].values()] == [3]
