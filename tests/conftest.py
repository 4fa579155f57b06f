"""What must be so before any test module is imported.

MuJoCo reads MUJOCO_GL when it is first imported: kinesic decides before. And whoever runs the tests may have calibrated
a robot: here nobody has. A shell lets what it runs in the background ignore Ctrl-C, and nohup a terminal that closes,
which programs would inherit that tests start and interrupt. Machines are shared: an example may take as long as it
likes; what needs real time looks first whether the machine keeps time, and is skipped where it does not (`machine too
slow`). Where it fails, the machine is looked at again: the test is skipped as well if the machine is too slow, and else
tried again once, which the summary tells. Examples of theorems are few and the same in every run; `make soak` has more,
and new ones each time.
"""

import atexit
import gc
import os
import signal
import tempfile
from collections.abc import Generator
from pathlib import Path
from types import ModuleType

import pytest
from hypothesis import HealthCheck, settings
from xdist.remote import Producer

from .machine import Watch
from .nudge import nudge_random_inputs
from .scheduling import CLOCK_WORKERS, ClockBesideCalculation, begin_elsewhere, rank, step_back

if "KINESIC_NUDGE" in os.environ:
    nudge_random_inputs(int(os.environ["KINESIC_NUDGE"]))  # before test modules and rooms draw

from kinesic.sim import gl

from .performances import calm, hurried, known, through  # noqa: F401  # fixtures of all rooms

gl.prepare()

settings.register_profile("soak", max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("kinesic", settings.get_profile("soak"), derandomize=True, max_examples=24)
settings.load_profile("kinesic")

_nobody = tempfile.TemporaryDirectory(prefix="kinesic-tests-")  # removed when the interpreter ends
os.environ["XDG_CONFIG_HOME"] = _nobody.name

for _number, _usual in ((signal.SIGINT, signal.default_int_handler), (signal.SIGHUP, signal.SIG_DFL)):
    if signal.getsignal(_number) is signal.SIG_IGN:
        signal.signal(_number, _usual)


def pytest_configure(config: pytest.Config) -> None:
    step_back(config)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """What is collected lives to the end: the garbage collector need not look at it again and again, nor that often."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()
        gc.set_threshold(20_000, 20, 20)


atexit.register(gc.unfreeze)  # so that nothing seems to leak when the interpreter ends
atexit.register(gc.disable)  # the interpreter collects twice more all the same


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    report = yield
    worker = getattr(collector.config, "workerinput", None)
    if worker and collector.path == Path(__file__).parent:
        report.result = begin_elsewhere(report.result, worker["workerid"], worker["workercount"])
    return report


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Leaves out what `make soak` runs, thousands of tests that would be collected only to be deselected."""
    return True if collection_path.name == "soak" and config.getoption("markexpr") == "not soak" else None


def pytest_pycollect_makeitem(collector: pytest.Collector, name: str, obj: object) -> list[pytest.Item] | None:
    """Leaves out in other folders what `make soak` runs: a function that is marked so, with all its parameters."""
    marks = getattr(obj, "pytestmark", None) if name.startswith("test_") else None
    if marks and collector.config.getoption("markexpr") == "not soak" and any(mark.name == "soak" for mark in marks):
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
    for item in items:
        if item.get_closest_marker("realtime"):
            item.add_marker(pytest.mark.flaky(reruns=1))


@pytest.fixture(scope="session")
def trimesh() -> ModuleType:
    """A library of meshes, which takes half a second to import: by whoever has tests that read them."""
    return pytest.importorskip("trimesh")


_watch = Watch()


def pytest_runtest_setup(item: pytest.Item) -> None:
    if item.get_closest_marker("realtime") and (complaint := _watch.complaint()):
        pytest.skip(f"machine too slow: {complaint}")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    if report.failed and item.get_closest_marker("realtime") and (excuse := _watch.excuse()):
        reason = f"Skipped: machine too slow: {excuse}; it failed: {str(report.longrepr).splitlines()[-1]}"
        report.outcome, report.longrepr = "skipped", (*item.location[:2], reason)
    return report


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Names tests that failed while the machine was too slow: nobody knows whether they would have passed."""
    skipped = terminalreporter.stats.get("skipped", [])
    unknown = [report for report in skipped if "; it failed: " in str(report.longrepr)]
    if unknown:
        terminalreporter.section("failed on a machine too slow to tell")
    for report in unknown:
        terminalreporter.write_line(f"{report.nodeid}: {report.longrepr[2]!s}")
