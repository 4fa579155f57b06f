"""Measures engines of tasks: what a task costs beside its work, and how much more is done by more workers.

Dry runs of a second are done by one worker and by more, in processes and on dask, as fast as they can. It counts from
the moment at which every worker is at work. On a busy machine only the CPU of who calls and of a worker tell something.
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

from kinesic.bench.figure import Figure
from kinesic.controller.perform import set_up
from kinesic.report.batch import DocumentVerdict, judge
from kinesic.tasks.engine import Engine, Processes

NOD = '<head id="h" lexeme="NOD" start="0.1" end="{}"/>'
BLOCK = f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{NOD}</bml>'
SHARE = 180  # documents for each worker
ROUNDS = 3  # of one and of two workers, in turn; of more only one
EMPTY = 400  # tasks without work
TAIL = 20  # tasks for each worker that do not count: in the end some workers are idle
EFFICIENT, PAIR = 0.9, 2  # goal with so many workers
NO_DASK = "dask.distributed is not installed: pip install 'kinesic[cluster]'"
READY = "import distributed.worker, kinesic.report.batch; from kinesic.controller.perform import set_up; set_up()"
CLOCK = "\nimport time; print(time.process_time())"


@dataclass(frozen=True)
class Done:
    """A task that a worker has done."""

    worker: int
    began: float  # [s] of CPU that the worker had taken by then
    ended: float
    verdict: DocumentVerdict | None


@dataclass(frozen=True)
class Pace:
    """How fast workers were."""

    rate: float  # [1/s] tasks
    work: float  # [s] of CPU of a task itself
    beside: float  # [s] of CPU that its worker took beside it
    caller: float  # [s] of CPU that it took from who called
    ready: float  # [s] of CPU until a worker was at its first task


def bench() -> list[Figure]:
    """Measures both engines, with one worker, two, four, and so on, as many as this machine has cores."""
    counts = [2**power for power in range(5) if 2**power <= max(os.cpu_count() or 1, PAIR)]
    figures = [*_figures("processes", counts, lambda count: nullcontext(Processes(count)))]
    if find_spec("distributed") is None:
        return [*figures, Figure("cluster.dask", None, "", None, "lower", NO_DASK)]
    return [*figures, *_figures("dask", counts, _dask), _fresh()]


def _dask(count: int) -> AbstractContextManager[Engine]:
    from kinesic.tasks.cluster import cluster  # noqa: PLC0415 - an extra

    return cluster(f"local:{count}")


def _figures(
    name: str, counts: Iterable[int], engine_of: Callable[[int], AbstractContextManager[Engine]]
) -> list[Figure]:
    paces: dict[int, list[Pace]] = {count: [] for count in counts}
    for lap in range(ROUNDS):
        for count, found in paces.items():
            if count <= PAIR or not lap:
                with engine_of(count) as engine:
                    found.append(pace(engine, _prepare, [f"{0.8 + 1e-4 * k:.4f}" for k in range(SHARE * count)], count))
    with engine_of(1) as engine:
        empty = pace(engine, _idle, [str(k) for k in range(EMPTY)], 1)
    alone, begun = median(each.rate for each in paces[1]), median(each.ready for each in paces[1])
    figures = [
        Figure(f"cluster.{name}.empty_caller", 1000 * empty.caller, "ms", None, "lower", "CPU, a task without work"),
        Figure(f"cluster.{name}.empty_worker", 1000 * empty.beside, "ms", None, "lower", "likewise"),
        Figure(f"cluster.{name}.begin", begun, "s", None, "lower", "CPU of a worker until its first task"),
    ]
    for count, found in paces.items():
        kind, rate = f"cluster.{name}.{count}", median(each.rate for each in found)
        goal = EFFICIENT if count == PAIR else None
        middle = sorted(found, key=lambda each: each.work)[len(found) // 2]
        figures += [
            Figure(f"{kind}.rate", rate, "tasks/s", None, "higher"),
            Figure(f"{kind}.efficiency", rate / alone / count, "share", goal, "higher", "of the rate of one worker"),
            Figure(f"{kind}.work", 1000 * middle.work, "ms", None, "lower", "CPU of a task itself"),
            Figure(f"{kind}.worker", 1000 * middle.beside, "ms", None, "lower", "CPU of its worker beside it"),
            Figure(f"{kind}.caller", 1000 * middle.caller, "ms", None, "lower", "CPU of who called, a task"),
        ]
    return figures


def pace(engine: Engine, prepare: Callable[[], Callable[[str], Done]], tasks: list[str], workers: int) -> Pace:
    """Has workers do tasks, and measures from the moment at which each has done one until they run out of tasks."""
    seen: Counter[int] = Counter()
    counted: list[Done] = []
    ready: list[float] = []
    began, called, over, spent = 0.0, 0.0, 0.0, 0.0
    last = len(tasks) - TAIL * workers
    for number, (task, done) in enumerate(engine.run(tasks, prepare, preload=__name__), 1):
        if not isinstance(done, Done):
            raise RuntimeError(f"{task}: {done.reason}")
        if done.worker not in seen:
            ready.append(done.began)
        seen[done.worker] += 1
        if began and number <= last:
            counted.append(done)
        if not began and len(seen) == workers:
            began, called = monotonic(), process_time()
        if number <= last:
            over, spent = monotonic(), process_time()
    count = max(1, len(counted))
    work = sum(done.ended - done.began for done in counted)
    taken = 0.0
    for worker in seen:
        own = sorted((done for done in counted if done.worker == worker), key=lambda done: done.began)
        taken += own[-1].began - own[0].began - sum(done.ended - done.began for done in own[:-1]) if own else 0.0
    return Pace(count / max(over - began, 1e-9), work / count, taken / count, (spent - called) / count, median(ready))


def _prepare() -> Callable[[str], Done]:
    known = set_up()

    def do(end: str) -> Done:
        began = process_time()
        verdict, _ = judge(Path(f"{end}.bml"), known, content=BLOCK.format(end).encode())
        return Done(os.getpid(), began, process_time(), verdict)

    return do


def _idle() -> Callable[[str], Done]:
    def do(task: str) -> Done:
        now = process_time()
        return Done(os.getpid(), now, now, None)

    return do


def _fresh() -> Figure:
    """[s] of CPU that a worker takes to begin which is no fork."""
    text = subprocess.run([sys.executable, "-c", READY + CLOCK], stdout=subprocess.PIPE, check=True, text=True).stdout
    return Figure("cluster.dask.begin_afresh", float(text), "s", None, "lower", "CPU, where workers are no forks")
