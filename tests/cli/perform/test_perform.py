import json
import re
from subprocess import Popen

import pytest

NOD = b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" start="0.2"/></bml>'
REPORT_KEYS = {
    "schema",
    "kinesic",
    "robot",
    "input",
    "style",
    "seed",
    "kernel",
    "ok",
    "checks",
    "behaviours",
    "sync",
    "tracking",
    "limits",
    "collision",
    "smoothness",
    "warnings",
    "feedback",
    "timing",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Folder in which a nod is performed several times."""
    run_folder = tmp_path_factory.mktemp("perform")
    (run_folder / "nod.bml").write_bytes(NOD)
    (run_folder / "there").mkdir()
    return run_folder


@pytest.fixture(scope="module")
def json_run(kinesic_in, folder):
    """Nod performed with JSON output."""
    return kinesic_in(folder, "perform", "nod.bml", "--out", "new", "--no-film", "--json")


@pytest.fixture(scope="module")
def text_run(kinesic_in, folder):
    """Nod performed with text output into an existing folder."""
    return kinesic_in(folder, "perform", "nod.bml", "--out", "there", "--no-film", "--force")


@pytest.fixture(scope="module")
def piped_run(kinesic_in, folder):
    """Nod performed from standard input in the nominal twin."""
    return kinesic_in(folder, "perform", "-", "--out", "piped", "--no-film", "--json", "--twin", "nominal", stdin=NOD)


def test_perform_prints_checks_then_the_verdict_and_last_the_report_paths(text_run, folder):
    assert text_run.code == 0, text_run.err
    assert re.match(r"all \d\d checks pass\nok: nod.bml on upper22, ", text_run.out)
    assert text_run.out.splitlines()[-2:] == ["report: there/report.json", "page: there/report.html"]
    data = json.loads((folder / "there" / "report.json").read_text())
    assert data.keys() >= REPORT_KEYS
    assert data["ok"]
    (behaviour,) = data["behaviours"]
    assert behaviour.items() >= {"id": "h", "type": "head", "outcome": "realised", "why": ""}.items()
    assert behaviour["manner"]["modality"] == "head"
    assert (folder / "there" / "report.html").stat().st_size > 10_000


def test_perform_json_report_is_the_only_standard_output(json_run):
    assert json.loads(json_run.out)["schema"] == 1
    assert "report: new/report.json" in json_run.err


def test_perform_reads_a_document_from_standard_input(piped_run):
    assert json.loads(piped_run.out)["input"] == "stdin"


def test_existing_report_folder_is_refused_without_force(kinesic_in, folder, text_run):
    assert text_run.code == 0
    refused = kinesic_in(folder, "perform", "nod.bml", "--out", "there", "--no-film")
    assert refused.code == 2
    assert "there exists already" in refused.err


def test_repeated_perform_gives_an_equal_report_except_for_timings(json_run, text_run, folder):
    first, second = json.loads(json_run.out), json.loads((folder / "there" / "report.json").read_text())
    first.pop("timing"), second.pop("timing")
    assert first == second


def test_pessimistic_twin_has_a_larger_tracking_error_than_the_nominal_twin(kinesic_in, folder, piped_run):
    options = ("--out", "pessimistic", "--no-film", "--json", "--twin", "pessimistic")
    runs = [json.loads(ended.out) for ended in (piped_run, kinesic_in(folder, "perform", "nod.bml", *options))]
    assert runs[0]["tracking"]["rmse_deg"] < runs[1]["tracking"]["rmse_deg"]


def test_names_printed_by_perform_keep_their_brackets_and_escape_control_characters(kinesic, tmp_path):
    (tmp_path / "[red]m.bml").write_bytes(NOD.replace(b'id="h"', b'id="[/x]&#x9b;31m" amount="5"'))
    ended = kinesic("perform", "[red]m.bml", "--no-film", "--out", "o")
    assert ended.code == 0, ended.err
    assert "warning     NOD ([/x]\\x9b31m): " in ended.out
    assert "ok: [red]m.bml on upper22" in ended.out
    (tmp_path / "evil.bml").write_bytes(NOD.replace(b"NOD", "\x9b31m".encode()))
    ended = kinesic("plan", "evil.bml", "--out", "evil.npz")
    assert "\x9b" not in ended.err + ended.out
    assert "\\x9b31m" in ended.err


def test_report_page_is_written_before_films_and_kept_after_an_interrupt(kinesic, tmp_path, monkeypatch):
    def stop(jobs: object, processes: dict[str, Popen[bytes]], progress: object) -> None:
        text = (tmp_path / "there" / "report.html").read_text()
        assert "No film: not drawn yet" in text
        assert all(process.poll() is None for process in processes.values())
        drawing_processes.extend(processes.values())
        raise KeyboardInterrupt

    drawing_processes: list[Popen[bytes]] = []
    monkeypatch.setattr("kinesic.report.output.draw_films", stop)
    ended = kinesic("perform", "-", "--out", "there", stdin=NOD)
    assert (ended.code, ended.out) == (130, "")
    assert ended.err == "kinesic: stopped before its films were drawn; page: there/report.html\n"
    assert json.loads((tmp_path / "there" / "report.json").read_text())["ok"]
    assert len(drawing_processes) == 2
    assert all(process.poll() is not None for process in drawing_processes), "drawing processes end with the command"
