import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from kinesic.cli.many import results as results_verb
from kinesic.cli.many.results import SUMMARY_QUERIES, ask_results
from kinesic.tasks.store import QueryResult

pytest.importorskip("duckdb", reason="the extra store is not installed")
FAILED_CHECK = {"name": "limits.speed", "status": "fail", "value": 1.5, "limit": 1.0, "unit": "ratio", "where": ""}


@pytest.fixture
def folder(tmp_path):
    entry = {
        "file": "[a].bml",
        "outcome": "performed",
        "exit": 1,
        "behaviours": [],
        "checks": [FAILED_CHECK],
        "error": "",
    }
    (tmp_path / "finished.jsonl").write_text(json.dumps({"key": "1", "entry": entry}) + "\n")
    return tmp_path


def test_results_verb_prints_a_summary_and_query_rows(kinesic, folder):
    summary, rows = (
        kinesic("results", "summary", folder, "--json"),
        kinesic("results", "SELECT file FROM documents", folder),
    )
    assert json.loads(summary.out)[0]["failed"] == 1
    assert "[a].bml" in rows.out
    assert summary.code == rows.code == 0


def test_invalid_results_query_is_reported_in_one_line(kinesic, folder):
    ended = kinesic("results", "SELECT nothing FROM documents", folder)
    assert ended.code == 2
    assert "invalid query" in ended.err
    assert ended.err.count("\n") == 1


def test_plot_of_results_is_written_and_replaces_no_file_of_another_name(kinesic, folder):
    plotted = kinesic("results", "plot", folder)
    assert (plotted.code, plotted.out) == (0, f"png: {folder / 'results.png'}\n")
    assert (folder / "results.png").read_bytes().startswith(b"\x89PNG")
    kinesic("results", "plot", folder)  # The plot is replaced, another file is not.
    (folder / "mine.png").touch()
    assert "exists already" in kinesic("results", "plot", folder, "--out", folder / "mine.png").err


class Store:
    """Test double of a result store that answers with fixed rows."""

    tables = ("figures", "documents", "checks")

    def ask(self, text: str) -> QueryResult:
        return QueryResult(("query", "value\x1b[2J"), ((text.split()[1], 12345.678), ("a", None), ("[red]", 7)))


@pytest.fixture
def store(monkeypatch, capsys) -> Store:
    """Replace result stores and their plots by test doubles."""
    opened = Store()

    @contextmanager
    def open_store(folder: Path) -> Iterator[Store]:
        yield opened

    monkeypatch.setattr(results_verb, "open_store", open_store)
    monkeypatch.setattr(
        "kinesic.report.plots.results.draw_results", lambda drawn, path: path.write_bytes(b"%d" % (drawn is opened))
    )
    return opened


def test_results_summary_runs_one_query_per_result_table(store, capsys):
    assert ask_results("summary", Path("folder"), True, None, False) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [row["query"] for row in rows if row["query"] not in ("a", "[red]")] == [
        SUMMARY_QUERIES[table].split()[1] for table in ("checks", "figures")
    ]


def test_results_query_prints_json_rows_with_an_indent_of_one(store, capsys):
    assert ask_results("SELECT 1", Path("folder"), True, None, False) == 0
    printed = capsys.readouterr().out
    assert printed.startswith('[\n {\n  "query": "1",\n')
    assert [list(row.values()) for row in json.loads(printed)] == [["1", 12345.678], ["a", None], ["[red]", 7]]


def test_results_query_prints_a_table_with_four_digit_numbers_and_empty_cells(store, capsys):
    assert ask_results("SELECT 1", Path("folder"), False, None, False) == 0
    head, first, second, third = (line.split() for line in capsys.readouterr().out.splitlines())
    assert head[0] == "query"
    assert "\x1b" not in head[1]
    assert (first, second, third) == (["1", "1.235e+04"], ["a"], ["[red]", "7"])


@pytest.mark.parametrize(("out", "force"), [(None, False), ("mine.png", False), ("mine.png", True)])
def test_results_plot_replaces_its_default_file_without_force_and_other_files_with_force(
    store, capsys, tmp_path, out, force
):
    path = tmp_path / (out or "results.png")
    if out is None or force:
        path.write_bytes(b"old")
    assert ask_results("plot", tmp_path, True, None if out is None else path, force) == 0
    assert capsys.readouterr().out == f"png: {path}\n"
    assert path.read_bytes() == b"1"
