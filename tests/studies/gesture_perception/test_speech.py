"""Motions with speech for the mismatching test, and printed results."""

import csv
import json
from pathlib import Path
from random import Random

import numpy as np
import pytest
from click.testing import CliRunner

from kinesic.body.config import ConfigError
from kinesic.cli import kinesic
from kinesic.studies.gesture_perception.answers import ANSWER_COLUMNS, read_gesture_answers
from kinesic.studies.gesture_perception.speech import (
    SpokenMotion,
    choose_foils,
    plan_spoken_motions,
    shown_duration,
)
from kinesic.studies.gesture_perception.stimuli import SampledMotion


def test_each_speech_is_the_wrong_option_of_exactly_one_other_text():
    durations = {"a": 5.0, "b": 9.0, "c": 5.2, "d": 9.1, "e": 20.0}
    foils = choose_foils(durations)
    assert sorted(foils.values()) == sorted(durations)
    assert all(name != foil for name, foil in foils.items())
    assert (foils["a"], foils["c"]) == ("c", "a")
    assert sum(abs(durations[name] - durations[foil]) for name, foil in foils.items()) == pytest.approx(22.4)


@pytest.mark.parametrize(("own", "other", "expected"), [(2.0, 3.0, 2.8), (3.0, 2.0, 2.8), (3.8, 4.0, 4.5)])
def test_motion_is_shown_equally_long_with_either_speech(own: float, other: float, expected: float):
    one, two = (
        SpokenMotion("t", "s", SampledMotion(np.zeros((226, 3))), begin, begin + seconds, None)
        for begin, seconds in ((0.5, own), (1.0, other))
    )
    assert shown_duration(one, two) == pytest.approx(expected)


def test_speech_study_plans_every_text_with_every_compared_system(known):
    texts = {"one": ("The roses are dry.", True), "two": ("We found three boxes.", True)}
    spoken = plan_spoken_motions(texts, known, ["whole_body=0"])
    assert [(item.system, item.text) for item in spoken] == [
        (system, text) for system in ("standard", "whole_body=0") for text in texts
    ]
    assert spoken[0].motion.differs(spoken[2].motion)
    assert [item.motion.words[0].text[:3] for item in spoken] == ["The", "We ", "The", "We "]  # a silent voice is read
    assert all(0.0 <= item.begin < item.end <= item.motion.duration + 0.1 for item in spoken)


@pytest.mark.parametrize(
    ("texts", "why"),
    [
        ({"one": ("Hello.", True)}, "1 text is given"),
        ({"a|b": ("Hello.", True), "c": ("Bye.", True)}, "separates options"),
        (
            {"a": ("Hello.", True), "b": ('<bml><head id="h" lexeme="NOD"/></bml>', False)},
            "text b has no speech",
        ),
    ],
)
def test_speech_study_refuses_a_single_text_and_texts_without_speech_and_names_with_a_separator(known, texts, why: str):
    with pytest.raises(ConfigError, match=why.replace("|", r"\|")):
        plan_spoken_motions(texts, known, [])


def write_study(path: Path, participants: int = 30) -> Path:
    """Write answers in which 75 % match the speech of system `rules`."""
    chance, rows = Random(2), []
    for person in range(participants):
        for k, system in enumerate(("rules", "idle") * 4):
            chosen = "own" if chance.random() < (0.75 if system == "rules" else 0.5) else "other"
            options = ["own", "other"][:: 1 - 2 * (k // 2 % 2)]
            rows.append((person, "mismatching", "own", system, options, chosen))
        for k in range(4):
            chosen = "rules" if chance.random() < 0.76 else "idle"
            rows.append((person, "realism", "own", "rules idle", ["rules", "idle"][:: 1 - 2 * (k % 2)], chosen))
    with path.open("w", newline="") as lines:
        writer = csv.DictWriter(lines, ANSWER_COLUMNS)
        writer.writeheader()
        for place, (person, task, stimulus, condition, options, chosen) in enumerate(rows):
            values = (f"p{person}", place, task, stimulus, condition, "|".join(options), chosen, 1.0)
            writer.writerow(dict(zip(ANSWER_COLUMNS, values, strict=True)))
    return path


def test_analysis_of_a_speech_study_prints_match_rates_and_elo_ratings(tmp_path: Path):
    file = write_study(tmp_path / "answers.csv")
    data = json.loads(CliRunner().invoke(kinesic, ["study", "analyse", str(file), "--json"]).stdout)
    rules, idle = (data["mismatching"]["systems"][name] for name in ("rules", "idle"))
    assert rules["share"] == pytest.approx(0.75, abs=0.08)
    assert rules["p"] < 0.001 < 0.05 < idle["p"]
    assert rules["detectable"] == pytest.approx(0.63, abs=0.01)
    ratings = data["elo"]["systems"]
    lead = ratings["rules"]["rating"] - ratings["idle"]["rating"]
    assert lead == pytest.approx(200.0, abs=70.0)
    assert ratings["rules"]["rating"] + ratings["idle"]["rating"] == pytest.approx(2000.0)
    low, high = ratings["rules"]["interval"]
    assert low < ratings["rules"]["rating"] < high
    printed = CliRunner().invoke(kinesic, ["study", "analyse", str(file)]).stdout
    assert "speech of the motion found" in printed
    assert "rating of systems" in printed


@pytest.mark.parametrize(
    ("task", "condition", "options", "why"),
    [
        ("mismatching", "rules", "own|own", "must be two texts, own among them"),
        ("mismatching", "rules", "a|b", "must be two texts, own among them"),
        ("mismatching", "", "own|other", "no condition"),
        ("realism", "", "own", "must be two systems"),
    ],
)
def test_invalid_answers_of_a_speech_study_are_refused(tmp_path: Path, task, condition, options, why: str):
    file = tmp_path / "answers.csv"
    file.write_text(f"{','.join(ANSWER_COLUMNS)}\np,1,{task},own,{condition},{options},own,1\n")
    with pytest.raises(ConfigError, match=why):
        read_gesture_answers([file])
