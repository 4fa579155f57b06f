"""Execution of tasks on a dask.distributed cluster.

The scheduler runs already, or some workers are started on this machine. Short tasks are sent in groups that take a
tenth of a second. A group that fails, or whose worker dies, is repeated task by task, so that a crash is reported for
the task that causes it.
"""

import logging
import pickle
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice
from threading import Lock
from time import monotonic
from typing import TYPE_CHECKING, Generic, TypeVar

from kinesic.body.config import ConfigError
from kinesic.extras import install_extra
from kinesic.tasks.dask_access import Certificates, open_client
from kinesic.tasks.processes import WorkerCrash
from kinesic.tasks.program import program_version

if TYPE_CHECKING:
    from distributed import Client, Future

Task = TypeVar("Task")
Result = TypeVar("Result")

SCHEDULER_TIMEOUT = 10  # [s] time limit for the scheduler's answer, and for its first worker
GROUPS_PER_WORKER = 8  # task groups queued or running per worker; more shorten idle times but need more memory
GROUP_TIME = 0.1  # [s] target computing time of a task group, well above the 5 ms that dask needs per group
MAX_GROUP_SIZE = 32  # largest number of tasks per group
WORKER_COUNT_INTERVAL = 2.0  # [s] between queries of the number of workers
MAX_TRIES = 3  # most attempts per task whose worker is killed, since the task may not be the cause


class Cluster:
    """Engine whose workers are dask processes, on this machine or others."""

    def __init__(self, client: "Client") -> None:
        """Check the workers of a connected dask client before use.

        Raises:
            ConfigError: there are no workers, or one runs another version of the program.
        """
        self._client = client
        _check_workers(client)

    @property
    def place(self) -> str:
        """Description of the workers, with the scheduler's dashboard address if available."""
        link = (
            self._client.cluster is None and self._client.dashboard_link
        )  # local workers have no dashboard, because its HTTP has no TLS
        return f"{self._workers()} workers{f', dashboard {link}' if link else ''}"

    def run(
        self, tasks: Iterable[Task], prepare: Callable[[], Callable[[Task], Result]], *, preload: str = ""
    ) -> Generator[tuple[Task, Result | WorkerCrash], None, None]:
        """Run tasks and yield (task, result or crash) in order of completion.

        See `Engine`.
        """
        from distributed import as_completed  # noqa: PLC0415 - slow to import, and only clusters need it

        code, left, workers = pickle.dumps(prepare), iter(tasks), _WorkerCount(self._workers)
        begun: dict[str, _SubmittedGroup[Task]] = {}
        ready, done, spent = as_completed(), 0, 0.0
        try:
            for future in self._submit_more(code, left, begun, workers.now(), size=1):
                ready.add(future)
            for future in ready:
                group = begun.pop(future.key)
                result: _GroupResult[Result] | WorkerCrash = _fetch_result(future)
                future.release()
                if isinstance(result, WorkerCrash) and group.may_try_again(result):
                    for task in group.tasks:  # one by one, because one of them may cause the crash
                        ready.add(self._begin(code, (task,), begun, group.tries + 1))
                    continue
                if not isinstance(result, WorkerCrash):
                    done, spent = done + len(result.results), spent + result.seconds
                size = _group_size(done, spent)
                for more in self._submit_more(code, left, begun, workers.now(), size=size):
                    ready.add(more)
                yield from zip(
                    group.tasks, [result] if isinstance(result, WorkerCrash) else result.results, strict=True
                )
        finally:
            self._client.cancel([one.future for one in begun.values()], force=True)

    def _submit_more(
        self, code: bytes, left: Iterator[Task], begun: "dict[str, _SubmittedGroup[Task]]", workers: int, *, size: int
    ) -> "Iterator[Future]":
        """Submit groups until each worker has `GROUPS_PER_WORKER`, yielding their futures."""
        while len(begun) < GROUPS_PER_WORKER * max(1, workers):
            tasks = tuple(islice(left, size))
            if not tasks:
                return
            yield self._begin(code, tasks, begun, 1)

    def _begin(
        self, code: bytes, tasks: tuple[Task, ...], begun: "dict[str, _SubmittedGroup[Task]]", tries: int
    ) -> "Future":
        future = self._client.submit(_run_group, code, tasks, program_version(), pure=False)  # with a unique key
        begun[future.key] = _SubmittedGroup(tasks, future, tries)
        return future

    def _workers(self) -> int:
        return len(self._client.scheduler_info(n_workers=-1)["workers"])


@dataclass(frozen=True)
class _SubmittedGroup(Generic[Task]):
    """Group of tasks that was sent to the scheduler."""

    tasks: tuple[Task, ...]
    future: "Future"
    tries: int  # attempts including this one

    def may_try_again(self, crash: WorkerCrash) -> bool:
        """Return whether to resubmit the group's tasks individually after a crash."""
        return len(self.tasks) > 1 or (crash.is_killed and self.tries < MAX_TRIES)


@dataclass(frozen=True)
class _GroupResult(Generic[Result]):
    """Results of a task group, with its computing time."""

    results: list[Result]
    seconds: float  # [s] duration of all tasks of the group


def _group_size(done: int, spent: float) -> int:
    """Compute the number of tasks that take `GROUP_TIME`, at most `MAX_GROUP_SIZE`.

    Args:
        done: finished tasks.
        spent: [s] that they took.
    """
    return max(1, min(MAX_GROUP_SIZE, int(GROUP_TIME * done / spent))) if spent > 0.0 else 1


class _WorkerCount:
    """Cached number of dask workers.

    A query takes longer than sending a task.
    """

    def __init__(self, ask: Callable[[], int]) -> None:
        self._ask = ask
        self._count, self._asked = ask(), monotonic()

    def now(self) -> int:
        if monotonic() - self._asked > WORKER_COUNT_INTERVAL:
            self._count, self._asked = self._ask(), monotonic()
        return self._count


@contextmanager
def cluster(address: str, *, certificates: Certificates | None = None, insecure: bool = False) -> Iterator[Cluster]:
    """Connect to a dask cluster, or to new local workers.

    Local workers are stopped on exit.

    Args:
        address: address of a scheduler, or local:N.
        certificates: certificates for a remote scheduler; None: those of dask's configuration.
        insecure: whether a scheduler without TLS is accepted.

    Raises:
        ConfigError: dask is not installed, no scheduler answers, the connection would not be authenticated, or a worker
            runs another version of the program.
    """
    try:
        import distributed  # noqa: F401, PLC0415 - an extra
    except ModuleNotFoundError as error:
        raise ConfigError(f"--cluster needs {error.name}: {install_extra('cluster')}") from None
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # the results report dead workers
    with open_client(address, timeout=SCHEDULER_TIMEOUT, certificates=certificates, insecure=insecure) as client:
        yield Cluster(client)


def _check_workers(client: "Client") -> None:
    """Refuse a cluster without workers, or with another version of the program."""
    try:
        client.wait_for_workers(1, timeout=SCHEDULER_TIMEOUT)
    except TimeoutError:
        raise ConfigError(f"the cluster has no workers; start some: dask worker {client.scheduler.addr}") from None
    for worker, version in client.run(_own_version).items():
        if version != program_version():
            raise ConfigError(_mismatch(worker, version, program_version()))


def _own_version() -> str:
    return program_version()  # of the calling process


def _mismatch(worker: str, theirs: str, ours: str) -> str:
    return f"worker {worker} runs another kinesic, install this one there\n  there: {theirs}\n  here:  {ours}"


def _fetch_result(future: "Future[_GroupResult[Result]]") -> _GroupResult[Result] | WorkerCrash:
    """Fetch the results of a task group, or its worker's crash.

    Raises:
        ConfigError: a worker that joined later runs another version of the program.
    """
    from distributed import KilledWorker  # noqa: PLC0415 - slow to import, and only clusters need it

    while (error := future.exception()) is None:
        # The worker that holds the results may die now; another one repeats the tasks, which may fail.
        results: list[_GroupResult[Result]] = future.client.gather([future], errors="skip")
        if results:
            return results[0]
    if isinstance(error, WrongProgramError):
        raise ConfigError(str(error))
    words = str(error).strip().splitlines() or ["no reason given"]
    reason = f"it failed on the cluster with {type(error).__name__}: {words[0]}"
    return WorkerCrash(reason, str(error), isinstance(error, KilledWorker))


class WrongProgramError(Exception):
    """Error if worker and caller run different versions of the program."""


_TASK_LOCK = Lock()  # held while a group runs in this worker: robot models are not thread-safe
_PREPARED_TASKS: dict[bytes, Callable[[object], object]] = {}  # pickled `prepare` -> task function in this worker


def _run_group(code: bytes, tasks: tuple[object, ...], version: str) -> _GroupResult[object]:
    """Run a group of tasks in this worker and time them.

    The task function is prepared at the first group that needs it.
    """
    from distributed import get_worker  # noqa: PLC0415 - slow to import, and only clusters need it

    if program_version() != version:
        raise WrongProgramError(_mismatch(get_worker().address, program_version(), version))
    with _TASK_LOCK:
        if code not in _PREPARED_TASKS:
            _PREPARED_TASKS.clear()  # the memory holds one robot at a time
            _PREPARED_TASKS[code] = pickle.loads(code)()
        began = monotonic()
        results = [_PREPARED_TASKS[code](task) for task in tasks]
        return _GroupResult(results, monotonic() - began)
