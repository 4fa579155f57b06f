"""A study of gestures, made on the command line."""

import json
from pathlib import Path

import pytest

GESTURES = [word for name in ("stop", "piano", "sea", "sleep", "photo", "offer") for word in ("--gesture", name)]
TEXT = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    '<speech id="s" start="0"><text>Hello!</text></speech><gesture id="g" lexeme="{lexeme}" stroke="6"/></bml>'
)


def study_in(page: Path) -> dict:
    """What the page's script reads."""
    return json.loads(page.read_text().split('type="application/json">')[1].split("</script>")[0])


def test_gestures_texts_and_settings_that_are_named_are_in_the_page(kinesic, tmp_path: Path):
    (tmp_path / "hello.bml").write_text(TEXT.format(lexeme="welcome"))
    asked = ("--pairs", "1", "--text", "hello.bml", "--compare", "whole_body=0", "--compare", "idle=0")
    ended = kinesic("study", "make-gestures", *GESTURES, *asked, "--voice", "durations", "--out", "made")
    assert ended.code == 0, ended.err
    assert ended.out == "page: made/index.html\n"
    study = study_in(tmp_path / "made" / "index.html")
    recognised = [trial["stimulus"] for trial in study["trials"] if trial["task"] == "recognition"]
    assert sorted(recognised) == sorted(GESTURES[1::2])
    compared = [(trial["condition"], trial["stimulus"]) for trial in study["trials"] if trial["task"] == "comparison"]
    assert compared[0] == ("whole_body=0", "hello")
    assert compared[1][1] in recognised
    without_idle = {stimulus for setting, stimulus in compared[2:] if setting == "idle=0"}
    assert "hello" in without_idle
    assert not without_idle & {"stop", "offer", "photo"}, "a short gesture alone has no pause"
    assert [said[2] for motion in study["motions"] for said in motion["words"] if said[2]] == ["Hello!"] * 3
    assert len(study["motions"]) == 6 + 2 + 1 + len(without_idle)


@pytest.mark.parametrize(
    ("asked", "what"),
    [
        (("--compare", "power=0"), "--compare power=0 changes nothing that anybody could see here"),
        (("--compare", "powerr=1"), "a style has no powerr"),
        (("--text", "nowhere.bml"), "nowhere.bml: No such file"),
        (("--text", "a/x.bml", "--text", "b/x.bml"), "there is another text x"),
        (("--post-to", "ftp://x"), "--post-to ftp://x: must be a URL"),
    ],
)
def test_what_cannot_be_done_is_told_in_one_line_and_nothing_is_written(kinesic, tmp_path: Path, asked, what: str):
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "x.bml").write_text(TEXT.format(lexeme="stop"))
    ended = kinesic("study", "make-gestures", *GESTURES, *asked, "--out", "made")
    assert ended.code == 2
    assert what in ended.err
    assert ended.err.count("\n") == 1
    assert not (tmp_path / "made").exists()
