"""Execution of a list of tasks in several processes.

A process that dies affects only its own task. If it was killed from outside, another process repeats the task.
"""

import faulthandler
import os
import signal
from collections import deque
from collections.abc import Callable, Generator, Iterable
from dataclasses import dataclass
from itertools import count
from multiprocessing.connection import wait
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Generic, TypeVar

from kinesic.child import Child, PipeEnd, child_context

Task = TypeVar("Task")
Result = TypeVar("Result")

FATAL_PREFIX = "Fatal Python error"  # prefix of the error line of a crashed Python interpreter
# The kernel sends SIGKILL if memory is exhausted; Windows has no SIGKILL.
OUTSIDE_SIGNALS = (getattr(signal, "SIGKILL", signal.SIGTERM), signal.SIGTERM)  # signals of a kill from outside
MAX_TRIES = 4  # most attempts per task whose worker process is killed from outside


@dataclass(frozen=True)
class WorkerCrash:
    """Reason why a task has no result, such as a dead worker."""

    reason: str  # one line
    trace: str  # standard error of the process, or the full message of the cluster
    is_killed: bool = False  # whether the worker was killed from outside


@dataclass
class _Worker(Generic[Task, Result]):
    child: Child
    line: PipeEnd
    errors: Path  # file with the standard error of the worker process
    task: Task
    tries: int  # attempts including this one

    def result(self) -> Result | WorkerCrash:
        """Receive a task's result from the worker, or its crash."""
        try:
            result: Result = self.line.recv()
        except (EOFError, ConnectionError):
            self.line.close()
            return _describe_crash(self.child.wait() or 0, self.errors.read_text(errors="replace"))
        return result

    def send_task(self, task: Task, tries: int) -> bool:
        """Send the worker its next task and return False if it died."""
        try:
            self.line.send(task)
        except (BrokenPipeError, ConnectionError):
            return False
        self.task, self.tries = task, tries
        return True

    def dismiss(self) -> None:
        self.line.close()
        self.child.kill()


def run_pool(
    tasks: Iterable[Task], prepare: Callable[[], Callable[[Task], Result]], *, jobs: int, preload: str = ""
) -> Generator[tuple[Task, Result | WorkerCrash], None, None]:
    """Run tasks in a pool of worker processes and yield the results.

    The processes end when the caller stops iterating or is interrupted.

    Args:
        tasks: picklable tasks.
        prepare: called once in each process, returns the function that does a task; picklable.
        jobs: number of processes.
        preload: module that processes import first.

    Yields:
        Tasks with their results in order of completion.
    """
    context = child_context(*((preload,) if preload else ()))
    left = deque((task, 1) for task in tasks)
    began = count()
    working: dict[PipeEnd, _Worker[Task, Result]] = {}
    with TemporaryDirectory() as folder:

        def start_worker() -> None:
            errors = Path(folder) / f"{next(began)}.txt"
            ours, theirs = context.Pipe()
            task, tries = left.popleft()
            child = Child(context, _work, theirs, prepare, task, errors)
            working[ours] = _Worker(child, ours, errors, task, tries)

        try:
            while left and len(working) < jobs:
                start_worker()
            while working:
                for line in wait(list(working)):
                    worker = working[line]  # type: ignore[index]  # wait returns its arguments
                    task, result = worker.task, worker.result()
                    again = isinstance(result, WorkerCrash) and result.is_killed and worker.tries < MAX_TRIES
                    if again:
                        left.append((task, worker.tries + 1))
                    if isinstance(result, WorkerCrash) or not left or not worker.send_task(*left[0]):
                        worker.dismiss()
                        del working[worker.line]
                        if left:
                            start_worker()
                    else:
                        left.popleft()
                    if not again:
                        yield task, result
        finally:
            for worker in working.values():
                worker.dismiss()


def _work(line: PipeEnd, prepare: Callable[[], Callable[[Task], Result]], task: Task, errors: Path) -> None:
    """Run tasks received over a pipe (main function of a worker process)."""
    with errors.open("wb") as file:
        os.dup2(file.fileno(), 2)
    faulthandler.enable(file=2)
    do = prepare()
    while True:
        line.send(do(task))
        try:
            task = line.recv()
        except EOFError:
            return


def _describe_crash(code: int, trace: str) -> WorkerCrash:
    """Make the crash description of a worker process that ended unexpectedly.

    The description has its exit code or signal, and its last error.
    """
    lines = [line.strip() for line in trace.splitlines() if line.strip()]
    fatal = [line for line in lines if line.startswith(FATAL_PREFIX)]
    error = (fatal or lines[-1:] or ["it wrote nothing"])[0]
    end = f"signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
    return WorkerCrash(f"its process ended with {end}: {error}", trace, -code in OUTSIDE_SIGNALS)
