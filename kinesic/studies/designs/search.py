"""Searches designs by successive halving: all perform a few documents, the best of them more, and a few perform all."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import ceil

import numpy as np

from kinesic.body.config import ConfigError
from kinesic.studies.designs.pareto import rank
from kinesic.studies.designs.trial import DesignTask, Trial, prepare_trials
from kinesic.studies.designs.variant import Design
from kinesic.tasks.engine import Engine
from kinesic.tasks.journal import Journal, run_once
from kinesic.tasks.processes import WorkerCrash

SHARE = 3  # of the designs one goes on, with so many times the documents
FEWEST_DESIGNS = 8  # designs that go on, where there are so many
AS_IT_IS: Design = ()

NamedDocument = tuple[str, bytes]  # name and content


@dataclass(frozen=True)
class Round:
    """One round of a search."""

    documents: int  # that each design has performed by then
    designs: int  # that took part


@dataclass(frozen=True)
class SearchResult:
    """What a search has found."""

    finished: tuple[Trial, ...]  # that performed all documents, the best first; the robot as it is is among them
    left: tuple[Trial, ...]  # that were left behind on the way
    out: tuple[Trial, ...]  # that cannot be built, collide or do not hold themselves; each says why
    rounds: tuple[Round, ...]


def document_steps(documents: Sequence[NamedDocument], *, seed: int = 0) -> list[list[NamedDocument]]:
    """Parts documents, in random order, into what each round adds: a third of the next round's, and so on."""
    order = np.random.default_rng(seed).permutation(len(documents))
    ends, count = [len(documents)], len(documents)
    while count > 1 and len(ends) < 3:
        count = ceil(count / SHARE)
        ends.insert(0, count)
    starts = [0, *ends[:-1]]
    return [[documents[k] for k in order[start:end]] for start, end in zip(starts, ends, strict=True)]


def search(
    robot: str,
    designs: Sequence[Design],
    documents: Sequence[NamedDocument],
    *,
    engine: Engine,
    style: str = "neutral",
    settings: str = "",
    journal: Journal[Trial] | None = None,
    seed: int = 0,
    stage: Callable[[str, float | None], None] = lambda words, share: None,
) -> SearchResult:
    """Tries designs of a robot, which is always among them as it is.

    Args:
        robot: its name, or its TOML file.
        designs: to be tried.
        documents: that they perform.
        engine: does it.
        style: of all documents.
        settings: everything beside designs and documents that results depend on.
        journal: of the run, which goes on where it stopped; None: nothing is remembered.
        seed: of the order of the documents.
        stage: is told what is done, and how much of it is over.

    Raises:
        ConfigError: the robot as it is is out, or it kills its process.
    """

    def run(tried: Sequence[Design], some: Sequence[NamedDocument], words: str) -> Iterator[Trial]:
        tasks = [DesignTask(design, tuple(some), settings) for design in tried]
        results = run_once(
            {task: task.key for task in tasks},
            partial(prepare_trials, robot, style),
            engine,
            journal,
            keep=lambda task, trial: trial,
            forgets=False,
            preload=__name__,
        )
        for number, (task, result) in enumerate(results, 1):
            stage(words, number / len(tasks))
            yield Trial(task.design, result.reason) if isinstance(result, WorkerCrash) else result

    if journal:
        journal.rewrite(journal.read())  # without the line that a killed run began
    every = list(dict.fromkeys([AS_IT_IS, *designs]))
    place = {design: number for number, design in enumerate(every)}
    weighed = sorted(run(every, (), "weighing designs"), key=lambda trial: place[trial.design])
    out = [trial for trial in weighed if trial.out]
    _check_base(weighed[0], robot)
    going = [trial for trial in weighed if not trial.out]
    left: list[Trial] = []
    rounds: list[Round] = []
    for number, some in enumerate(steps := document_steps(documents, seed=seed), 1):
        rounds.append(Round(sum(map(len, steps[:number])), len(going)))
        added = {trial.design: trial for trial in run([t.design for t in going], some, f"round {number}")}
        _check_base(added[AS_IT_IS], robot)
        out += [replace(trial, out=added[trial.design].out) for trial in going if added[trial.design].out]
        going = [
            replace(trial, documents=trial.documents + added[trial.design].documents)
            for trial in going
            if not added[trial.design].out
        ]
        going = rank(going, next(trial for trial in going if trial.design == AS_IT_IS))
        if number < len(steps):
            keep = max(FEWEST_DESIGNS, ceil(len(going) / SHARE))
            best = going[:keep] + [trial for trial in going[keep:] if trial.design == AS_IT_IS]
            left += [trial for trial in going if trial not in best]
            going = best
    return SearchResult(tuple(going), tuple(left), tuple(out), tuple(rounds))


def _check_base(base: Trial, robot: str) -> None:
    """Refuses a search whose robot itself is out, so that nothing can be compared with it."""
    if base.out:
        raise ConfigError(f"{robot} itself is out: {base.out}")
