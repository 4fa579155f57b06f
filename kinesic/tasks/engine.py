"""Interface of task engines, and choice of the current engine."""

import os
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Protocol, TypeVar

from kinesic.tasks.processes import WorkerCrash, run_pool

Task = TypeVar("Task")
Result = TypeVar("Result")


class Engine(Protocol):
    """Interface for running tasks in several workers.

    If a worker is killed, its task is repeated, and each result comes once.
    """

    @property
    def place(self) -> str:
        """Description of the workers, with the dashboard address of a cluster."""

    def run(
        self, tasks: Iterable[Task], prepare: Callable[[], Callable[[Task], Result]], *, preload: str = ""
    ) -> Generator[tuple[Task, Result | WorkerCrash], None, None]:
        """Run tasks and yield (task, result or crash) in order of completion.

        Args:
            tasks: distinct, picklable and hashable tasks.
            prepare: called once in each worker, returns the function that does a task; picklable.
            preload: module that workers import first.
        """


@dataclass(frozen=True)
class Processes:
    """Engine that runs tasks in local worker processes."""

    jobs: int  # number of processes

    @property
    def place(self) -> str:
        """Description of the engine: number of local processes."""
        return f"{self.jobs} processes" if self.jobs > 1 else "1 process"

    def run(
        self, tasks: Iterable[Task], prepare: Callable[[], Callable[[Task], Result]], *, preload: str = ""
    ) -> Generator[tuple[Task, Result | WorkerCrash], None, None]:
        """Run tasks and yield (task, result or crash) in order of completion."""
        return run_pool(tasks, prepare, jobs=self.jobs, preload=preload)


_CURRENT_ENGINE: ContextVar[Engine | None] = ContextVar("engine", default=None)


def current_engine() -> Engine:
    """Return the engine set by `using_engine`, or one process per core."""
    return _CURRENT_ENGINE.get() or Processes(os.cpu_count() or 1)


@contextmanager
def using_engine(engine: Engine) -> Iterator[Engine]:
    """Use a task engine for all tasks inside the context."""
    token = _CURRENT_ENGINE.set(engine)
    try:
        yield engine
    finally:
        _CURRENT_ENGINE.reset(token)
