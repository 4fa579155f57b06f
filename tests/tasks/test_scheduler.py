"""Cluster of an external scheduler and workers."""

import os
import signal
import time
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.cli.many.workers import Workers
from kinesic.tasks import cluster as module
from kinesic.tasks.cluster import cluster

from .dask_programs import dask_scheduler, dask_workers

pytestmark = [
    pytest.mark.skipif(find_spec("distributed") is None, reason="the extra cluster is not installed"),
    pytest.mark.realtime,
    pytest.mark.skipif(find_spec("distributed") is None, reason="the extra cluster is not installed"),
    pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"),
]
EVALUATE = partial(partial, eval)  # tasks are Python expressions
SQUARE = "(__import__('os').getpid(), __import__('time').sleep(0.02), {} ** 2)"
HAS_ALL = "'kinesic.report.batch' in __import__('sys').modules"


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """Return the address of a scheduler with one worker."""
    folder: Path = tmp_path_factory.mktemp("dask")
    with dask_scheduler(folder) as address, dask_workers(address, folder):
        yield address


def test_insecure_scheduler_prints_a_warning_its_worker_count_and_its_dashboard(address, capsys):
    with Workers(None, address, insecure=True).engine():
        pass
    warning, place = capsys.readouterr().err.splitlines()
    assert warning.startswith("warn: --insecure: anyone who can reach a port of this cluster can run code")
    assert place.startswith("cluster: 1 workers, dashboard http://127.0.0.1:")


def test_no_task_is_lost_or_duplicated_when_a_scheduler_worker_is_killed(address):
    with cluster(address, insecure=True) as engine:
        results, killed = {}, 0
        for task, (pid, _, square) in engine.run([SQUARE.format(k) for k in range(30)], EVALUATE):
            assert task not in results
            results[task] = square
            if len(results) == 5:
                killed = pid
                os.kill(pid, signal.SIGKILL)
        assert results == {SQUARE.format(k): k**2 for k in range(30)}
        assert killed
        assert dict(engine.run([HAS_ALL], EVALUATE)) == {HAS_ALL: True}


def test_scheduler_workers_with_another_program_version_are_refused(address, monkeypatch):
    monkeypatch.setattr(module, "program_version", lambda: "sources of tomorrow")
    with (
        pytest.raises(ConfigError, match=r"runs another kinesic.*\n.*there: sources [0-9a-f]{12}"),
        cluster(address, insecure=True),
    ):
        pass


def test_scheduler_without_workers_reports_the_start_command(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "SCHEDULER_TIMEOUT", 1)
    with (
        dask_scheduler(tmp_path) as lonely,
        pytest.raises(ConfigError, match=f"no workers.*dask worker {lonely}"),
        cluster(lonely, insecure=True),
    ):
        pass


def succeed_once(note: Path) -> int:
    """Return a result at the first call, and fail at the second."""
    if note.exists():
        raise ValueError("asked twice")
    note.touch()
    return os.getpid()


def test_task_whose_result_is_lost_runs_again_and_its_second_failure_is_reported(address, tmp_path):
    with cluster(address, insecure=True) as engine:
        future = engine._client.submit(succeed_once, tmp_path / "note", pure=False)
        pid = next(iter(engine._client.run(os.getpid).values()))
        while not future.done():
            time.sleep(0.01)
        os.kill(pid, signal.SIGKILL)
        assert module._fetch_result(future).reason == "it failed on the cluster with ValueError: asked twice"
