import json
import re
from subprocess import Popen

import pytest

NOD = b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" start="0.2"/></bml>'
KEYS = {
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
    """Where a nod is performed once and again."""
    made = tmp_path_factory.mktemp("perform")
    (made / "nod.bml").write_bytes(NOD)
    (made / "there").mkdir()
    return made


@pytest.fixture(scope="module")
def told(kinesic_in, folder):
    """A nod, performed for a program."""
    return kinesic_in(folder, "perform", "nod.bml", "--out", "new", "--no-film", "--json")


@pytest.fixture(scope="module")
def written(kinesic_in, folder):
    """The same nod, performed for people, into a folder that was there already."""
    return kinesic_in(folder, "perform", "nod.bml", "--out", "there", "--no-film", "--force")


@pytest.fixture(scope="module")
def piped(kinesic_in, folder):
    """The nod once more, from standard input, in the twin that is named."""
    return kinesic_in(folder, "perform", "-", "--out", "piped", "--no-film", "--json", "--twin", "nominal", stdin=NOD)


def test_a_nod_is_performed_and_the_paths_are_printed_last(written, folder):
    assert written.code == 0, written.err
    assert re.match(r"all \d\d checks pass\nok: nod.bml on upper22, ", written.out)
    assert written.out.splitlines()[-2:] == ["report: there/report.json", "page: there/report.html"]
    data = json.loads((folder / "there" / "report.json").read_text())
    assert data.keys() >= KEYS
    assert data["ok"]
    (behaviour,) = data["behaviours"]
    assert behaviour.items() >= {"id": "h", "type": "head", "outcome": "realised", "why": ""}.items()
    assert behaviour["manner"]["modality"] == "head"
    assert (folder / "there" / "report.html").stat().st_size > 10_000


def test_json_is_one_document_on_standard_output(told):
    assert json.loads(told.out)["schema"] == 1
    assert "report: new/report.json" in told.err


def test_standard_input(piped):
    assert json.loads(piped.out)["input"] == "stdin"


def test_an_existing_folder_is_refused_without_force(kinesic_in, folder, written):
    assert written.code == 0
    refused = kinesic_in(folder, "perform", "nod.bml", "--out", "there", "--no-film")
    assert refused.code == 2
    assert "there exists already" in refused.err


def test_the_same_input_gives_the_same_report(told, written, folder):
    first, second = json.loads(told.out), json.loads((folder / "there" / "report.json").read_text())
    first.pop("timing"), second.pop("timing")
    assert first == second


def test_the_pessimistic_twin_tracks_worse(kinesic_in, folder, piped):
    options = ("--out", "pessimistic", "--no-film", "--json", "--twin", "pessimistic")
    runs = [json.loads(ended.out) for ended in (piped, kinesic_in(folder, "perform", "nod.bml", *options))]
    assert runs[0]["tracking"]["rmse_deg"] < runs[1]["tracking"]["rmse_deg"]


def test_words_of_strangers_are_printed_as_they_stand(kinesic, tmp_path):
    (tmp_path / "[red]m.bml").write_bytes(NOD.replace(b'id="h"', b'id="[/x]&#x9b;31m" amount="5"'))
    ended = kinesic("perform", "[red]m.bml", "--no-film", "--out", "o")
    assert ended.code == 0, ended.err
    assert "warning     NOD ([/x]\\x9b31m): " in ended.out
    assert "ok: [red]m.bml on upper22" in ended.out
    (tmp_path / "evil.bml").write_bytes(NOD.replace(b"NOD", "\x9b31m".encode()))
    ended = kinesic("plan", "evil.bml", "--out", "evil.npz")
    assert "\x9b" not in ended.err + ended.out
    assert "\\x9b31m" in ended.err


def test_the_page_is_there_before_films_are_drawn_and_stays_when_they_are_stopped(kinesic, tmp_path, monkeypatch):
    def stop(jobs: object, processes: dict[str, Popen[bytes]], progress: object) -> None:
        text = (tmp_path / "there" / "report.html").read_text()
        assert "No film: not drawn yet" in text
        assert all(process.poll() is None for process in processes.values())
        began.extend(processes.values())
        raise KeyboardInterrupt

    began: list[Popen[bytes]] = []
    monkeypatch.setattr("kinesic.report.output.draw_films", stop)
    ended = kinesic("perform", "-", "--out", "there", stdin=NOD)
    assert (ended.code, ended.out) == (130, "")
    assert ended.err == "kinesic: stopped before its films were drawn; page: there/report.html\n"
    assert json.loads((tmp_path / "there" / "report.json").read_text())["ok"]
    assert len(began) == 2
    assert all(process.poll() is not None for process in began), "they end with the command"
