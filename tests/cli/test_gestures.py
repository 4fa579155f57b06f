import json

import pytest
from PIL import Image

from kinesic.studies.gestures import portraits

OWN = """
category = "emotion"
[[gesture]]
id = "own"
says = "The fist circles."
meanings = ["swirl"]
keys = [
  { right = { at = [0.36, 0.40, 0.56], palm = "in", shape = "fist" } },
  { right = { at = [0.36, 0.40, 0.56], palm = "in", shape = "fist" }, path = { kind = "circle" } },
]
"""


def test_the_list_is_a_vocabulary(kinesic):
    entries = json.loads(kinesic("gestures", "list", "--json").out)
    assert len(entries) >= 150
    fields = {"id", "category", "says", "meanings", "hands", "shapes", "stroke_s", "whole_s", "synonyms", "tempo"}
    assert all(fields <= set(entry) for entry in entries)
    offer = next(entry for entry in entries if entry["id"] == "offer")
    assert offer["category"] == "metaphoric"
    assert "propose" in offer["meanings"]
    assert offer["hands"] == ["right"]
    tempos = {entry["id"]: entry["tempo"] for entry in entries}
    assert (tempos["gasp"], tempos["offer"], tempos["think"]) == ("sudden", "neutral", "sustained")


def test_a_category_is_listed_alone_and_a_wrong_one_is_named(kinesic):
    listed = kinesic("gestures", "list", "--category", "emotion")
    assert "joy_cheer" in listed.out
    assert "greet_wave" not in listed.out
    assert any("gasp" in line and "sudden" in line for line in listed.out.splitlines())
    wrong = kinesic("gestures", "list", "--category", "emotions")
    assert wrong.code == 2
    assert wrong.err.startswith("kinesic: no category emotions; did you mean emotion?")


def test_a_gesture_is_shown_with_words_shapes_and_paths(kinesic, tmp_path):
    (tmp_path / "own.toml").write_text(OWN)
    shown = kinesic("gestures", "show", "swirl", "--lexicon", "own.toml")
    assert shown.code == 0
    assert shown.out.startswith(
        "own (emotion), swirl is a synonym\nThe fist circles.\nmeanings: swirl, own\nsynonyms: swirl\n"
    )
    assert "circle" in shown.out
    assert "fist" in shown.out


def test_one_gesture_is_drawn(kinesic, tmp_path):
    (tmp_path / "own.toml").write_text(OWN)
    ended = kinesic("gestures", "render", "own", "--lexicon", "own.toml", "--out", "own.png")
    assert ended.code == 0
    assert ended.out.splitlines()[-1] == "picture: own.png"
    assert (tmp_path / "own.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("arguments", [(), ("offer", "--all"), ("xyzzy",)])
def test_what_cannot_be_drawn_is_bad_input(kinesic, tmp_path, arguments):
    ended = kinesic("gestures", "render", *arguments, "--out", "x.png")
    assert ended.code == 2
    assert not (tmp_path / "x.png").exists()


def test_a_picture_that_cannot_be_written_is_one_line(kinesic):
    ended = kinesic("gestures", "render", "offer", "--out", "nowhere/offer.png")
    assert ended.code == 2
    assert ended.err.count("\n") == 1
    ended = kinesic("gestures", "render", "offer", "--out", "offer.xyz")
    assert ended.code == 2
    assert "xyz" in ended.err


@pytest.mark.parametrize("name", ["offer.svg", "offer.png"])
def test_lines_are_drawn_where_there_is_no_opengl_or_no_pixel(kinesic, tmp_path, monkeypatch, name):
    monkeypatch.setattr(portraits, "opengl_fault", lambda: "OpenGL is missing: install it")
    ended = kinesic("gestures", "render", "offer", "--out", name)
    assert ended.code == 0
    assert (tmp_path / name).stat().st_size > 1000
    assert ("kinesic: drawn in lines: OpenGL is missing: install it" in ended.err) == name.endswith(".png")


def test_a_turntable_is_a_film(kinesic, tmp_path, monkeypatch):
    if why := portraits.opengl_fault():
        pytest.skip(why)
    monkeypatch.setattr(portraits, "ROUND", 6)
    ended = kinesic("gestures", "render", "offer", "--turntable", "--out", "offer.webp")
    assert ended.code == 0
    assert ended.out.splitlines()[-1] == "film: offer.webp"
    with Image.open(tmp_path / "offer.webp") as film:
        assert film.n_frames == 6
        assert film.info["loop"] == 0


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("--all", "--turntable", "--out", "x.webp"), "leave out --all"),
        (("offer", "--turntable", "--drawn", "--out", "x.webp"), "leave out --drawn"),
        (("offer", "--turntable", "--out", "x.svg"), "ends in .webp, .mp4, .png"),
    ],
)
def test_a_turntable_that_cannot_be_is_bad_input(kinesic, tmp_path, arguments, told):
    ended = kinesic("gestures", "render", *arguments)
    assert ended.code == 2
    assert told in ended.err
    assert list(tmp_path.iterdir()) == []


def test_a_turntable_needs_opengl(kinesic, tmp_path, monkeypatch):
    monkeypatch.setattr(portraits, "opengl_fault", lambda: "OpenGL is missing: install it")
    ended = kinesic("gestures", "render", "offer", "--turntable", "--out", "x.webp")
    assert ended.code == 2
    assert ended.err.splitlines()[-1] == "kinesic: no turntable: OpenGL is missing: install it"
    assert not (tmp_path / "x.webp").exists()
