"""Benchmark of the task engines: throughput and CPU time per task.

It measures overhead of a task and speed-up by more workers.

One or several workers dry-run one-second documents as fast as they can, in processes and on dask. The measurement
starts when every worker has finished a task. On a busy machine only the CPU times of the caller and of a worker are
reliable.
"""

import os
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from time import monotonic, process_time

from kinesic.bench.metric import Metric
from kinesic.extras import install_extra
from kinesic.report.batch import DocumentVerdict, judge_document
from kinesic.session.setup import set_up
from kinesic.tasks.engine import Engine, Processes

NOD_TEMPLATE = '<head id="h" lexeme="NOD" start="0.1" end="{}"/>'
BLOCK_TEMPLATE = f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{NOD_TEMPLATE}</bml>'
TASKS_PER_WORKER = 180  # planned documents per worker and measurement
MEASUREMENT_ROUNDS = 3  # alternating measurements with one and two workers; more workers are measured once
EMPTY_TASKS = 400  # tasks without work, which measure the engine's overhead
IGNORED_TAIL_TASKS = 20  # number of last tasks per worker that are not counted, as some workers are idle then
MIN_EFFICIENCY = 0.9  # throughput per worker relative to a single worker, with GOAL_WORKERS workers
GOAL_WORKERS = 2  # number of workers at which MIN_EFFICIENCY is required
WORKER_IMPORTS = "import distributed.worker, kinesic.report.batch; from kinesic.session.setup import set_up; set_up()"
PRINT_CPU_TIME = "\nimport time; print(time.process_time())"


@dataclass(frozen=True)
class CompletedTask:
    """CPU times and verdict of a task that a worker completed."""

    worker: int  # index of the worker
    began: float  # [s] CPU time of the worker at the start of the task
    ended: float  # [s] CPU time of the worker at the end of the task
    verdict: DocumentVerdict | None  # result of the task; None: no document was planned


@dataclass(frozen=True)
class Throughput:
    """Task throughput of some workers, and CPU time per task."""

    rate: float  # tasks completed [1/s]
    work: float  # [s] CPU time of a task itself
    overhead: float  # [s] CPU time of the worker per task in addition to the task itself
    caller: float  # [s] CPU time of the caller per task
    startup: float  # [s] CPU time of a worker until its first task


def bench() -> list[Metric]:
    """Measure both task engines with increasing numbers of workers."""
    counts = [2**power for power in range(5) if 2**power <= max(os.cpu_count() or 1, GOAL_WORKERS)]
    metrics = [*_metrics("processes", counts, lambda count: nullcontext(Processes(count)))]
    if find_spec("distributed") is None:
        why = f"dask.distributed is not installed: {install_extra('cluster')}"
        return [*metrics, Metric("cluster.dask", None, "", None, "lower", why)]
    return [*metrics, *_metrics("dask", counts, _open_dask), _measure_start()]


def _open_dask(count: int) -> AbstractContextManager[Engine]:
    from kinesic.tasks.cluster import cluster  # noqa: PLC0415 - optional dependency

    return cluster(f"local:{count}")


def _metrics(
    name: str, counts: Iterable[int], engine_of: Callable[[int], AbstractContextManager[Engine]]
) -> list[Metric]:
    runs_by_count: dict[int, list[Throughput]] = {count: [] for count in counts}
    for measurement in range(MEASUREMENT_ROUNDS):
        for count, runs in runs_by_count.items():
            if count <= GOAL_WORKERS or not measurement:
                with engine_of(count) as engine:
                    runs.append(
                        measure_throughput(
                            engine, _prepare, [f"{0.8 + 1e-4 * k:.4f}" for k in range(TASKS_PER_WORKER * count)], count
                        )
                    )
    with engine_of(1) as engine:
        empty = measure_throughput(engine, _idle, [str(k) for k in range(EMPTY_TASKS)], 1)
    single, begun = median(run.rate for run in runs_by_count[1]), median(run.startup for run in runs_by_count[1])
    metrics = [
        Metric(f"cluster.{name}.empty_caller", 1000 * empty.caller, "ms", None, "lower", "CPU per empty task"),
        Metric(f"cluster.{name}.empty_worker", 1000 * empty.overhead, "ms", None, "lower", "CPU per empty task"),
        Metric(f"cluster.{name}.begin", begun, "s", None, "lower", "CPU of a worker until its first task"),
    ]
    for count, runs in runs_by_count.items():
        kind, rate = f"cluster.{name}.{count}", median(run.rate for run in runs)
        goal = MIN_EFFICIENCY if count == GOAL_WORKERS else None
        middle = sorted(runs, key=lambda run: run.work)[len(runs) // 2]
        metrics += [
            Metric(f"{kind}.rate", rate, "tasks/s", None, "higher"),
            Metric(
                f"{kind}.efficiency", rate / single / count, "share", goal, "higher", "of the rate of a single worker"
            ),
            Metric(f"{kind}.work", 1000 * middle.work, "ms", None, "lower", "CPU of a task itself"),
            Metric(
                f"{kind}.worker",
                1000 * middle.overhead,
                "ms",
                None,
                "lower",
                "worker CPU per task in addition to the task",
            ),
            Metric(f"{kind}.caller", 1000 * middle.caller, "ms", None, "lower", "CPU of the caller per task"),
        ]
    return metrics


def measure_throughput(
    engine: Engine, prepare: Callable[[], Callable[[str], CompletedTask]], tasks: list[str], workers: int
) -> Throughput:
    """Run tasks and measure the throughput after all workers have started.

    The measurement ends `IGNORED_TAIL_TASKS` tasks per worker before the last one.
    """
    seen: Counter[int] = Counter()
    counted: list[CompletedTask] = []
    ready: list[float] = []
    began, called, counted_until, spent = 0.0, 0.0, 0.0, 0.0
    last = len(tasks) - IGNORED_TAIL_TASKS * workers
    for number, (task, done) in enumerate(engine.run(tasks, prepare, preload=__name__), 1):
        if not isinstance(done, CompletedTask):
            raise RuntimeError(f"{task}: {done.reason}")
        if done.worker not in seen:
            ready.append(done.began)
        seen[done.worker] += 1
        if began and number <= last:
            counted.append(done)
        if not began and len(seen) == workers:
            began, called = monotonic(), process_time()
        if number <= last:
            counted_until, spent = monotonic(), process_time()
    count = max(1, len(counted))
    work = sum(done.ended - done.began for done in counted)
    taken = 0.0
    for worker in seen:
        chain = sorted((done for done in counted if done.worker == worker), key=lambda done: done.began)
        taken += (
            chain[-1].began - chain[0].began - sum(done.ended - done.began for done in chain[:-1]) if chain else 0.0
        )
    return Throughput(
        count / max(counted_until - began, 1e-9), work / count, taken / count, (spent - called) / count, median(ready)
    )


def _prepare() -> Callable[[str], CompletedTask]:
    setup = set_up()

    def do(end: str) -> CompletedTask:
        began = process_time()
        verdict, _ = judge_document(Path(f"{end}.bml"), setup, content=BLOCK_TEMPLATE.format(end).encode())
        return CompletedTask(os.getpid(), began, process_time(), verdict)

    return do


def _idle() -> Callable[[str], CompletedTask]:
    def do(task: str) -> CompletedTask:
        now = process_time()
        return CompletedTask(os.getpid(), now, now, None)

    return do


def _measure_start() -> Metric:
    """Measure the CPU time [s] to start a new worker."""
    text = subprocess.run(
        [sys.executable, "-c", WORKER_IMPORTS + PRINT_CPU_TIME], stdout=subprocess.PIPE, check=True, text=True
    ).stdout
    return Metric("cluster.dask.begin_afresh", float(text), "s", None, "lower", "CPU, for workers that are not forked")
