"""Environment of all tests, set before any test module is imported.

MuJoCo reads MUJOCO_GL at its first import, so kinesic sets it before. Calibrations of the developer's robots are
hidden. Signals that a background shell or nohup ignores are reset, because child processes of tests inherit them.
Machines are shared, so examples have no deadline. Realtime tests first check whether the machine keeps time, and are
skipped if not (`machine too slow`). After a failure the machine is checked again: the test is skipped if the machine is
too slow, and otherwise repeated once, as the summary reports. Examples of theorems are few and fixed, whichever modules
are imported; `make soak` runs more and new ones each time. Linear algebra uses one thread, because the test processes
already use all cores, and waiting threads of OpenBLAS would use up to half of the processor time.
"""

import atexit
import gc
import os
import signal
import tempfile
from collections.abc import Generator
from pathlib import Path
from types import ModuleType

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read at the first import of NumPy, also in child processes

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers
from xdist.remote import Producer
from xdist.workermanage import WorkerController

from .durations import MIN_TESTS, list_slowest_files
from .machine import Watch, depends_on_time
from .messages import send_few_messages
from .nudge import nudge_random_inputs
from .partition import find_omitted_files
from .scheduling import (
    CLOCK_WORKERS,
    ClockBesideCalculation,
    begin_elsewhere,
    rank,
    step_back,
)

if "KINESIC_NUDGE" in os.environ:
    nudge_random_inputs(int(os.environ["KINESIC_NUDGE"]))  # before test modules and packages draw random numbers

from kinesic.sim import gl

from .performances import calm, hurried, known, through  # noqa: F401  # fixtures of all rooms

gl.prepare()

settings.register_profile("soak", max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("kinesic", settings.get_profile("soak"), derandomize=True, max_examples=12)
settings.load_profile("kinesic")

_nobody = tempfile.TemporaryDirectory(
    prefix="kinesic-tests-"
)  # folder of user settings during the tests, removed at interpreter exit
os.environ["XDG_CONFIG_HOME"] = _nobody.name

for _number, _usual in ((signal.SIGINT, signal.default_int_handler), (signal.SIGHUP, signal.SIG_DFL)):
    if signal.getsignal(_number) is signal.SIG_IGN:
        signal.signal(_number, _usual)


@pytest.hookimpl(trylast=True)  # after pytest-rerunfailures has connected its processes
def pytest_configure(config: pytest.Config) -> None:
    step_back(config)
    send_few_messages(config)
    if config.getoption("--hypothesis-profile") != "soak":
        ignore_source_constants()


def ignore_source_constants() -> None:
    """Keep Hypothesis from mixing constants of all imported modules into its examples.

    With them, a new constant anywhere, or another selection of tests, changes the examples of every theorem. Each
    process also parses 900 files for them.
    """
    providers._get_local_constants = lambda: providers._local_constants


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Freeze collected objects, so that the garbage collector does not scan them."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()
        gc.set_threshold(20_000, 20, 20)


atexit.register(gc.unfreeze)  # avoids leak reports at interpreter exit
atexit.register(gc.disable)  # the interpreter still collects twice


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    report = yield
    worker = getattr(collector.config, "workerinput", None)
    if worker and collector.path == Path(__file__).parent:
        report.result = begin_elsewhere(report.result, worker["workerid"], worker["workercount"])
    return report


def excludes_soak(config: pytest.Config) -> bool:
    """Return whether the marker expression deselects all tests of `make soak`."""
    return config.getoption("markexpr").startswith("not soak")


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Skip files that this process does not run, to save the time of collection."""
    if collection_path.name == "soak" and excludes_soak(config):
        return True
    omitted = getattr(config, "workerinput", {}).get("omitted_files", ())
    return True if omitted and collection_path.relative_to(config.rootpath).as_posix() in omitted else None


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node: WorkerController) -> None:
    count = node.workerinput["workercount"]
    node.workerinput["omitted_files"] = frozenset(find_omitted_files(node.config, node.gateway.id, count))


def pytest_pycollect_makeitem(collector: pytest.Collector, name: str, obj: object) -> list[pytest.Item] | None:
    """Skip functions marked for `make soak` in other folders, with all parameters."""
    marks = getattr(obj, "pytestmark", None) if name.startswith("test_") else None
    if marks and excludes_soak(collector.config) and any(mark.name == "soak" for mark in marks):
        return []
    return None


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    return (os.cpu_count() or 1) + len(CLOCK_WORKERS)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> ClockBesideCalculation:
    return ClockBesideCalculation(config, log)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    items.sort(key=lambda item: rank(item.path, config.rootpath))


@pytest.fixture(scope="session")
def trimesh() -> ModuleType:
    """Mesh library, imported only by tests that need it (half a second)."""
    return pytest.importorskip("trimesh")


_watch = Watch()


def pytest_runtest_setup(item: pytest.Item) -> None:
    if item.get_closest_marker("realtime") and (complaint := _watch.complaint()):
        pytest.skip(f"machine too slow: {complaint}")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    excusable = report.failed and item.get_closest_marker("realtime") and depends_on_time(call.excinfo)
    if excusable and (excuse := _watch.excuse()):
        reason = f"Skipped: machine too slow: {excuse}; it failed: {str(report.longrepr).splitlines()[-1]}"
        report.outcome, report.longrepr = "skipped", (*item.location[:2], reason)
    return report


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """List failures on a too slow machine, and the slowest files."""
    skipped = terminalreporter.stats.get("skipped", [])
    unknown = [report for report in skipped if "; it failed: " in str(report.longrepr)]
    if unknown:
        terminalreporter.section("failed on a machine too slow to tell")
    for report in unknown:
        terminalreporter.write_line(f"{report.nodeid}: {report.longrepr[2]!s}")
    passed = terminalreporter.stats.get("passed", [])
    if len(passed) >= MIN_TESTS:
        terminalreporter.section("slowest test files")
        for line in list_slowest_files(passed):
            terminalreporter.write_line(line)
