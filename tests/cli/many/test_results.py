import json

import pytest

pytest.importorskip("duckdb", reason="the extra store is not installed")
CHECK = {"name": "limits.speed", "status": "fail", "value": 1.5, "limit": 1.0, "unit": "ratio", "where": ""}


@pytest.fixture
def folder(tmp_path):
    entry = {"file": "[a].bml", "outcome": "performed", "exit": 1, "behaviours": [], "checks": [CHECK], "error": ""}
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


def test_invalid_query_is_reported_in_one_line(kinesic, folder):
    ended = kinesic("results", "SELECT nothing FROM documents", folder)
    assert ended.code == 2
    assert "invalid query" in ended.err
    assert ended.err.count("\n") == 1


def test_results_verb_writes_a_plot(kinesic, folder):
    plotted = kinesic("results", "plot", folder)
    assert (plotted.code, plotted.out) == (0, f"png: {folder / 'results.png'}\n")
    assert (folder / "results.png").read_bytes().startswith(b"\x89PNG")
    kinesic("results", "plot", folder)  # The plot is replaced, another file is not.
    (folder / "mine.png").touch()
    assert "exists already" in kinesic("results", "plot", folder, "--out", folder / "mine.png").err
