import json
import os
from dataclasses import replace

import click
import numpy as np
import pytest
from PIL import Image

from kinesic import cli
from kinesic.bench import naturalness
from kinesic.bench.naturalness import story, synchrony
from kinesic.bench.naturalness.lexicon import measure_gesture
from kinesic.bench.naturalness.plots import draw

from .clips import write_clip, write_skeleton


@pytest.fixture(scope="module")
def few(known):
    """Two gestures in two styles."""
    forms = [form for form in known.lexicon.forms if form.id in ("beat", "offer")]
    found = [measure_gesture(form, known) for form in forms]
    return (*found, *(replace(each, style="calm") for each in found))


@pytest.fixture(autouse=True)
def varied(few, monkeypatch):
    """Spares the benches the whole lexicon as it varies, and stories that other tests plan."""
    monkeypatch.setattr(naturalness, "varied", lambda: {7: few[:2]})
    monkeypatch.setattr(synchrony, "STORY_STYLES", {})
    monkeypatch.setattr(story, "STYLES", story.STYLES[:1])


@pytest.fixture
def folder(tmp_path):
    write_skeleton(tmp_path / "clips")
    turns = np.outer(np.sin(np.linspace(0.0, 3.0, 90)) ** 2, [0.0, 1.0, 0.0])
    write_clip(tmp_path / "clips" / "ChrTest@BeatLf01.skm", {"JtShoulderLf Quat": turns})
    return tmp_path / "clips"


def run(*words):
    return cli.kinesic.main(["bench", *map(str, words)], standalone_mode=False)


def test_a_folder_of_clips_is_measured_instead_of_the_lexicon(folder, capsys):
    run("naturalness", "--capture", folder, "--json")
    figures = {figure["name"]: figure for figure in json.loads(capsys.readouterr().out)}
    assert figures["naturalness.captured.clips"]["value"] == 1
    assert figures["naturalness.captured.duration"]["value"] == pytest.approx(89 / 30, abs=1e-5)
    assert all(name.startswith("naturalness.captured.") for name in figures)


def test_styles_are_measured_alone_or_beside_clips(folder, few, capsys, monkeypatch):
    asked = []
    monkeypatch.setattr(naturalness, "measured", lambda styles: asked.append(styles) or few)
    run("naturalness", "--style", "neutral", "--style", "calm", "--capture", folder, "--json")
    names = {figure["name"] for figure in json.loads(capsys.readouterr().out)}
    assert asked == [("neutral", "calm")]
    assert {"naturalness.flow", "naturalness.calm.flow", "naturalness.captured.flow", "naturalness.variety"} <= names


def test_the_neutral_manner_is_measured_as_it_varies_too(few, monkeypatch):
    monkeypatch.setattr(naturalness, "measured", lambda _: few)
    names = {figure.name for figure in naturalness.bench_styles(["neutral", "calm"])}
    assert {"naturalness.varied.7.alike", "naturalness.varied.7.misplaced"} <= names
    assert not any(".varied." in figure.name for figure in naturalness.bench_styles(["calm"]))


def test_pictures_are_of_the_styles_that_are_measured(few, folder, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(naturalness, "measured", lambda styles: [each for each in few if each.style in styles])
    run("naturalness", "--style", "calm", "--plots", tmp_path / "calm")
    assert os.listdir(tmp_path / "calm") == ["naturalness.png"]
    run("naturalness", "--capture", folder, "--plots", tmp_path / "clips only")
    assert os.listdir(tmp_path / "clips only") == []
    assert "naturalness.calm.flow" in capsys.readouterr().out


@pytest.mark.parametrize("words", [("--style", "calm"), ("--capture", "clips")])
def test_other_parts_have_neither_styles_nor_clips(words):
    with pytest.raises(click.UsageError, match="naturalness alone"):
        run("plan", *words)


def test_without_a_corpus_it_says_what_is_missing(few, monkeypatch, tmp_path):
    monkeypatch.setenv("KINESIC_CORPUS", str(tmp_path / "nowhere"))
    monkeypatch.setattr(naturalness, "measured", lambda _: few)
    missing = naturalness.bench()[-1]
    assert (missing.name, missing.value) == ("naturalness.captured.clips", None)
    assert "KINESIC_CORPUS" in missing.why


def test_a_corpus_is_measured_beside_the_lexicon(few, monkeypatch, folder):
    os.rename(folder, folder.parent / naturalness.CAPTURE)
    monkeypatch.setenv("KINESIC_CORPUS", str(folder.parent))
    monkeypatch.setattr(naturalness, "measured", lambda _: few)
    assert {figure.name: figure.value for figure in naturalness.bench()}["naturalness.captured.clips"] == 1


def test_pictures_show_all_manners_and_the_neutral_one_beside_people(few, tmp_path):
    pictures = draw(few, tmp_path)
    assert [path.name for path in pictures] == ["naturalness.png", "naturalness-distances.png"]
    for path in pictures:
        with Image.open(path) as drawn:
            assert np.asarray(drawn.convert("L")).std() > 5
