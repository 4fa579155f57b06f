import json
import re
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.tasks.store import ask

pytest.importorskip("duckdb", reason="the extra store is not installed")

MANY = Path(__file__).resolve().parents[2] / "docs" / "many.md"


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


def test_a_journal_becomes_tables_of_its_whole_lines(folder):
    assert ask(folder, "SELECT file, outcome FROM documents ORDER BY file", "finished.jsonl").rows == (
        ("1.bml", "performed"),
        ("2.bml", "performed"),
    )
    found = ask(folder, "SELECT file, \"value\" FROM checks WHERE status = 'fail'", "finished.jsonl")
    assert found.columns == ("file", "value")
    assert found.rows == (("2.bml", 0.2),)
    assert ask(folder, "SELECT type, count(*) FROM behaviours GROUP BY type", "finished.jsonl").rows == (
        ("gesture", 2),
    )


QUERIES = re.findall(r'^kinesic results "(.+)" reports', MANY.read_text(encoding="utf-8"), re.MULTILINE)


def test_the_guide_has_ten_queries():
    assert len(QUERIES) == 10


@pytest.mark.parametrize("query", QUERIES)
def test_a_query_of_the_guide_is_answered(query, folder):
    assert ask(folder, query, "finished.jsonl").columns


def test_what_is_added_to_the_journal_is_found(folder):
    ask(folder, "SELECT 1 FROM documents", "finished.jsonl")
    (folder / "finished.jsonl").write_text(line(1, "pass") + line(2, "fail") + line(3, "pass"))
    assert ask(folder, "SELECT count(*) FROM documents", "finished.jsonl").rows == ((3,),)


def test_a_wrong_query_and_a_folder_without_results_say_what_there_is(folder, tmp_path):
    with pytest.raises(ConfigError, match="tables are behaviours, checks, documents"):
        ask(folder, "SELECT * FROM document", "finished.jsonl")
    with pytest.raises(ConfigError, match="no results; `kinesic validate"):
        ask(tmp_path, "SELECT 1", "finished.jsonl")
