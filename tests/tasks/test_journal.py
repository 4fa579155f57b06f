"""Journal of a run: finished tasks are skipped, crashed ones repeated."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from kinesic.tasks.journal import Journal, run_once
from kinesic.tasks.processes import WorkerCrash

TASKS = {1: "one", 2: "two", 3: "three"}


class Engine:
    """Engine that multiplies numbers by ten and records these numbers."""

    def __init__(self, *crashes: int) -> None:
        self.done: list[int] = []
        self._crashes = crashes

    def tenfold(self, tasks: Sequence[int]) -> Iterator[tuple[int, int | WorkerCrash]]:
        for task in tasks:
            self.done.append(task)
            yield task, WorkerCrash("crashed", "where") if task in self._crashes else 10 * task


def run(engine: Engine, journal: Journal[int] | None, tasks: dict[int, str] = TASKS, **options: object) -> dict:
    return dict(run_once(tasks, engine.tenfold, journal, keep=lambda task, result: result + task, **options))


@pytest.fixture
def journal(tmp_path: Path) -> Journal[int]:
    return Journal(tmp_path / "journal.jsonl", int)


def test_all_tasks_are_repeated_without_a_journal():
    for _ in range(2):
        engine = Engine()
        assert run(engine, None) == {1: 11, 2: 22, 3: 33}
        assert engine.done == [1, 2, 3]


def test_task_recorded_in_the_journal_is_not_repeated(journal: Journal[int]):
    assert run(Engine(), journal, {1: "one", 2: "two"}) == {1: 11, 2: 22}
    assert journal.read() == {"one": 11, "two": 22}
    engine = Engine()
    assert run(engine, journal) == {1: 11, 2: 22, 3: 33}
    assert engine.done == [3]
    assert journal.read() == {"one": 11, "two": 22, "three": 33}


def test_each_task_result_is_recorded_immediately(journal: Journal[int]):
    results = run_once(TASKS, Engine().tenfold, journal, keep=lambda task, result: result)
    next(results)
    assert journal.read() == {"one": 10}
    results.close()
    engine = Engine()
    assert run(engine, journal) == {1: 10, 2: 22, 3: 33}
    assert engine.done == [2, 3]


def test_task_whose_journal_key_changed_runs_again(journal: Journal[int]):
    run(Engine(), journal)
    engine = Engine()
    run(engine, journal, {1: "one", 2: "another"})
    assert engine.done == [2]
    assert set(journal.read()) == {"one", "another"}, "what is of no task is forgotten"


def test_journal_entries_of_other_tasks_are_kept_on_request(journal: Journal[int]):
    run(Engine(), journal)
    run(Engine(), journal, {1: "one"}, forgets=False)
    assert set(journal.read()) == {"one", "two", "three"}


def test_task_with_an_invalid_journal_entry_runs_again(journal: Journal[int]):
    run(Engine(), journal)
    engine = Engine()
    assert run(engine, journal, holds=lambda entry: entry != 22) == {1: 11, 2: 22, 3: 33}
    assert engine.done == [2]


def test_crashed_task_is_reported_and_repeated_in_the_next_run(journal: Journal[int]):
    result = run(Engine(2), journal)
    assert isinstance(result[2], WorkerCrash)
    assert (result[1], result[3]) == (11, 33)
    assert set(journal.read()) == {"one", "three"}
    engine = Engine()
    assert run(engine, journal)[2] == 22
    assert engine.done == [2]


def test_truncated_and_invalid_journal_lines_are_ignored(journal: Journal[int], tmp_path: Path):
    journal.append("one", 11)
    with (tmp_path / "journal.jsonl").open("ab") as file:
        file.write(b'nonsense\n{"key":"two","entry":"text"}\n{"key":"three","entry":33}\n{"key":"four","entry":4')
    assert journal.read() == {"one": 11, "three": 33}


def test_journal_keeps_the_last_line_per_key_and_may_be_missing(journal: Journal[int]):
    assert journal.read() == {}
    journal.append("one", 1)
    journal.append("one", 2)
    assert journal.read() == {"one": 2}
    journal.rewrite({"two": 3})
    assert journal.read() == {"two": 3}
