"""What works through tasks: one protocol, whichever machines do them, and the engine that is in use."""

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
    """Works through tasks. A worker that is killed loses nothing: its task is done again, and its result comes once."""

    @property
    def place(self) -> str:
        """Where tasks are done, in words for people; of a cluster also where its dashboard is."""

    def run(
        self, tasks: Iterable[Task], prepare: Callable[[], Callable[[Task], Result]], *, preload: str = ""
    ) -> Generator[tuple[Task, Result | WorkerCrash], None, None]:
        """Yields tasks with their results, in the order in which they are ready.

        Args:
            tasks: picklable and hashable, each another one.
            prepare: called once in each worker, gives the function that does a task; picklable.
            preload: module that workers begin with.
        """


@dataclass(frozen=True)
class Processes:
    """Does tasks in processes of this machine."""

    jobs: int

    @property
    def place(self) -> str:
        """How many processes there are."""
        return f"{self.jobs} processes" if self.jobs > 1 else "1 process"

    def run(
        self, tasks: Iterable[Task], prepare: Callable[[], Callable[[Task], Result]], *, preload: str = ""
    ) -> Generator[tuple[Task, Result | WorkerCrash], None, None]:
        """Yields tasks with their results, in the order in which they are ready."""
        return run_pool(tasks, prepare, jobs=self.jobs, preload=preload)


_USED: ContextVar[Engine | None] = ContextVar("engine", default=None)


def engine_in_use() -> Engine:
    """Gives the engine that was chosen with `using_engine`; without one, a process for each core of this machine."""
    return _USED.get() or Processes(os.cpu_count() or 1)


@contextmanager
def using_engine(engine: Engine) -> Iterator[Engine]:
    """Has an engine do all tasks meanwhile."""
    token = _USED.set(engine)
    try:
        yield engine
    finally:
        _USED.reset(token)
