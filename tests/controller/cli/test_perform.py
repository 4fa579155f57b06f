import json

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


@pytest.fixture
def nod(tmp_path):
    path = tmp_path / "nod.bml"
    path.write_bytes(NOD)
    return path


def test_a_nod_is_performed_and_the_paths_are_printed_last(kinesic, nod, tmp_path):
    ended = kinesic("perform", nod, "--out", "there", "--no-film")
    assert ended.code == 0, ended.err
    assert ended.out.splitlines()[-2:] == ["report: there/report.json", "page: there/report.html"]
    data = json.loads((tmp_path / "there" / "report.json").read_text())
    assert data.keys() >= KEYS
    assert data["ok"]
    (behaviour,) = data["behaviours"]
    assert behaviour.items() >= {"id": "h", "type": "head", "outcome": "realised", "why": ""}.items()
    assert behaviour["manner"]["modality"] == "head"
    assert (tmp_path / "there" / "report.html").stat().st_size > 10_000


def test_json_is_one_document_on_standard_output(kinesic, nod):
    ended = kinesic("perform", nod, "--out", "there", "--no-film", "--json")
    assert json.loads(ended.out)["schema"] == 1
    assert "report: there/report.json" in ended.err


def test_standard_input(kinesic):
    ended = kinesic("perform", "-", "--out", "there", "--no-film", "--json", stdin=NOD)
    assert json.loads(ended.out)["input"] == "stdin"


def test_an_existing_folder_is_refused_without_force(kinesic, nod, tmp_path):
    (tmp_path / "there").mkdir()
    refused = kinesic("perform", nod, "--out", "there", "--no-film")
    assert refused.code == 2
    assert "there exists already" in refused.err
    assert kinesic("perform", nod, "--out", "there", "--no-film", "--force").code == 0


def test_the_same_input_gives_the_same_report(kinesic, nod):
    first, second = (
        json.loads(kinesic("perform", nod, "--out", name, "--no-film", "--json").out) for name in ("a", "b")
    )
    first.pop("timing"), second.pop("timing")
    assert first == second


def test_the_pessimistic_twin_tracks_worse(kinesic, nod):
    runs = [
        json.loads(kinesic("perform", nod, "--out", name, "--no-film", "--json", "--twin", name).out)
        for name in ("nominal", "pessimistic")
    ]
    assert runs[0]["tracking"]["rmse_deg"] < runs[1]["tracking"]["rmse_deg"]
