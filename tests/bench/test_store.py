import pytest

from kinesic.bench import store

pytest.importorskip("duckdb", reason="the extra store is not installed")


def test_a_store_is_made_and_asked(monkeypatch, tmp_path):
    monkeypatch.setattr(store, "ROWS", 29 * 100)
    figures = {figure.name: figure for figure in store.bench()}
    assert all(figures[f"store.{name}"].value > 0 for name in ("make", "size", "query", "query_cpu"))
    assert figures["store.query"].goal == 1.0


def test_questions_find_the_rows_that_were_written(tmp_path):
    store._write_journal(tmp_path / store.JOURNAL, 100)
    with store.open_store(tmp_path) as opened:
        answers = [opened.ask(question).rows for question in store.QUESTIONS]
    assert [row[1] for row in answers[0]] == [100] * store.CHECKS
    assert [row[1] for row in answers[1]] == [value / 8 for value in range(99, 89, -1)]
    assert sum(row[1] for row in answers[2]) == 100 * store.CHECKS
    assert answers[3] == (("performed", 99.0),)
