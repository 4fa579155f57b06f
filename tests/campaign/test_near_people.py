from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from kinesic.bench.contact import COMPARED_ROBOTS, ComparedPlan
from kinesic.body.config import names_of
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.tasks.processes import WorkerCrash
from tests.campaign import near_people
from tests.campaign.near_people import (
    DOCUMENTS,
    NearTask,
    list_tasks,
    plan_near_people,
    run_task,
    run_tasks,
    table_lines,
)

TASKS = [NearTask("upper22", "calm", 0, "child"), NearTask("upper22", "calm", 14, "child")]
PLAN = ComparedPlan(
    name="beat", ratio_before=1.3, ratio=0.9, shift=0.0, stretch=1.0, dropped=0, seconds=(0.1, 0.2), survey_seconds=0.0
)


class Inline:
    """Task engine that runs tasks in this process and counts them."""

    place = "here"

    def __init__(self) -> None:
        self.done = list[NearTask]()

    def run(
        self,
        tasks: Iterable[NearTask],
        prepare: Callable[[], Callable[[NearTask], list[ComparedPlan]]],
        *,
        preload: str = "",
    ) -> Iterator[tuple[NearTask, list[ComparedPlan] | WorkerCrash]]:
        """Run each task in turn."""
        for task in tasks:
            self.done.append(task)
            yield task, prepare()(task)


def test_tasks_cover_each_gesture_in_each_style_of_both_robots_and_all_documents():
    tasks = list(list_tasks("adult"))
    assert len(set(tasks)) == len(tasks)
    parts = -(-len(Lexicon.load().forms) // near_people.GESTURES_PER_TASK)
    assert len(tasks) == len(COMPARED_ROBOTS) * (len(names_of("style")) * parts + 10)


def test_a_task_plans_its_gestures_in_its_style_near_its_audience(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(near_people, "GESTURES_PER_TASK", 1)
    (compared,) = run_task(NearTask("upper22", "calm", 3, "child"))
    assert compared.name.endswith("(calm)")
    assert compared.ratio <= 1.0 < compared.ratio_before


def test_interrupted_run_near_people_repeats_no_finished_task(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(near_people, "run_task", lambda task: [replace(PLAN, name=str(task.start))])
    path = tmp_path / "journal.jsonl"
    first, second = Inline(), Inline()
    assert len(list(run_tasks(TASKS[:1], first, path))) == 1
    results = dict(run_tasks(TASKS, second, path))
    assert (first.done, second.done) == (TASKS[:1], TASKS[1:])
    assert [plan.name for task in TASKS for plan in results[task]] == ["0", "14"]


def test_table_near_people_counts_excessive_shifted_and_stretched_plans_of_each_style():
    late = replace(PLAN, ratio=1.01, shift=0.5, stretch=1.5, dropped=1)
    documents = TASKS[0]._replace(content=DOCUMENTS)
    lines = list(table_lines({TASKS[0]: [PLAN], TASKS[1]: [late], documents: [PLAN]}))
    assert lines[2] == "| upper22 | calm | 2 | 2 | 1 | 1 | 1 | 0.47 | 1 | 1.50 |"
    assert lines[3] == "| upper22 | documents | 1 | 1 | 0 | 0 | 0 | 0.00 | 0 | 1.00 |"
    assert len(lines) == 4


def test_run_near_people_reports_each_plan_beyond_the_limits(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(near_people, "list_tasks", lambda near: [TASKS[0]._replace(near=near)])
    monkeypatch.setattr(near_people, "run_task", lambda task: [PLAN, replace(PLAN, ratio=1.02)])
    lines, failures = plan_near_people("child", Inline(), None)
    assert len(lines) == 3
    assert failures == ["upper22 beat: 1.0200 of the limit"]
