import json
import re
import sys
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.tasks.store import QueryResult, open_store

pytest.importorskip("duckdb", reason="the extra store is not installed")

GUIDE_PAGE = Path(__file__).resolve().parents[2] / "docs" / "how-to" / "run-many-documents.md"


def ask(folder: Path, query: str) -> QueryResult:
    with open_store(folder) as store:
        return store.ask(query)


def line(number: int, status: str) -> str:
    check = {"name": "limits.speed", "status": status, "value": number / 10, "limit": 1.0, "unit": "", "where": "it's"}
    entry = {"file": f"{number}.bml", "outcome": "performed", "exit": 0, "behaviours": [["gesture", "dropped"]]}
    return json.dumps({"key": str(number), "entry": entry | {"checks": [check], "error": "", "report": None}}) + "\n"


@pytest.fixture
def folder(tmp_path):
    made = tmp_path / "it's here"
    made.mkdir()
    (made / "finished.jsonl").write_text(line(1, "pass") + line(2, "fail") + line(3, "pass")[:40])
    return made


def test_complete_journal_lines_become_table_rows_and_a_truncated_line_is_ignored(folder):
    assert ask(folder, "SELECT file, outcome FROM documents ORDER BY file").rows == (
        ("1.bml", "performed"),
        ("2.bml", "performed"),
    )
    answer = ask(folder, "SELECT file, \"value\" FROM checks WHERE status = 'fail'")
    assert answer.columns == ("file", "value")
    assert answer.rows == (("2.bml", 0.2),)
    assert ask(folder, "SELECT type, count(*) FROM behaviours GROUP BY type").rows == (("gesture", 2),)


GUIDE_QUERIES = re.findall(r'^kinesic results "(.+)" reports', GUIDE_PAGE.read_text(encoding="utf-8"), re.MULTILINE)


def test_guide_of_the_result_store_has_ten_sql_queries():
    assert len(GUIDE_QUERIES) == 10


@pytest.mark.parametrize("query", GUIDE_QUERIES)
def test_each_sql_query_of_the_guide_is_answered(query, folder):
    assert ask(folder, query).columns


def test_long_sql_query_prints_no_progress(folder, capfd):
    with open_store(folder) as store:
        store.ask("SET progress_bar_time = 1")  # [ms]
        assert store.ask("SELECT count(DISTINCT random()) FROM range(2000000)").rows
    assert capfd.readouterr().out == ""


def test_appended_journal_entry_appears_in_the_tables(folder):
    ask(folder, "SELECT 1 FROM documents")
    (folder / "finished.jsonl").write_text(line(1, "pass") + line(2, "fail") + line(3, "pass"))
    assert ask(folder, "SELECT count(*) FROM documents").rows == ((3,),)


def test_invalid_query_error_names_the_tables_and_empty_folder_error_the_command(folder, tmp_path):
    with pytest.raises(ConfigError, match="tables are behaviours, checks, documents"):
        ask(folder, "SELECT * FROM document")
    with pytest.raises(ConfigError, match="no results; `kinesic validate"):
        ask(tmp_path, "SELECT 1")


def test_stored_sweep_has_a_row_per_parameter_value(tmp_path):
    played = [{"value": value, "swept_volume": 2 + value, "strokes": None} for value in (-1.0, 1.0)]
    series = {"parameter": "spatial", "measure": "swept_volume", "sign": 1.0, "monotone": True, "played": played}
    text = json.dumps({"gesture": "beat", "style": "calm", "series": [series], "presets": {"angry": {}}})
    (tmp_path / "sweep.json").write_text(text)
    query = 'SELECT gesture, style, parameter, "value", swept_volume FROM sweep ORDER BY "value"'
    assert ask(tmp_path, query).rows == (
        ("beat", "calm", "spatial", -1.0, 1.0),
        ("beat", "calm", "spatial", 1.0, 3.0),
    )
    assert (tmp_path / "sweep.parquet").stat().st_size > 0


def test_benchmark_metrics_and_designs_become_tables(tmp_path):
    figure = {"name": "a.b", "value": None, "unit": "s", "goal": 1.0, "better": "lower", "why": "none", "ok": None}
    (tmp_path / "bench.json").write_text(json.dumps([figure, figure | {"name": "a.c", "value": 0.5, "ok": True}]))
    design = {"design": "x = 1", "changes": {"x": "1"}, "state": "out", "price": 1.0, "performed": []}
    (tmp_path / "designs.json").write_text(json.dumps({"rounds": [], "designs": [design]}))
    assert ask(tmp_path, "SELECT name FROM figures WHERE ok").rows == (("a.c",),)
    assert ask(tmp_path, "SELECT * FROM designs").columns == ("design", "state", "price")


def test_table_name_with_sql_code_is_not_executed(folder, tmp_path, monkeypatch):
    ask(folder, "SELECT 1")
    monkeypatch.chdir(tmp_path)
    (folder / 'x" AS SELECT 1; COPY documents TO "stolen.csv"; --.parquet').write_bytes(
        (folder / "documents.parquet").read_bytes()
    )
    with open_store(folder) as store:
        assert any(name.startswith('x" AS') for name in store.tables)
    assert [path.name for path in tmp_path.iterdir()] == [folder.name]


def test_missing_duckdb_is_reported_with_the_command_that_installs_it(folder, monkeypatch):
    monkeypatch.setitem(sys.modules, "duckdb", None)
    with pytest.raises(ConfigError, match=r"^results need duckdb: .*pip install.*store"), open_store(folder):
        pass
