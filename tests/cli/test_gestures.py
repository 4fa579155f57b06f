import json
from types import SimpleNamespace

import pytest
from PIL import Image

from kinesic.bml.block import BmlError
from kinesic.cli import gestures
from kinesic.studies.gestures import portraits

OWN_LEXICON = """
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


def test_json_gesture_list_has_all_fields_of_every_gesture(kinesic):
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


def test_gesture_list_is_filtered_by_category_and_unknown_ones_reported(kinesic):
    listed = kinesic("gestures", "list", "--category", "emotion")
    assert listed.code == 0
    assert "joy_cheer" in listed.out
    assert "greet_wave" not in listed.out
    assert any("gasp" in line and "sudden" in line for line in listed.out.splitlines())
    unknown = kinesic("gestures", "list", "--category", "emotions")
    assert unknown.code == 2
    assert unknown.err.startswith("kinesic: no category emotions; did you mean emotion?")


def test_gestures_show_prints_description_and_synonyms_and_hand_shape_and_path_of_a_gesture(kinesic, tmp_path):
    (tmp_path / "own.toml").write_text(OWN_LEXICON)
    shown = kinesic("gestures", "show", "swirl", "--lexicon", "own.toml")
    assert shown.code == 0
    assert shown.out.startswith(
        "own (emotion), swirl is a synonym\nThe fist circles.\nmeanings: swirl, own\nsynonyms: swirl\n"
    )
    assert "circle" in shown.out
    assert "fist" in shown.out


def test_gestures_show_prints_positions_and_directions_of_the_lexicon_file(kinesic, tmp_path):
    pose = 'at = [0.1, 0.2, 0.4], palm = "in down", pointing = "forward", shape = "flat"'
    gesture = f'[[gesture]]\nid = "own"\nsays = "x."\nmeanings = ["own"]\nkeys = [{{ right = {{ {pose} }} }}]\n'
    (tmp_path / "own.toml").write_text(f'category = "emotion"\n{gesture}')
    *_, headings, row = kinesic("gestures", "show", "own", "--lexicon", "own.toml").out.splitlines()
    assert headings.split()[2:7] == ["outward", "up", "forward", "palm", "pointing"]
    assert row.split()[2:8] == ["0.10", "0.20", "0.40", "in", "down", "forward"]


def test_gestures_render_writes_a_picture_of_one_gesture(kinesic, tmp_path):
    (tmp_path / "own.toml").write_text(OWN_LEXICON)
    ended = kinesic("gestures", "render", "own", "--lexicon", "own.toml", "--out", "own.png")
    assert ended.code == 0
    assert ended.out.splitlines()[-1] == "picture: own.png"
    assert (tmp_path / "own.png").read_bytes().startswith(b"\x89PNG")


def test_gesture_named_with_a_hand_is_drawn_with_that_hand_and_its_substitution_is_printed(kinesic, monkeypatch):
    drawn = []

    def draw(gesture, robot, path, description, **options):
        drawn.append(gesture)
        path.write_text(description)

    monkeypatch.setattr(gestures, "_draw_key_postures", draw)
    ended = kinesic("gestures", "render", "beat_mid_lf", "--out", "beat.svg")
    assert ended.out.splitlines() == ['beat_mid_lf: substituted by beat: "mid" is left out', "picture: beat.svg"]
    (gesture,) = drawn
    assert (gesture.form.sides, set(gesture.paths)) == ({"l"}, {"l"})
    assert len(gesture.postures) >= 2


@pytest.mark.parametrize("arguments", [(), ("offer", "--all"), ("xyzzy",)])
def test_gestures_render_refuses_invalid_arguments_and_writes_no_file(kinesic, tmp_path, arguments):
    ended = kinesic("gestures", "render", *arguments, "--out", "x.png")
    assert ended.code == 2
    assert not (tmp_path / "x.png").exists()


def test_gestures_render_reports_an_unwritable_picture_in_one_line(kinesic):
    ended = kinesic("gestures", "render", "offer", "--out", "nowhere/offer.png")
    assert ended.code == 2
    assert ended.err.count("\n") == 1
    ended = kinesic("gestures", "render", "offer", "--out", "offer.xyz")
    assert ended.code == 2
    assert "xyz" in ended.err


@pytest.mark.parametrize("name", ["offer.svg", "offer.png"])
def test_gesture_render_draws_lines_without_opengl_or_for_vector_formats(kinesic, tmp_path, monkeypatch, name):
    monkeypatch.setattr(portraits, "opengl_fault", lambda: "OpenGL is missing: install it")
    ended = kinesic("gestures", "render", "offer", "--out", name)
    assert ended.code == 0
    assert (tmp_path / name).stat().st_size > 1000
    assert ("kinesic: drawn as lines: OpenGL is missing: install it" in ended.err) == name.endswith(".png")


def test_turntable_of_a_gesture_is_a_looping_film(kinesic, tmp_path, monkeypatch):
    if why := portraits.opengl_fault():
        pytest.skip(why)
    monkeypatch.setattr(portraits, "TURNTABLE_FRAMES", 6)
    ended = kinesic("gestures", "render", "offer", "--turntable", "--out", "offer.webp")
    assert ended.code == 0
    assert ended.out.splitlines()[-1] == "film: offer.webp"
    with Image.open(tmp_path / "offer.webp") as film:
        assert film.n_frames == 6
        assert film.info["loop"] == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--all", "--turntable", "--out", "x.webp"), "leave out --all"),
        (("offer", "--turntable", "--drawn", "--out", "x.webp"), "leave out --drawn"),
        (("offer", "--turntable", "--out", "x.svg"), "end in .webp, .mp4, .png"),
    ],
)
def test_invalid_turntable_options_are_refused(kinesic, tmp_path, arguments, message):
    ended = kinesic("gestures", "render", *arguments)
    assert ended.code == 2
    assert message in ended.err
    assert list(tmp_path.iterdir()) == []


def test_turntable_film_of_a_gesture_requires_opengl(kinesic, tmp_path, monkeypatch):
    monkeypatch.setattr(portraits, "opengl_fault", lambda: "OpenGL is missing: install it")
    ended = kinesic("gestures", "render", "offer", "--turntable", "--out", "x.webp")
    assert ended.code == 2
    assert ended.err.splitlines()[-1] == "kinesic: no turntable: OpenGL is missing: install it"
    assert not (tmp_path / "x.webp").exists()


def test_json_gesture_list_of_a_category_has_only_this_category(kinesic):
    ended = kinesic("gestures", "list", "--category", "beat", "--json")
    assert ended.code == 0
    entries = json.loads(ended.out)
    assert entries
    assert {entry["category"] for entry in entries} == {"beat"}


def test_turntable_file_name_is_checked_before_the_gesture_is_planned(kinesic):
    ended = kinesic("gestures", "render", "xyzzy", "--turntable", "--out", "x.svg")
    assert ended.code == 2
    assert "x.svg" in ended.err
    assert "xyzzy" not in ended.err


def test_gesture_search_by_words_lists_the_best_match_first(kinesic):
    data = json.loads(kinesic("gestures", "find", "weigh", "two things", "--json", "--count", "3").out)
    assert data[0]["id"] == "balance"
    assert len(data) == 3
    ended = kinesic("gestures", "find", "thumbs", "up")
    assert ended.code == 0
    assert ended.out.splitlines()[1].split()[:3] == ["thumb_up", "emblem", "synonym"]


def test_gesture_search_without_a_result_prints_one_line(kinesic):
    ended = kinesic("gestures", "find", "qqqq")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert "no gesture for 'qqqq'; try other words" in ended.err
    assert len(kinesic("gestures", "find", "q" * 5000).err) < 200
    assert "no category iconik; did you mean iconic?" in kinesic("gestures", "find", "x", "--category", "iconik").err


def test_infeasible_gesture_is_reported_and_the_others_are_drawn(monkeypatch, capsys):
    def plan(form, setup):
        if form == "far":
            raise BmlError("gesture far cannot be performed")

    monkeypatch.setattr(gestures, "plan_gesture", plan)
    monkeypatch.setattr(gestures, "key_postures", lambda form, *_: form)
    done = []
    forms = SimpleNamespace(lexicon=SimpleNamespace(forms=("near", "far", "high", "low")))
    assert list(gestures._plan_feasible_gestures(forms, done.append)) == ["near", "high", "low"]
    assert capsys.readouterr().err == "kinesic: gesture far cannot be performed\n"
    assert done == [0.0, 0.25, 0.5, 0.75]
