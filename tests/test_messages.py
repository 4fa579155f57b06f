import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from pytest_rerunfailures import StatusDB

from .messages import is_needed, send_few_messages, uses_short_output

ROOT_FOLDER = Path(__file__).parents[1]
ENVIRONMENT = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")} | {
    "PYTHONPATH": str(ROOT_FOLDER)
}


def report(when: str, outcome: str) -> dict[str, object]:
    return {"data": {"when": when, "outcome": outcome}}


@pytest.mark.parametrize("when", ["setup", "call", "teardown"])
def test_parallel_test_workers_send_reports_of_failed_skipped_and_rerun_test_phases(when):
    assert all(is_needed("testreport", report(when, outcome)) for outcome in ("failed", "skipped", "rerun"))


def test_parallel_test_workers_send_only_the_call_report_of_a_passed_test():
    needed = {when: is_needed("testreport", report(when, "passed")) for when in ("setup", "call", "teardown")}
    assert needed == {"setup": False, "call": True, "teardown": False}


def test_parallel_test_workers_send_messages_that_schedule_tests():
    names = ("collectionfinish", "runtest_protocol_complete", "warning_recorded", "workerfinished")
    assert all(is_needed(name, {}) for name in names)


def test_test_run_uses_short_output_unless_verbose_durations_or_xml_are_requested(pytestconfig):
    assert uses_short_output(pytestconfig) == (
        pytestconfig.option.verbose <= 0 and not pytestconfig.option.durations and not pytestconfig.option.xmlpath
    )


def test_test_worker_with_verbose_output_closes_the_socket_that_counts_reruns():
    closed = []
    connected = SimpleNamespace(sock=SimpleNamespace(close=lambda: closed.append("socket")))
    option = SimpleNamespace(verbose=1, durations=None, xmlpath=None)
    config = SimpleNamespace(workerinput={}, option=option, failures_db=connected)
    send_few_messages(config)
    assert type(config.failures_db) is StatusDB
    assert closed == ["socket"]


SUITE = """
import pytest
attempts = []

def test_passes_at_the_second_attempt():
    attempts.append(1)
    assert len(attempts) == 2

@pytest.fixture
def broken():
    yield
    raise ValueError

@pytest.fixture
def missing():
    raise ValueError

def test_teardown_fails(broken): pass
def test_setup_fails(missing): pass
def test_fails(): assert False
def test_passes(): pass
def test_skips(): pytest.skip("reason")
"""
CONFTEST = """
import pytest
from tests.messages import send_few_messages

pytest_configure = pytest.hookimpl(send_few_messages, trylast=True)
"""


@pytest.mark.soak
def test_summary_of_a_parallel_test_run_counts_every_result_and_rerun(tmp_path):
    (tmp_path / "conftest.py").write_text(CONFTEST)
    (tmp_path / "test_results.py").write_text(SUITE)
    command = [sys.executable, "-m", "pytest", "-q", "-n", "1", "--reruns", "1", "-W", "error", str(tmp_path)]
    ended = subprocess.run(command, cwd=ROOT_FOLDER, env=ENVIRONMENT, capture_output=True, text=True, check=False)
    last = ended.stdout.splitlines()[-1]
    assert last.startswith("1 failed, 4 passed, 1 skipped, 2 errors, 4 rerun"), ended.stdout
