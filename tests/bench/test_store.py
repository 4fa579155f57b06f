import pytest

from kinesic.bench import store

pytest.importorskip("duckdb", reason="the optional dependency duckdb is not installed")


def test_result_store_benchmark_measures_creation_size_and_queries(monkeypatch, tmp_path):
    monkeypatch.setattr(store, "CHECK_ROWS", 29 * 100)
    metrics = {metric.name: metric for metric in store.bench()}
    assert all(metrics[f"store.{name}"].value > 0 for name in ("make", "size", "query", "query_cpu"))
    assert metrics["store.query"].goal == 1.0


def test_result_store_queries_return_the_written_rows(tmp_path):
    store._write_journal(tmp_path / store.JOURNAL_FILE, 100)
    with store.open_store(tmp_path) as opened:
        answers = [opened.ask(query).rows for query in store.BENCH_QUERIES]
    assert [row[1] for row in answers[0]] == [100] * store.CHECKS_PER_DOCUMENT
    assert [row[1] for row in answers[1]] == [value / 8 for value in range(99, 89, -1)]
    assert sum(row[1] for row in answers[2]) == 100 * store.CHECKS_PER_DOCUMENT
    assert answers[3] == (("performed", 99.0),)
