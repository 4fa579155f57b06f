"""Search of robot designs by successive halving.

All designs perform a few documents, the best of them more, and a few designs all documents.
"""

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

HALVING_RATIO = 3  # ratio of designs, and of documents, between successive rounds of halving
MIN_DESIGNS = 8  # smallest number of designs that continue after a round
BASE_DESIGN: Design = ()  # design of the unchanged robot

NamedDocument = tuple[str, bytes]  # name and content


@dataclass(frozen=True)
class Round:
    """Numbers of designs and documents in one round of successive halving."""

    documents: int  # documents performed by each design up to and including this round
    designs: int  # number of designs in the round


@dataclass(frozen=True)
class SearchResult:
    """Finished, eliminated and rejected robot designs of a search."""

    finished: tuple[Trial, ...]  # performed all documents, best first; includes the unchanged robot
    left: tuple[Trial, ...]  # eliminated in earlier rounds
    out: tuple[Trial, ...]  # cannot be built, collide or cannot hold themselves; each gives its reason
    rounds: tuple[Round, ...]


def document_steps(documents: Sequence[NamedDocument], *, seed: int = 0) -> list[list[NamedDocument]]:
    """Split shuffled documents into groups, one added in each halving round.

    The rounds use a ninth, a third and all of the documents.
    """
    order = np.random.default_rng(seed).permutation(len(documents))
    ends, count = [len(documents)], len(documents)
    while count > 1 and len(ends) < 3:
        count = ceil(count / HALVING_RATIO)
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
    """Find the best designs of a robot by successive halving.

    The unchanged robot is always included.

    Args:
        robot: name or TOML file of the robot.
        designs: designs to try.
        documents: documents to perform.
        engine: engine that runs the tasks.
        style: style of all documents.
        settings: everything that affects the results in addition to designs and documents.
        journal: journal of the run, which resumes where it stopped; None: no journal.
        seed: seed of the order of the documents.
        stage: callback with a text and the completed fraction.

    Raises:
        ConfigError: the unchanged robot is rejected, or it crashes its process.
    """

    def run(designs_to_try: Sequence[Design], added_documents: Sequence[NamedDocument], words: str) -> Iterator[Trial]:
        tasks = [DesignTask(design, tuple(added_documents), settings) for design in designs_to_try]
        results = run_once(
            {task: task.key for task in tasks},
            lambda left: engine.run(left, partial(prepare_trials, robot, style), preload=__name__),
            journal,
            keep=lambda task, trial: trial,
            forgets=False,
        )
        for number, (task, result) in enumerate(results, 1):
            stage(words, number / len(tasks))
            yield Trial(task.design, result.reason) if isinstance(result, WorkerCrash) else result

    if journal:
        journal.rewrite(journal.read())  # drops a line that a killed run left incomplete
    all_designs = list(dict.fromkeys([BASE_DESIGN, *designs]))
    order = {design: number for number, design in enumerate(all_designs)}
    body_trials = sorted(run(all_designs, (), "weighing designs"), key=lambda trial: order[trial.design])
    out = [trial for trial in body_trials if trial.out]
    _check_base(body_trials[0], robot)
    remaining = [trial for trial in body_trials if not trial.out]
    left: list[Trial] = []
    rounds: list[Round] = []
    for number, added_documents in enumerate(steps := document_steps(documents, seed=seed), 1):
        rounds.append(Round(sum(map(len, steps[:number])), len(remaining)))
        added = {
            trial.design: trial for trial in run([t.design for t in remaining], added_documents, f"round {number}")
        }
        _check_base(added[BASE_DESIGN], robot)
        out += [replace(trial, out=added[trial.design].out) for trial in remaining if added[trial.design].out]
        remaining = [
            replace(trial, documents=trial.documents + added[trial.design].documents)
            for trial in remaining
            if not added[trial.design].out
        ]
        remaining = rank(remaining, next(trial for trial in remaining if trial.design == BASE_DESIGN))
        if number < len(steps):
            kept_count = max(MIN_DESIGNS, ceil(len(remaining) / HALVING_RATIO))
            best = remaining[:kept_count] + [trial for trial in remaining[kept_count:] if trial.design == BASE_DESIGN]
            left += [trial for trial in remaining if trial not in best]
            remaining = best
    return SearchResult(tuple(remaining), tuple(left), tuple(out), tuple(rounds))


def _check_base(base: Trial, robot: str) -> None:
    """Raise an error if the unchanged robot is rejected as a design."""
    if base.out:
        raise ConfigError(f"{robot} itself is rejected: {base.out}")
