"""Works through a list of tasks in several processes; one that dies takes only its own task with it.

A process that is killed from outside is no fault of its task, which another process begins anew.
"""

import faulthandler
import os
import signal
from collections import deque
from collections.abc import Callable, Generator, Iterable
from dataclasses import dataclass
from itertools import count
from multiprocessing.connection import Connection, wait
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Generic, TypeVar

from kinesic.child import Child, child_context

Task = TypeVar("Task")
Result = TypeVar("Result")

FATAL = "Fatal Python error"
OUTSIDE = (signal.SIGKILL, signal.SIGTERM)  # who dies of these was killed by somebody, or for want of memory
TRIES = 4  # of a task whose processes are killed


@dataclass(frozen=True)
class WorkerCrash:
    """Why a process died while it had a task."""

    reason: str  # one line
    trace: str  # what it wrote to standard error
    is_killed: bool = False  # from outside, and not by its own fault


@dataclass
class _Worker(Generic[Task, Result]):
    child: Child
    line: Connection
    errors: Path  # its standard error
    task: Task
    tries: int  # how often the task was begun

    def result(self) -> Result | WorkerCrash:
        """Receives the result of its task, or why it crashed."""
        try:
            result: Result = self.line.recv()
        except (EOFError, ConnectionError):
            self.line.close()
            return _crash(self.child.wait() or 0, self.errors.read_text(errors="replace"))
        return result

    def go_on(self, task: Task, tries: int) -> bool:
        """Gives it another task; says no where it was killed meanwhile."""
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
    """Works through tasks in processes of their own.

    When the caller stops iterating, or is interrupted, the processes end.

    Args:
        tasks: picklable.
        prepare: called once in each process, gives the function that does a task; picklable.
        jobs: number of processes.
        preload: module that processes begin with.

    Yields:
        Tasks with their results, in the order in which they are ready.
    """
    context = child_context(*((preload,) if preload else ()))
    left = deque((task, 1) for task in tasks)
    began = count()
    working: dict[Connection, _Worker[Task, Result]] = {}
    with TemporaryDirectory() as folder:

        def hire() -> None:
            errors = Path(folder) / f"{next(began)}.txt"
            ours, theirs = context.Pipe()
            task, tries = left.popleft()
            child = Child(context, _work, theirs, prepare, task, errors)
            working[ours] = _Worker(child, ours, errors, task, tries)

        try:
            while left and len(working) < jobs:
                hire()
            while working:
                for line in wait(list(working)):
                    worker = working[line]  # type: ignore[index]  # wait gives back what it was given
                    task, result = worker.task, worker.result()
                    again = isinstance(result, WorkerCrash) and result.is_killed and worker.tries < TRIES
                    if again:
                        left.append((task, worker.tries + 1))
                    if isinstance(result, WorkerCrash) or not left or not worker.go_on(*left[0]):
                        worker.dismiss()
                        del working[worker.line]
                        if left:
                            hire()
                    else:
                        left.popleft()
                    if not again:
                        yield task, result
        finally:
            for worker in working.values():
                worker.dismiss()


def _work(line: Connection, prepare: Callable[[], Callable[[Task], Result]], task: Task, errors: Path) -> None:
    """Does the first task, then those that are sent, until there are no more."""
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


def _crash(code: int, trace: str) -> WorkerCrash:
    """Says why a process ended: its signal or exit code, and the error that it wrote last."""
    lines = [line.strip() for line in trace.splitlines() if line.strip()]
    fatal = [line for line in lines if line.startswith(FATAL)]
    said = (fatal or lines[-1:] or ["it wrote nothing"])[0]
    how = f"signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
    return WorkerCrash(f"its process ended with {how}: {said}", trace, -code in OUTSIDE)
