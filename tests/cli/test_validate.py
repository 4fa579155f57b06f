import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from kinesic.cli import validate
from kinesic.cli.validate import SUMMARY_FILE
from kinesic.tasks.store import JOURNAL_FILE

pytestmark = pytest.mark.realtime

BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
NOD = BLOCK.format('<head id="h" lexeme="NOD" start="0.2"/>')
SAME_PROGRAM = """
from kinesic.cli import main, validate
validate.fingerprint_inputs = lambda settings, *others: repr((settings, others))
main()
"""
WALK = BLOCK.format('<locomotion id="w" target="user"/>')


@pytest.fixture
def folder(tmp_path):
    documents = tmp_path / "documents"
    (documents / "nods").mkdir(parents=True)
    (documents / "nods" / "one.bml").write_text(NOD)
    (documents / "nods" / "two.bml").write_text(NOD.replace("0.2", "0.4"))
    (documents / "walk.xml").write_text(WALK)
    (documents / "broken.xml").write_text("<bml>")
    return documents


@pytest.fixture
def same_program(monkeypatch):
    """Keep the program's fingerprint constant even if source files change meanwhile."""
    monkeypatch.setattr(validate, "fingerprint_inputs", lambda settings, *others: repr((settings, others)))


def parsed(ended):
    assert ended.code == 0, ended.err
    return json.loads(ended.out)


def interrupted_run(*arguments, cwd, min_done, journal):
    """Run the command, and interrupt it after `min_done` documents."""
    command = [
        sys.executable,
        "-c",
        SAME_PROGRAM,
        "validate",
        *map(str, arguments),
    ]
    process = subprocess.Popen(
        command, cwd=cwd, start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    deadline = time.monotonic() + 120
    while process.poll() is None and time.monotonic() < deadline:
        if journal.exists() and journal.read_bytes().count(b"\n") >= min_done:
            os.killpg(process.pid, signal.SIGINT)
            break
        time.sleep(0.01)
    out, err = process.communicate(timeout=60)
    return process.returncode, out, err


def test_validation_verdicts_do_not_depend_on_the_number_of_jobs(kinesic, folder, tmp_path):
    repeated_paths = (folder, folder / "walk.xml", folder / "nods")  # Each document counts once.
    one = parsed(kinesic("validate", *repeated_paths, "--json", "--jobs", 1, "--out", "reports"))
    two = parsed(kinesic("validate", folder, "--json", "--jobs", 3))
    assert json.loads((tmp_path / "reports" / SUMMARY_FILE).read_text()) == one
    for entry in one["documents"]:
        if entry["outcome"] == "performed":
            assert json.loads((tmp_path / entry["report"]).read_text())["input"] == entry["file"]
            entry["report"] = None
    assert one == two
    assert [entry["file"].rpartition("/")[2] for entry in one["documents"]] == [
        "broken.xml",
        "one.bml",
        "two.bml",
        "walk.xml",
    ]
    assert one["totals"]["performed"] == 2
    assert one["totals"]["refused"] == 2
    assert one["totals"]["crashed"] == 0
    assert one["totals"]["checks"]["limits.speed"]["pass"] == 2
    assert one["interrupted"] is False


def test_validate_without_force_keeps_finished_runs_and_foreign_folders(kinesic, folder, tmp_path):
    assert kinesic("validate", folder / "broken.xml", "--out", "reports").code == 0
    again = kinesic("validate", folder / "broken.xml", "--out", "reports")
    assert again.code == 2
    assert "finished run; --force starts again" in again.err
    assert kinesic("validate", folder / "broken.xml", "--out", "reports", "--force").code == 0
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("dear")
    assert "exists already" in kinesic("validate", folder / "broken.xml", "--out", "mine").err
    assert (tmp_path / "mine" / "letter.txt").exists()


def test_interrupted_validation_reports_its_progress_and_resumes(kinesic, folder, tmp_path, same_program):
    for k in range(3):
        (folder / f"more{k:02d}.bml").write_text(NOD.replace("0.2", str(1 + k)))
    out = tmp_path / "reports"
    code, text, errors = interrupted_run(
        folder, "--json", "--out", out, "--jobs", "1", cwd=tmp_path, min_done=3, journal=out / JOURNAL_FILE
    )
    assert code == 130, errors
    partial = json.loads(text)
    done = {entry["file"]: entry.get("report") for entry in partial["documents"]}
    assert partial["interrupted"]
    assert 3 <= len(done) < 7
    assert f"interrupted after {len(done)} of 7 documents" in errors
    assert "Traceback" not in errors
    assert not (out / SUMMARY_FILE).exists()
    with (out / JOURNAL_FILE).open("ab") as file:
        file.write(b'{"key": "half a li')
    reports = [out / Path(report).name for report in done.values() if report]
    written = {path.name: path.stat().st_mtime_ns for path in reports}
    whole = parsed(kinesic("validate", folder, "--json", "--out", out, "--jobs", "1"))
    assert whole["totals"]["documents"] == 7
    assert whole["totals"]["performed"] == 5
    kept = {name: (out / name).stat().st_mtime_ns for name in written}
    assert kept == written  # Completed documents were not repeated.
    assert (out / SUMMARY_FILE).exists()
    fresh = parsed(kinesic("validate", folder, "--json"))
    assert [e | {"report": None} for e in fresh["documents"]] == [e | {"report": None} for e in whole["documents"]]
    assert fresh["totals"] == whole["totals"]


def test_resumed_validation_repeats_only_changed_documents_and_missing_reports(kinesic, folder, tmp_path, same_program):
    (folder / "nods" / "three.bml").write_text(NOD.replace("0.2", "0.6"))
    command = ("validate", folder / "nods", "--json", "--out", "reports")
    reports = {entry["file"]: entry["report"] for entry in parsed(kinesic(*command))["documents"]}
    before = {name: (tmp_path / name).stat().st_mtime_ns for name in reports.values()}
    (tmp_path / "reports" / SUMMARY_FILE).unlink()  # simulates an interrupted run
    (folder / "nods" / "one.bml").write_text(NOD.replace("NOD", "SHAKE"))
    three, two = str(folder / "nods" / "three.bml"), str(folder / "nods" / "two.bml")
    (tmp_path / reports[two]).unlink()
    again = {entry["file"]: entry["report"] for entry in parsed(kinesic(*command))["documents"]}
    after = {name: (tmp_path / name).stat().st_mtime_ns for name in again.values()}
    assert again[three] == reports[three]
    assert after[again[three]] == before[reports[three]]
    assert after[again[two]] > before[reports[two]]
    assert again[str(folder / "nods" / "one.bml")] not in before


def test_validation_tables_list_folders_checks_and_refused_documents(kinesic, folder):
    ended = kinesic("validate", folder)
    assert ended.code == 0
    lines = ended.out.splitlines()
    assert any(line.startswith("refused  ") and "broken.xml:1:" in line for line in lines)
    assert any(line.split()[:2] == ["nods", "2"] for line in lines)
    assert any(line.split()[:2] == ["all", "4"] for line in lines)
    assert any(line.split()[0] == "collision.twin" for line in lines if line.split())


def test_option_twin_both_reports_tracking_errors_of_both_twins(kinesic, folder, tmp_path):
    data = parsed(kinesic("validate", folder / "nods" / "one.bml", "--json", "--out", "reports", "--twin", "both"))
    report = json.loads((tmp_path / data["documents"][0]["report"]).read_text())
    assert list(report["twins"]) == ["nominal", "pessimistic"]
    assert report["twins"]["nominal"]["rmse_deg"] == report["tracking"]["rmse_deg"]
    assert report["twins"]["pessimistic"]["rmse_deg"] > report["tracking"]["rmse_deg"]
