"""Reports of many documents: outcome of each, written files and totals."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from kinesic.bml.block import BmlError
from kinesic.report import batch
from kinesic.report.batch import DocumentTask, DocumentVerdict, documents, judge_document, validate_documents
from kinesic.report.batch_totals import counts, tallies, totals
from kinesic.report.checks import Check
from kinesic.report.verdict import format_number
from kinesic.tasks.processes import WorkerCrash

NOD = '<bml id="b"><head id="h" lexeme="NOD" start="1"/></bml>'
UNKNOWN_GESTURES = (
    '<bml id="b">\n <gesture id="x" lexeme="xyzzy" stroke="1"/><gesture id="y" lexeme="xyzzy" stroke="3"/></bml>'
)
BROKEN_DOCUMENT = '<bml id="b"><head'


class LocalEngine:
    """Task engine in this process that simulates a crash for one document."""

    place = "here"

    def __init__(self, kills: str = "") -> None:
        self.kills, self.did = kills, []

    def run(self, tasks, prepare, *, preload=""):
        do = prepare()
        for task in tasks:
            name = Path(task.file).stem
            self.did.append(name)
            yield task, WorkerCrash("it was killed", "a trace") if name == self.kills else do(task)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in {"nod": NOD, "unknown": UNKNOWN_GESTURES, "broken": BROKEN_DOCUMENT}.items():
        (tmp_path / f"{name}.bml").write_text(text)
    (tmp_path / "out").mkdir()
    return tmp_path


def run(folder: Path, known, *, engine: LocalEngine | None = None, settings: str = "", out: bool = True):
    result = validate_documents(
        documents((folder,)),
        lambda: known,
        engine=engine or LocalEngine(),
        folder=folder / "out" if out else None,
        settings=settings,
    )
    return {Path(verdict.file).stem: verdict for verdict in result}


def test_each_document_of_a_batch_has_a_verdict(folder: Path, known):
    result = run(folder, known, out=False)
    nod = result["nod"]
    assert (nod.outcome, nod.exit, nod.error, nod.report) == ("performed", 0, "", None)
    assert nod.behaviours == (("head", "realised"),)
    assert nod.checks
    assert (nod.count("realised"), nod.count("dropped")) == (1, 0)
    broken = result["broken"]
    assert (broken.outcome, broken.exit, broken.checks) == ("refused", 0, ())
    assert broken.file == str(folder / "broken.bml")
    assert broken.error.startswith(f"{folder / 'broken.bml'}:1")


def test_document_without_performable_behaviours_is_refused_with_every_reason(folder: Path, known):
    result, data = judge_document(folder / "unknown.bml", known)
    assert (result.outcome, result.exit, result.checks) == ("refused", 0, ())
    assert result.file == str(folder / "unknown.bml")
    assert result.behaviours == (("gesture", "dropped"),) * 2
    assert result.error.startswith(f"{folder / 'unknown.bml'}:2:2: upper22 can perform none of its behaviours (x: ")
    assert "; y: " in result.error
    assert data["input"] == str(folder / "unknown.bml")


def test_unreadable_document_is_refused_with_exit_code_2(tmp_path: Path, known):
    result, data = judge_document(tmp_path / "none.bml", known)
    assert result == DocumentVerdict(
        str(tmp_path / "none.bml"), "refused", 2, error=f"{tmp_path / 'none.bml'}: No such file or directory"
    )
    assert data == {}
    assert judge_document(tmp_path / "none.bml", known, content=NOD.encode())[0].outcome == "performed"


def test_document_fails_if_its_performance_has_failed_checks(folder: Path, known, monkeypatch):
    monkeypatch.setattr(batch, "grade", lambda results: "fail")
    assert (
        judge_document(folder / "nod.bml", known)[0].exit,
        judge_document(folder / "unknown.bml", known)[0].exit,
    ) == (1, 0)


def test_next_batch_run_reuses_recorded_reports(folder: Path, known):
    first = run(folder, known)
    (folder / "new.bml").write_text(NOD)
    engine = LocalEngine()
    again = run(folder, known, engine=engine)
    assert engine.did == ["new"]
    assert {name: again[name] for name in first} == first
    report = Path(first["nod"].report)
    assert report.parent == folder / "out"
    assert report.name.startswith("nod-")
    assert json.loads(report.read_text(encoding="utf-8"))["input"] == str(folder / "nod.bml")
    assert first["broken"].report is None
    report.unlink()
    run(folder, known, engine=(lost := LocalEngine()))
    assert lost.did == ["nod"]


def test_batch_runs_a_changed_document_again_and_all_documents_after_a_changed_setting(folder: Path, known):
    run(folder, known)
    (folder / "nod.bml").write_text(NOD.replace("1", "2"))
    run(folder, known, engine=(changed := LocalEngine()))
    assert changed.did == ["nod"]
    run(folder, known, engine=(other := LocalEngine()), settings="another style")
    assert sorted(other.did) == ["broken", "nod", "unknown"]


def test_batch_without_a_folder_writes_nothing(folder: Path, known):
    before = sorted(folder.rglob("*"))
    for _ in range(2):
        run(folder, known, engine=(engine := LocalEngine()), out=False)
        assert len(engine.did) == 3
    assert sorted(folder.rglob("*")) == before


@pytest.mark.parametrize("out", [True, False])
def test_document_that_crashes_its_process_is_named_and_others_continue(folder: Path, known, out: bool):
    result = run(folder, known, engine=LocalEngine(kills="nod"), out=out)
    crashed = result["nod"]
    assert (crashed.outcome, crashed.exit, crashed.file) == ("crashed", 1, str(folder / "nod.bml"))
    assert crashed.error == f"{folder / 'nod.bml'}: it was killed"
    assert result["unknown"].outcome == "refused"
    traces = list(folder.glob("out/*.crash.txt"))
    assert [path.read_text() for path in traces] == ["a trace"] * out
    assert run(folder, known, engine=LocalEngine(kills="nod"), out=out)["nod"] == crashed
    run(folder, known, engine=(again := LocalEngine()), out=out)
    assert "nod" in again.did


def test_batch_refuses_a_missing_path_and_lists_each_file_once(folder: Path):
    with pytest.raises(BmlError, match=r"nowhere\.bml: no such file or folder"):
        documents((folder / "nowhere.bml",))
    nod = folder / "nod.bml"
    assert documents((nod, folder, nod)) == [nod, folder / "broken.bml", folder / "unknown.bml"]


def test_documents_with_equal_names_have_separate_reports(tmp_path: Path):
    names = set()
    for place in ("a", "b"):
        (tmp_path / place).mkdir()
        (tmp_path / place / "nod.bml").write_text(NOD)
        names.add(DocumentTask.of(tmp_path / place / "nod.bml", "").name)
    assert len(names) == 2


def check(name: str, status: str, value: float, *, at_least: bool = False) -> Check:
    return Check(name, status, value, 1.0, "m", f"at {value}", at_least=at_least)


VERDICTS = [
    DocumentVerdict(
        "a/one.bml",
        "performed",
        0,
        (("head", "realised"), ("gesture", "partly")),
        (check("high", "pass", 0.5), check("low", "poor", 0.2, at_least=True)),
    ),
    DocumentVerdict(
        "a/two.bml",
        "performed",
        1,
        (("head", "dropped"),),
        (check("high", "fail", 3.0), check("low", "pass", 2.0, at_least=True)),
    ),
    DocumentVerdict("b/three.bml", "refused", 0, (("head", "substituted"),), error="no"),
    DocumentVerdict("b/four.bml", "refused", 2, error="no"),
    DocumentVerdict("b/five.bml", "crashed", 1, error="no"),
]


def test_documents_and_behaviours_of_a_batch_are_counted():
    assert counts(VERDICTS) == {
        "documents": 5,
        "performed": 2,
        "refused": 2,
        "crashed": 1,
        "failed": 1,
        "poor": 1,
        "realised": 1,
        "partly": 1,
        "substituted": 1,
        "dropped": 1,
    }


def test_worst_value_of_each_check_is_named_with_its_document():
    high, low = tallies(VERDICTS)
    assert (high.name, high.worst.value, high.file) == ("high", 3.0, "a/two.bml")
    assert (low.name, low.worst.value, low.file) == ("low", 0.2, "a/one.bml")
    assert high.counts == {"pass": 1, "warn": 0, "poor": 0, "fail": 1}
    assert list(high.counts) == ["pass", "warn", "poor", "fail"]
    reverse = tallies(VERDICTS[::-1])
    assert [(item.worst.value, item.file) for item in reverse] == [(3.0, "a/two.bml"), (0.2, "a/one.bml")]


def test_totals_of_a_batch_are_counted_by_folder_and_document_type():
    result = totals(VERDICTS)
    assert result["documents"] == 5
    assert list(result["folders"]) == ["a", "b"]
    assert (result["folders"]["a"]["documents"], result["folders"]["b"]["documents"]) == (2, 3)
    assert result["folders"]["a"]["types"] == {
        "gesture": {"realised": 0, "partly": 1, "substituted": 0, "dropped": 0},
        "head": {"realised": 1, "partly": 0, "substituted": 0, "dropped": 1},
    }
    assert result["checks"]["low"] == {
        **{"pass": 1, "warn": 0, "poor": 1, "fail": 0},
        **{"worst": 0.2, "limit": 1.0, "unit": "m", "where": "at 0.2", "file": "a/one.bml"},
    }


def test_batch_without_documents_has_no_totals():
    assert totals([]) == counts([]) | {"folders": {}, "checks": {}}
    assert tallies([replace(VERDICTS[0], checks=())]) == []


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (None, "\N{EN DASH}"),
        (True, "True"),
        ("x", "x"),
        (0.012345, "0.0123"),
        (-0.0, "0"),
        (99.96, "100"),
        (100, "100"),
        (100.4, "100"),
        (123456.7, "123457"),
        (-250.4, "-250"),
    ],
)
def test_batch_numbers_are_rounded_to_three_significant_digits_or_to_an_integer(value, said: str):
    assert format_number(value) == said
