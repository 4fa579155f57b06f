import os
from functools import partial

import pytest

from kinesic.tasks.processes import WorkerCrash, run_pool

EVALUATE = partial(partial, eval)  # tasks are Python expressions
FAILING_TASKS = {  # expression that ends the worker -> reason of the failure
    "__import__('os')._exit(3)": "exit code 3: it wrote nothing",
    "__import__('os')._exit(0)": "exit code 0: it wrote nothing",
    "1 / 0": "exit code 1: ZeroDivisionError: division by zero",
    "__import__('os').kill(__import__('os').getpid(), 9)": "signal SIGKILL",
    "__import__('os').abort()": "signal SIGABRT: Fatal Python error: Aborted",
}


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.mark.parametrize("jobs", [1, 3])
def test_every_task_runs_once_in_local_worker_processes(jobs):
    tasks = [f"{k} ** 2" for k in range(7)]
    assert dict(run_pool(tasks, EVALUATE, jobs=jobs)) == {task: k**2 for k, task in enumerate(tasks)}


def test_empty_task_list_gives_no_results():
    assert list(run_pool([], EVALUATE, jobs=2)) == []


def test_crashed_tasks_are_reported_with_a_reason_and_the_others_continue():
    tasks = ["1 + 1", *FAILING_TASKS, "2 + 2", "3 + 3"]
    results = dict(run_pool(tasks, EVALUATE, jobs=2))
    assert [results[task] for task in ("1 + 1", "2 + 2", "3 + 3")] == [2, 4, 6]
    for task, reason in FAILING_TASKS.items():
        assert isinstance(results[task], WorkerCrash)
        assert reason in results[task].reason
    assert 'File "<string>", line 1' in results["1 / 0"].trace


def test_worker_processes_end_when_the_caller_stops_iterating():
    results = run_pool(["__import__('os').getpid()"] + ["__import__('time').sleep(60)"] * 3, EVALUATE, jobs=2)
    _, pid = next(results)
    assert alive(pid)
    results.close()
    assert not alive(pid)
