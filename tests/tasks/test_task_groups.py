"""Groups of tasks on a cluster, with a simulated dask client."""

import logging
import pickle
import sys
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from functools import partial
from types import SimpleNamespace

import pytest

from kinesic.body.config import ConfigError
from kinesic.tasks import cluster as cluster_module
from kinesic.tasks.cluster import (
    GROUP_TIME,
    GROUPS_PER_WORKER,
    MAX_GROUP_SIZE,
    MAX_TRIES,
    WORKER_COUNT_INTERVAL,
    Cluster,
    WrongProgramError,
    cluster,
)
from kinesic.tasks.processes import WorkerCrash
from kinesic.tasks.program import program_version

EVALUATE = partial(partial, eval)  # tasks are Python expressions


class KilledWorker(Exception):  # noqa: N818 - its name in dask
    """Stub of dask's error of a lost worker."""


class PlayedFuture:
    """Group of tasks that runs when the result of the group is requested."""

    def __init__(self, client: "PlayedClient", key: str, work: Callable[[], object]) -> None:
        self.client, self.key, self._work = client, key, work
        self.error: Exception | None = None
        self.value: object = None
        self.is_done = self.is_released = False

    def exception(self) -> Exception | None:
        if not self.is_done:
            self.is_done = True
            try:
                self.value = self._work()
            except (ArithmeticError, KilledWorker, OSError, WrongProgramError) as error:
                self.error = error
        return self.error

    def release(self) -> None:
        self.is_released = True


class PlayedClient:
    """Stub Dask client that runs a group when its result is requested."""

    def __init__(self, workers: int = 2, version: str | None = None) -> None:
        self.workers = {f"tcp://worker{k}": version or program_version() for k in range(workers)}
        self.scheduler = SimpleNamespace(addr="tcp://scheduler")
        self.cluster, self.dashboard_link = None, "http://dashboard"
        self.groups: list[tuple[str, ...]] = []
        self.cancelled: list[PlayedFuture] = []
        self.futures: list[PlayedFuture] = []
        self.queries = 0
        self.lost_results = 0
        self.fault: Callable[[tuple[str, ...]], None] = lambda _: None
        self.seconds = 0.0
        self.most_begun = 0

    def submit(self, work: Callable, code: bytes, tasks: tuple[str, ...], version: str, *, pure: bool) -> PlayedFuture:
        assert pure is False
        assert version == program_version()
        self.groups.append(tasks)

        def run() -> object:
            self.fault(tasks)
            result = work(code, tasks, version)
            return type(result)(result.results, self.seconds * len(tasks)) if self.seconds else result

        self.futures.append(PlayedFuture(self, f"key{len(self.futures)}", run))
        waiting = sum(not future.is_done for future in self.futures)
        self.most_begun = max(self.most_begun, waiting)
        return self.futures[-1]

    def gather(self, futures: list[PlayedFuture], errors: str) -> list[object]:
        assert errors == "skip"
        if self.lost_results:
            self.lost_results -= 1
            return []
        return [future.value for future in futures]

    def cancel(self, futures: list[PlayedFuture], *, force: bool) -> None:
        assert force
        self.cancelled += futures

    def scheduler_info(self, *, n_workers: int) -> dict[str, object]:
        assert n_workers == -1
        self.queries += 1
        return {"workers": self.workers}

    def wait_for_workers(self, count: int, timeout: float) -> None:
        assert count == 1
        if not self.workers:
            raise TimeoutError

    def run(self, ask: Callable[[], str]) -> dict[str, str]:
        assert ask() == program_version()
        return self.workers


class Completed:
    """Futures in the order in which the caller added them."""

    def __init__(self) -> None:
        self._waiting: list[PlayedFuture] = []

    def add(self, future: PlayedFuture) -> None:
        self._waiting.append(future)

    def __iter__(self) -> Iterator[PlayedFuture]:
        while self._waiting:
            yield self._waiting.pop(0)


@pytest.fixture(autouse=True)
def played_dask(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(
        sys.modules,
        "distributed",
        SimpleNamespace(
            as_completed=Completed, KilledWorker=KilledWorker, get_worker=lambda: SimpleNamespace(address="tcp://here")
        ),
    )


@pytest.fixture
def client() -> PlayedClient:
    return PlayedClient()


def run(client: PlayedClient, tasks: list[str]) -> list[tuple[str, object]]:
    return list(Cluster(client).run(tasks, EVALUATE))


def test_cluster_runs_every_task_once_and_releases_results(client: PlayedClient) -> None:
    tasks = [f"{k} ** 2" for k in range(200)]
    result = run(client, tasks)
    assert sorted(task for task, _ in result) == sorted(tasks)
    assert dict(result) == {task: k**2 for k, task in enumerate(tasks)}
    assert all(future.is_released for future in client.futures)
    assert client.cancelled == []


def test_number_of_task_groups_queued_per_worker_is_limited(client: PlayedClient) -> None:
    client.seconds = 10 * GROUP_TIME
    run(client, ["1"] * 100)
    assert client.most_begun == 2 * GROUPS_PER_WORKER
    assert {len(group) for group in client.groups} == {1}


@pytest.mark.parametrize(
    ("seconds", "size"), [(GROUP_TIME / 4.5, 4), (GROUP_TIME / 1.5, 1), (2 * GROUP_TIME, 1), (1e-9, MAX_GROUP_SIZE)]
)
def test_short_tasks_are_grouped_to_fill_a_target_time(client: PlayedClient, seconds: float, size: int) -> None:
    client.seconds = seconds
    run(client, ["1"] * 600)
    first, *others = client.groups
    assert len(first) == 1
    assert max(map(len, others)) == size


def test_task_is_still_submitted_if_all_workers_have_left_the_cluster(client: PlayedClient) -> None:
    engine = Cluster(client)
    client.workers.clear()
    assert dict(engine.run(["1 + 1"], EVALUATE)) == {"1 + 1": 2}


def test_failed_task_of_a_group_is_reported_alone(client: PlayedClient) -> None:
    client.seconds = 1e-9
    tasks = [*["1"] * 30, "1 / 0", *["2"] * 30]
    outcome = run(client, tasks)
    assert len(outcome) == len(tasks)
    (crash,) = [result for _, result in outcome if isinstance(result, WorkerCrash)]
    assert [task for task, result in outcome if result is crash] == ["1 / 0"]
    assert crash.reason == "it failed on the cluster with ZeroDivisionError: division by zero"
    assert not crash.is_killed
    assert client.groups.count(("1 / 0",)) == 1


@pytest.mark.parametrize(("kills", "is_done"), [(1, True), (MAX_TRIES - 1, True), (MAX_TRIES, False)])
def test_task_of_a_killed_worker_is_retried_up_to_a_maximum(client: PlayedClient, kills: int, is_done: bool) -> None:
    killed: list[tuple[str, ...]] = []

    def kill(tasks: tuple[str, ...]) -> None:
        if tasks == ("7",) and len(killed) < kills:
            killed.append(tasks)
            raise KilledWorker("lost")

    client.fault = kill
    (result,) = [result for task, result in run(client, ["5", "7"]) if task == "7"]
    assert (result == 7) == is_done
    assert is_done or result.is_killed
    assert client.groups.count(("7",)) == min(kills + 1, MAX_TRIES)


def test_task_error_without_a_message_has_a_reason(client: PlayedClient) -> None:
    def fail(_: tuple[str, ...]) -> None:
        raise OSError

    client.fault = fail
    ((_, crash),) = run(client, ["1"])
    assert crash.reason == "it failed on the cluster with OSError: no reason given"


def test_results_of_a_lost_worker_are_fetched_again(client: PlayedClient) -> None:
    client.lost_results = 2
    assert run(client, ["3"]) == [("3", 3)]


def test_late_worker_with_another_program_version_ends_the_run(client: PlayedClient) -> None:
    def refuse(_: tuple[str, ...]) -> None:
        raise WrongProgramError("worker x runs another kinesic")

    client.fault = refuse
    with pytest.raises(ConfigError, match="worker x runs another kinesic"):
        run(client, ["1", "2"])
    assert [future.key for future in client.cancelled] == ["key1"]


def test_remaining_tasks_are_cancelled_when_the_caller_stops(client: PlayedClient) -> None:
    results = Cluster(client).run(["1", "2", "3"], EVALUATE)
    assert next(results) == ("1", 1)
    results.close()
    assert [future.key for future in client.cancelled] == ["key1", "key2"]


def test_number_of_cluster_workers_is_cached_for_an_interval(client: PlayedClient, monkeypatch) -> None:
    now = [0.0]
    monkeypatch.setattr(cluster_module, "monotonic", lambda: now[0])
    client.seconds = GROUP_TIME
    results = Cluster(client).run(["1"] * 50, EVALUATE)
    for _ in range(10):
        next(results)
    assert client.queries == 1
    now[0] = WORKER_COUNT_INTERVAL + 0.01
    for _ in range(10):
        next(results)
    assert client.queries == 2


def test_cluster_without_workers_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"no workers; start some: dask worker tcp://scheduler"):
        Cluster(PlayedClient(workers=0))


def test_cluster_worker_of_another_program_version_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"(?s)worker tcp://worker0 .*there: other.*here:  ") as refused:
        Cluster(PlayedClient(version="other"))
    assert str(refused.value).endswith(program_version())


def test_cluster_description_gives_the_worker_count_and_a_remote_dashboard(client: PlayedClient) -> None:
    assert Cluster(client).place == "2 workers, dashboard http://dashboard"
    client.dashboard_link = None
    assert Cluster(client).place == "2 workers"
    client.cluster, client.dashboard_link = object(), "http://dashboard"
    assert Cluster(client).place == "2 workers"


def test_missing_dask_is_reported_with_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ConfigError, match=r"--cluster needs distributed: .*pip install"), cluster("local:1"):
        pass


def test_worker_runs_a_pickled_task_function_and_refuses_another_program_version(client: PlayedClient) -> None:
    code = pickle.dumps(EVALUATE)
    result = cluster_module._run_group(code, ("2 + 2", "3"), program_version())
    assert result.results == [4, 3]
    assert result.seconds > 0.0
    with pytest.raises(WrongProgramError, match=r"worker tcp://here runs another kinesic"):
        cluster_module._run_group(code, ("1",), "another version")


def test_log_of_dask_is_silent_while_a_cluster_is_open(monkeypatch: pytest.MonkeyPatch, client: PlayedClient) -> None:
    """Results report dead workers, so the log of dask need not."""
    log = logging.getLogger("distributed")
    monkeypatch.setattr(log, "level", logging.WARNING)
    monkeypatch.setitem(sys.modules, "distributed", SimpleNamespace())
    monkeypatch.setattr(cluster_module, "open_client", lambda *_, **__: nullcontext(client))
    with cluster("local:1"):
        assert log.level == logging.CRITICAL
