"""Creation of a gesture study by `kinesic study make-gestures`."""

import json
from pathlib import Path

import pytest

GESTURES = [word for name in ("stop", "piano", "sea", "sleep", "photo", "offer") for word in ("--gesture", name)]
TEXT = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    '<speech id="s" start="0"><text>Hello!</text></speech><gesture id="g" lexeme="{lexeme}" stroke="6"/></bml>'
)


def study_in(page: Path) -> dict:
    """Return the study data that is embedded in the page."""
    return json.loads(page.read_text().split('type="application/json">')[1].split("</script>")[0])


def test_study_page_contains_named_gestures_texts_and_settings(kinesic, tmp_path: Path):
    (tmp_path / "hello.bml").write_text(TEXT.format(lexeme="welcome"))
    options = ("--pairs", "1", "--text", "hello.bml", "--compare", "whole_body=0", "--compare", "idle=0")
    ended = kinesic("study", "make-gestures", *GESTURES, *options, "--voice", "durations", "--out", "made")
    assert ended.code == 0, ended.err
    assert ended.out == "page: made/index.html\n"
    study = study_in(tmp_path / "made" / "index.html")
    recognition_stimuli = [trial["stimulus"] for trial in study["trials"] if trial["task"] == "recognition"]
    assert sorted(recognition_stimuli) == sorted(GESTURES[1::2])
    comparisons = [
        (trial["condition"], trial["stimulus"]) for trial in study["trials"] if trial["task"] == "comparison"
    ]
    assert comparisons[0] == ("whole_body=0", "hello")
    assert comparisons[1][1] in recognition_stimuli
    without_idle = {stimulus for setting, stimulus in comparisons[2:] if setting == "idle=0"}
    assert "hello" in without_idle
    assert not without_idle & {"stop", "offer", "photo"}, "a short gesture contains no pause"
    assert [word[2] for motion in study["motions"] for word in motion["words"] if word[2]] == ["Hello!"] * 3
    assert len(study["motions"]) == 6 + 2 + 1 + len(without_idle)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--compare", "power=0"), "--compare power=0 changes no gesture visibly"),
        (("--compare", "powerr=1"), "a style has no powerr"),
        (("--text", "nowhere.bml"), "nowhere.bml: No such file"),
        (("--text", "a/x.bml", "--text", "b/x.bml"), "another text is named x"),
        (("--post-to", "ftp://x"), "--post-to ftp://x: must be a URL"),
    ],
)
def test_invalid_study_options_are_reported_and_write_nothing(kinesic, tmp_path: Path, options, message: str):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "x.bml").write_text(TEXT.format(lexeme="stop"))
    ended = kinesic("study", "make-gestures", *GESTURES, *options, "--out", "made")
    assert ended.code == 2
    assert message in ended.err
    assert ended.err.count("\n") == 1
    assert not (tmp_path / "made").exists()
