"""Does tasks on a cluster of dask.distributed: a scheduler that is there, or some workers on this machine.

Quick tasks are handed out in groups that take a tenth of a second. A group that fails, or whose worker dies, is done
again task by task, so that a crash is told of the one task that causes it.
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
from kinesic.tasks.dask_access import Certificates, open_client
from kinesic.tasks.processes import WorkerCrash
from kinesic.tasks.program import program_version

if TYPE_CHECKING:
    from distributed import Client, Future

Task = TypeVar("Task")
Result = TypeVar("Result")

SCHEDULER_TIMEOUT = 10  # [s] for a scheduler to answer, and for its first worker
GROUPS_AHEAD = 8  # groups for each worker that the scheduler has: workers hardly wait, and its memory stays small
GROUP_TIME = 0.1  # [s] of work that is handed out as one group: dask takes 5 ms for each group
MOST_IN_GROUP = 32  # tasks
ASK_AGAIN = 2.0  # [s] how many workers there are
TRIES = 3  # of a task whose workers die; a scheduler gives one up after some deaths, and strangers kill workers, too


class Cluster:
    """An engine whose workers are processes of dask, here or elsewhere."""

    def __init__(self, client: "Client") -> None:
        """Takes a client that is connected.

        Raises:
            ConfigError: there is no worker, or one runs another program.
        """
        self._client = client
        _check_workers(client)

    @property
    def place(self) -> str:
        """Number of workers, and the dashboard of a scheduler that has one."""
        link = self._client.cluster is None and self._client.dashboard_link  # local workers have none: HTTP has no TLS
        return f"{self._workers()} workers{f', dashboard {link}' if link else ''}"

    def run(
        self, tasks: Iterable[Task], prepare: Callable[[], Callable[[Task], Result]], *, preload: str = ""
    ) -> Generator[tuple[Task, Result | WorkerCrash], None, None]:
        """Yields tasks with their results, in the order in which they are ready; see `Engine`."""
        from distributed import as_completed  # noqa: PLC0415 - slow to import, and only clusters need it

        code, left, workers = pickle.dumps(prepare), iter(tasks), _Count(self._workers)
        begun: dict[str, _Begun[Task]] = {}
        ready, done, spent = as_completed(), 0, 0.0
        try:
            for future in self._more(code, left, begun, workers.now(), size=1):
                ready.add(future)
            for future in ready:
                group = begun.pop(future.key)
                found: _Found[Result] | WorkerCrash = _result(future)
                future.release()
                if isinstance(found, WorkerCrash) and group.may_try_again(found):
                    for task in group.tasks:  # one by one, as one of them may be to blame
                        ready.add(self._begin(code, (task,), begun, group.tries + 1))
                    continue
                if not isinstance(found, WorkerCrash):
                    done, spent = done + len(found.results), spent + found.seconds
                size = _group_size(done, spent)
                for more in self._more(code, left, begun, workers.now(), size=size):
                    ready.add(more)
                yield from zip(group.tasks, [found] if isinstance(found, WorkerCrash) else found.results, strict=True)
        finally:
            self._client.cancel([one.future for one in begun.values()], force=True)

    def _more(
        self, code: bytes, left: Iterator[Task], begun: "dict[str, _Begun[Task]]", workers: int, *, size: int
    ) -> "Iterator[Future]":
        """Sends as many of the tasks that are left as the workers want, in groups of a size."""
        while len(begun) < GROUPS_AHEAD * max(1, workers):
            tasks = tuple(islice(left, size))
            if not tasks:
                return
            yield self._begin(code, tasks, begun, 1)

    def _begin(self, code: bytes, tasks: tuple[Task, ...], begun: "dict[str, _Begun[Task]]", tries: int) -> "Future":
        future = self._client.submit(_do, code, tasks, program_version(), pure=False)  # with a key of its own
        begun[future.key] = _Begun(tasks, future, tries)
        return future

    def _workers(self) -> int:
        return len(self._client.scheduler_info(n_workers=-1)["workers"])


@dataclass(frozen=True)
class _Begun(Generic[Task]):
    """A group of tasks that workers have."""

    tasks: tuple[Task, ...]
    future: "Future"
    tries: int  # this one is counted

    def may_try_again(self, crash: WorkerCrash) -> bool:
        """Says whether its tasks may be tried again, each alone."""
        return len(self.tasks) > 1 or (crash.is_killed and self.tries < TRIES)


@dataclass(frozen=True)
class _Found(Generic[Result]):
    """What a worker found for a group."""

    results: list[Result]
    seconds: float  # [s] that it took


def _group_size(done: int, spent: float) -> int:
    """Counts the tasks that take as long as a group should, when some that are done have spent so long [s]."""
    return max(1, min(MOST_IN_GROUP, int(GROUP_TIME * done / spent))) if spent > 0.0 else 1


class _Count:
    """How many workers there are, asked once in a while: asking takes longer than sending a task."""

    def __init__(self, ask: Callable[[], int]) -> None:
        self._ask = ask
        self._count, self._asked = ask(), monotonic()

    def now(self) -> int:
        if monotonic() - self._asked > ASK_AGAIN:
            self._count, self._asked = self._ask(), monotonic()
        return self._count


@contextmanager
def cluster(address: str, *, certificates: Certificates | None = None, insecure: bool = False) -> Iterator[Cluster]:
    """Open a cluster, and close all that it began.

    Args:
        address: of a scheduler, or local:N.
        certificates: for a scheduler elsewhere; None: those that dask's configuration names.
        insecure: whether a scheduler without TLS is accepted.

    Raises:
        ConfigError: dask is not installed, nobody answers, the connection would not be authenticated, or a worker runs
            another program.
    """
    try:
        import distributed  # noqa: F401, PLC0415 - an extra
    except ModuleNotFoundError as error:
        raise ConfigError(f"--cluster needs {error.name}: pip install 'kinesic[cluster]'") from None
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # results tell of workers that die
    with open_client(address, timeout=SCHEDULER_TIMEOUT, certificates=certificates, insecure=insecure) as client:
        yield Cluster(client)


def _check_workers(client: "Client") -> None:
    """Refuses a cluster without workers, or with workers whose results would be others than ours."""
    try:
        client.wait_for_workers(1, timeout=SCHEDULER_TIMEOUT)
    except TimeoutError:
        raise ConfigError(f"the cluster has no workers; start some: dask worker {client.scheduler.addr}") from None
    for worker, found in client.run(_own_version).items():
        if found != program_version():
            raise ConfigError(_mismatch(worker, found, program_version()))


def _own_version() -> str:
    return program_version()  # of the process that calls it


def _mismatch(worker: str, theirs: str, ours: str) -> str:
    return f"worker {worker} runs another kinesic, install this one there\n  there: {theirs}\n  here:  {ours}"


def _result(future: "Future[_Found[Result]]") -> _Found[Result] | WorkerCrash:
    """Fetches the results of a group, or says why there are none.

    Raises:
        ConfigError: the worker, which came later than the others, runs another program.
    """
    from distributed import KilledWorker  # noqa: PLC0415 - slow to import, and only clusters need it

    while (error := future.exception()) is None:
        # The worker that has the results may die now: another one does the tasks again, and that may fail.
        found: list[_Found[Result]] = future.client.gather([future], errors="skip")
        if found:
            return found[0]
    if isinstance(error, WrongProgramError):
        raise ConfigError(str(error))
    words = str(error).strip().splitlines() or ["no reason is known"]
    reason = f"it failed on the cluster with {type(error).__name__}: {words[0]}"
    return WorkerCrash(reason, str(error), isinstance(error, KilledWorker))


class WrongProgramError(Exception):
    """A worker runs another program than who sent it the task."""


_ONE_AT_A_TIME = Lock()  # a robot's model is for one thread
_PREPARED: dict[bytes, Callable[[object], object]] = {}


def _do(code: bytes, tasks: tuple[object, ...], version: str) -> _Found[object]:
    """Does a group of tasks in a worker, which prepares for tasks of their kind when it gets the first of them."""
    from distributed import get_worker  # noqa: PLC0415 - slow to import, and only clusters need it

    if program_version() != version:
        raise WrongProgramError(_mismatch(get_worker().address, program_version(), version))
    with _ONE_AT_A_TIME:
        if code not in _PREPARED:
            _PREPARED.clear()  # one robot at a time is enough memory
            _PREPARED[code] = pickle.loads(code)()
        began = monotonic()
        results = [_PREPARED[code](task) for task in tasks]
        return _Found(results, monotonic() - began)
