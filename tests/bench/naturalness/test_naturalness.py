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
def few_gestures(known):
    """Measure two gestures in two styles."""
    forms = [form for form in known.lexicon.forms if form.id in ("beat", "offer")]
    measured = [measure_gesture(form, known) for form in forms]
    return (*measured, *(replace(gesture, style="calm") for gesture in measured))


@pytest.fixture(autouse=True)
def short_benchmark(few_gestures, monkeypatch):
    """Skip the varied lexicon, other bodies, and stories that other tests plan."""
    monkeypatch.setattr(naturalness, "varied", lambda: {7: few_gestures[:2]})
    monkeypatch.setattr(synchrony, "STORY_STYLES", {})
    monkeypatch.setattr(story, "STORY_STYLES", story.STORY_STYLES[:1])
    monkeypatch.setattr(naturalness, "COMPARED_ROBOTS", ())


@pytest.fixture
def folder(tmp_path):
    write_skeleton(tmp_path / "clips")
    turns = np.outer(np.sin(np.linspace(0.0, 3.0, 90)) ** 2, [0.0, 1.0, 0.0])
    write_clip(tmp_path / "clips" / "ChrTest@BeatLf01.skm", {"JtShoulderLf Quat": turns})
    return tmp_path / "clips"


def run(*words):
    return cli.kinesic.main(["bench", *map(str, words)], standalone_mode=False)


def test_naturalness_benchmark_measures_a_given_folder_of_clips_instead_of_the_lexicon(folder, capsys):
    run("naturalness", "--capture", folder, "--json")
    metrics = {metric["name"]: metric for metric in json.loads(capsys.readouterr().out)}
    assert metrics["naturalness.captured.clips"]["value"] == 1
    assert "known names of chest, head" in metrics["naturalness.captured.unread_bodies"]["why"]
    assert metrics["naturalness.captured.duration"]["value"] == pytest.approx(89 / 30, abs=1e-5)
    assert all(name.startswith("naturalness.captured.") for name in metrics)


def test_naturalness_of_styles_and_captured_motion_is_measured(folder, few_gestures, capsys, monkeypatch):
    requested = []
    monkeypatch.setattr(naturalness, "measured", lambda styles: requested.append(styles) or few_gestures)
    run("naturalness", "--style", "neutral", "--style", "calm", "--capture", folder, "--json")
    names = {metric["name"] for metric in json.loads(capsys.readouterr().out)}
    assert requested == [("neutral", "calm")]
    assert {"naturalness.flow", "naturalness.calm.flow", "naturalness.captured.flow", "naturalness.variety"} <= names


def test_only_neutral_style_has_metrics_with_random_variation(few_gestures, monkeypatch):
    monkeypatch.setattr(naturalness, "measured", lambda _: few_gestures)
    names = {metric.name for metric in naturalness.bench_styles(["neutral", "calm"])}
    assert {"naturalness.varied.7.alike", "naturalness.varied.7.misplaced"} <= names
    assert not any(".varied." in metric.name for metric in naturalness.bench_styles(["calm"]))


@pytest.mark.soak
def test_naturalness_plot_is_written_for_a_style_but_not_for_clips_alone(
    few_gestures, folder, tmp_path, capsys, monkeypatch
):
    monkeypatch.setattr(
        naturalness, "measured", lambda styles: [gesture for gesture in few_gestures if gesture.style in styles]
    )
    run("naturalness", "--style", "calm", "--plots", tmp_path / "calm")
    assert os.listdir(tmp_path / "calm") == ["naturalness.png"]
    run("naturalness", "--capture", folder, "--plots", tmp_path / "clips only")
    assert os.listdir(tmp_path / "clips only") == []
    assert "naturalness.calm.flow" in capsys.readouterr().out


@pytest.mark.parametrize("words", [("--style", "calm"), ("--capture", "clips")])
def test_style_and_capture_options_are_rejected_for_the_plan_benchmark(words):
    with pytest.raises(click.UsageError, match="apply only to naturalness"):
        run("plan", *words)


def test_missing_corpus_gives_a_null_clip_metric_with_a_reason(few_gestures, monkeypatch, tmp_path):
    monkeypatch.setenv("KINESIC_CORPUS", str(tmp_path / "nowhere"))
    monkeypatch.setattr(naturalness, "measured", lambda _: few_gestures)
    missing = naturalness.bench()[-1]
    assert (missing.name, missing.value) == ("naturalness.captured.clips", None)
    assert "KINESIC_CORPUS" in missing.why


def test_naturalness_benchmark_also_measures_the_motion_capture_corpus(few_gestures, monkeypatch, folder):
    os.rename(folder, folder.parent / naturalness.CAPTURE_FOLDER)
    monkeypatch.setenv("KINESIC_CORPUS", str(folder.parent))
    monkeypatch.setattr(naturalness, "measured", lambda _: few_gestures)
    assert {metric.name: metric.value for metric in naturalness.bench()}["naturalness.captured.clips"] == 1


@pytest.mark.soak
def test_plots_of_naturalness_and_distances_from_people_are_drawn(few_gestures, tmp_path):
    pictures = draw(few_gestures, tmp_path)
    assert [path.name for path in pictures] == ["naturalness.png", "naturalness-distances.png"]
    for path in pictures:
        with Image.open(path) as drawn:
            assert np.asarray(drawn.convert("L")).std() > 5
