"""Plan all gestures in all styles and the documents of a corpus near people.

Every plan is compared with the plan without a policy. MuJoCo's Jacobians and mass matrix judge its contacts.
"""

from collections.abc import Callable, Iterable, Iterator
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from kinesic.bench.blocks import find_corpus, plan_corpus
from kinesic.bench.contact import COMPARED_ROBOTS, DOCUMENT_COUNT, ComparedPlan, compare_plans
from kinesic.bench.contact.collisions import GESTURE_BLOCK
from kinesic.bml.block import Block
from kinesic.body.choices import Audience
from kinesic.body.config import names_of
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.session.documents import read_block
from kinesic.session.setup import set_up
from kinesic.tasks.engine import Engine
from kinesic.tasks.journal import Journal, run_once
from kinesic.tasks.processes import WorkerCrash
from kinesic.tasks.program import program_version

GESTURES_PER_TASK = 14  # number of gestures planned between two entries of the journal
DOCUMENTS_PER_TASK = 10  # number of documents planned between two entries of the journal
DOCUMENTS = "documents"  # content of tasks that plan documents instead of the gestures of a style
STRETCH_TOLERANCE = 1.005  # smallest duration with a policy / duration without it that counts as stretched


class NearTask(NamedTuple):
    """Some gestures in one style, or some documents, of one robot."""

    robot: str
    content: str  # name of a style, or `DOCUMENTS`
    start: int  # index of the first gesture or document
    near: Audience


def list_tasks(near: Audience) -> Iterator[NearTask]:
    """Yield all tasks in an order that alternates robots and styles."""
    for start in range(0, DOCUMENT_COUNT, DOCUMENTS_PER_TASK):
        yield from (NearTask(robot, DOCUMENTS, start, near) for robot in COMPARED_ROBOTS)
    for start in range(0, len(set_up().lexicon.forms), GESTURES_PER_TASK):
        for style in names_of("style"):
            yield from (NearTask(robot, style, start, near) for robot in COMPARED_ROBOTS)


def run_task(task: NearTask) -> list[ComparedPlan]:
    """Plan the blocks of a task without and with the policy."""
    if task.content == DOCUMENTS:
        setup, blocks = set_up(task.robot), _read_documents(task.robot)
        blocks = blocks[task.start : task.start + DOCUMENTS_PER_TASK]
    else:
        setup = set_up(task.robot, style=task.content)
        lexemes = sorted(form.id for form in setup.lexicon.forms)[task.start : task.start + GESTURES_PER_TASK]
        blocks = [_read_gesture(lexeme, setup) for lexeme in lexemes]
    return compare_plans(blocks, setup, near=task.near)


def _read_gesture(lexeme: str, setup: Setup) -> Block:
    return read_block(GESTURE_BLOCK.format(lexeme), setup, source=f"{lexeme} ({setup.style.name})")


@lru_cache(maxsize=len(COMPARED_ROBOTS))
def _read_documents(robot: str) -> list[Block]:
    corpus = find_corpus()
    setup = set_up(robot)
    return [] if corpus is None else [p.timeline.block for p in plan_corpus(corpus, setup, DOCUMENT_COUNT)]


def run_tasks(
    tasks: Iterable[NearTask], engine: Engine, path: Path | None
) -> Iterator[tuple[NearTask, list[ComparedPlan] | WorkerCrash]]:
    """Run the tasks that the journal at a path does not contain yet."""
    version = program_version()
    keys = {task: f"{' '.join(map(str, task))} {version}" for task in tasks}
    journal = None if path is None else Journal(path, list[ComparedPlan])
    yield from run_once(
        keys,
        lambda left: engine.run(left, prepare, preload="tests.campaign.near_people"),
        journal,
        keep=lambda _, result: result,
        forgets=False,
    )


def prepare() -> Callable[[NearTask], list[ComparedPlan]]:
    """Return the function with which workers run a task."""
    return run_task


def plan_near_people(near: Audience, engine: Engine, path: Path | None) -> tuple[list[str], list[str]]:
    """Plan all blocks near an audience.

    Returns the lines of a table, and one line for each plan beyond a limit or crash.
    """
    results: dict[NearTask, list[ComparedPlan]] = {}
    failures: list[str] = []
    for task, result in run_tasks(list(list_tasks(near)), engine, path):
        if isinstance(result, WorkerCrash):
            failures.append(f"{task}: {result.reason}")
            continue
        results[task] = result
        failures += [f"{task.robot} {plan.name}: {plan.ratio:.4f} of the limit" for plan in result if plan.ratio > 1.0]
    return list(table_lines(results)), failures


def table_lines(results: dict[NearTask, list[ComparedPlan]]) -> Iterator[str]:
    """Yield a Markdown table with one row for each robot and style, or documents."""
    yield "| robot | content | plans | over without policy | over | dropped | shifted | p95 [s] | stretched | max |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    for robot, content in sorted({(task.robot, task.content) for task in results}):
        plans = [plan for task, some in results.items() if task[:2] == (robot, content) for plan in some]
        if not plans:
            continue
        shifts, stretches = np.array([p.shift for p in plans]), np.array([p.stretch for p in plans])
        cells = (
            len(plans),
            sum(p.ratio_before > 1.0 for p in plans),
            sum(p.ratio > 1.0 for p in plans),
            sum(p.dropped > 0 for p in plans),
            int((shifts > SHIFT_TO_WARN).sum()),
            f"{np.percentile(shifts, 95.0):.2f}",
            int((stretches > STRETCH_TOLERANCE).sum()),
            f"{stretches.max():.2f}",
        )
        yield f"| {robot} | {content} | {' | '.join(map(str, cells))} |"
