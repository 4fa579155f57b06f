import json

import pytest


def test_sweep_prints_a_table_and_writes_results(kinesic, tmp_path):
    ended = kinesic("sweep", "flat_surface", "--parameter", "spatial", "--values", "-1,0", "--out", "wide")
    assert ended.code == 0
    assert "flat_surface: spatial (monotone)" in ended.out
    assert ended.out.splitlines()[-2:] == ["json: wide/sweep.json", "png: wide/spatial.png"]
    data = json.loads((tmp_path / "wide" / "sweep.json").read_text())
    (series,) = data["series"]
    assert (series["parameter"], series["measure"], series["monotone"]) == ("spatial", "swept_volume", True)
    assert [played["value"] for played in series["played"]] == [-1.0, 0.0]
    assert (tmp_path / "wide" / "spatial.png").stat().st_size > 1000
    answer = kinesic("results", 'SELECT "value", swept_volume FROM sweep', "wide", "--json").out
    assert [row["value"] for row in json.loads(answer)] == [-1.0, 0.0]


def test_sweep_with_option_json_prints_only_json_to_standard_output(kinesic, monkeypatch):
    monkeypatch.setattr("kinesic.cli.sweep.draw_series", lambda series, path: path)
    ended = kinesic("sweep", "beat", "--parameter", "openness", "--values", "0.5", "--json", "--style", "calm")
    data = json.loads(ended.out)
    assert (data["gesture"], data["style"], data["stroke_s"]) == ("beat", "calm", 6.0)
    assert ended.err.splitlines()[0].startswith("json: out/sweep-beat-")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("beet", "--parameter", "power"), "no gesture beet; did you mean beat?"),
        (("beat", "--parameter", "powr"), "a style has no powr; did you mean power?"),
        (("beat", "--parameter", "power", "--values", "a"), "--values is 'a'; give numbers separated by commas"),
        (("beat", "--parameter", "power", "--values", "3"), "power is 3, outside [-1, 1]"),
        (("beat",), "give --parameter NAME or --all"),
        (("beat", "--all", "--parameter", "power"), "give --parameter NAME or --all"),
    ],
)
def test_invalid_input_of_sweep_is_reported_in_one_line(kinesic, arguments, message, tmp_path):
    ended = kinesic("sweep", *arguments, "--out", "o")
    assert ended.code == 2
    assert ended.err.startswith(f"kinesic: {message}")
    assert len(ended.err.splitlines()) == 1
    assert not (tmp_path / "o").exists()


def test_sweep_refuses_an_existing_output_folder_without_force(kinesic, tmp_path):
    (tmp_path / "o").mkdir()
    (tmp_path / "o" / "letter").write_text("dear")
    ended = kinesic("sweep", "beat", "--parameter", "power", "--out", "o")
    assert ended.code == 2
    assert "--force" in ended.err
