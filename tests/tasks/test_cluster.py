import os
import signal
import time
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.tasks import cluster as module
from kinesic.tasks.cluster import Cluster, cluster
from kinesic.tasks.engine import Processes
from kinesic.tasks.journal import Journal, run_once
from kinesic.tasks.processes import WorkerCrash

pytestmark = [
    pytest.mark.skipif(find_spec("distributed") is None, reason="the extra cluster is not installed"),
    pytest.mark.realtime,
    pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"),
]
EVALUATE = partial(partial, eval)  # tasks are Python expressions
TASK_COUNT = 24


@pytest.fixture(scope="module")
def two():
    with cluster("local:2") as result:
        yield result


def note_and_square(folder: Path, number: int) -> int:
    """Record the worker of a task, in time to be killed."""
    (folder / f"{number}-{os.getpid()}").touch()
    time.sleep(0.03)
    return number**2


def square_in(folder: Path):
    return partial(note_and_square, folder)


def victims(folder: Path) -> set[int]:
    return {int(path.name.split("-")[1]) for path in folder.iterdir()}


def test_cluster_runs_every_task_once_and_names_failures(two):
    tasks = [f"{k} ** 2" for k in range(20)] + ["1 / 0"]
    outcomes = list(two.run(tasks, EVALUATE))
    assert sorted(task for task, _ in outcomes) == sorted(tasks)
    results = dict(outcomes)
    assert all(results[f"{k} ** 2"] == k**2 for k in range(20))
    assert isinstance(results["1 / 0"], WorkerCrash)
    assert "ZeroDivisionError: division by zero" in results["1 / 0"].reason


def test_failed_tasks_of_a_group_are_reported_and_the_others_return_results(two):
    tasks = [f"{k} + 1" for k in range(300)]
    tasks[150], tasks[220] = "1 / 0", "[][1]"
    results = dict(two.run(tasks, EVALUATE))
    failed = {task: result.reason for task, result in results.items() if isinstance(result, WorkerCrash)}
    assert len(results) == 300
    assert sorted(failed) == ["1 / 0", "[][1]"]
    assert "IndexError" in failed["[][1]"]
    assert all(results[f"{k} + 1"] == k + 1 for k in range(300) if k not in (150, 220))


def test_equal_tasks_run_as_often_as_requested(two):
    results = list(two.run(["2 + 2"] * 100, EVALUATE))
    assert results == [("2 + 2", 4)] * 100


@pytest.mark.parametrize(("done", "spent", "size"), [(0, 0.0, 1), (10, 0.2, 5), (10, 5.0, 1), (100, 0.001, 32)])
def test_task_group_size_fills_a_tenth_of_a_second_up_to_a_maximum(done, spent, size):
    assert module._group_size(done, spent) == size


def test_local_cluster_description_gives_the_number_of_workers(two):
    assert two.place == "2 workers"


@pytest.mark.parametrize("kind", ["processes", "cluster"])
def test_no_task_is_lost_or_duplicated_when_workers_are_killed(kind, two, tmp_path):
    engine = Processes(2) if kind == "processes" else two
    (tmp_path / "notes").mkdir()
    journal = Journal(tmp_path / "finished.jsonl", int)
    tasks = {number: str(number) for number in range(TASK_COUNT)}
    killed, results = set(), []
    square = partial(square_in, tmp_path / "notes")
    run = run_once(tasks, lambda left: engine.run(left, square), journal, keep=lambda task, result: result)
    for task, result in run:
        results.append((task, result))
        alive = victims(tmp_path / "notes") - killed
        if len(killed) < 2 and len(results) >= 4 * (len(killed) + 1) and alive:
            killed.add(max(alive))
            os.kill(max(alive), signal.SIGKILL)
    assert len(killed) == 2
    assert sorted(results) == [(number, number**2) for number in range(TASK_COUNT)]
    assert journal.read() == {str(number): number**2 for number in range(TASK_COUNT)}
    lines = (tmp_path / "finished.jsonl").read_bytes().splitlines()
    assert len(lines) == TASK_COUNT


def test_cluster_worker_with_another_program_version_is_refused(two, monkeypatch):
    monkeypatch.setattr(module, "program_version", lambda: "sources of tomorrow")
    with pytest.raises(ConfigError, match=r"runs another kinesic.*\n.*there: sources [0-9a-f]{12}"):
        Cluster(two._client)
    with pytest.raises(ConfigError, match=r"here:  sources of tomorrow"):  # one that came after that check
        list(two.run(["1 + 2"], EVALUATE))


@pytest.mark.parametrize("address", ["local:", "local:0", "local:two", "tcp://127.0.0.1:1", "nowhere:"])
def test_invalid_cluster_address_error_shows_the_syntax_of_a_local_address(address, monkeypatch):
    monkeypatch.setattr(module, "SCHEDULER_TIMEOUT", 1)
    insecure = not address.startswith("local:")
    with pytest.raises(ConfigError, match=r"local:N for N workers"), cluster(address, insecure=insecure):
        pass
