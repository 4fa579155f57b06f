"""Analysis of simulated participants, compared with formulas."""

import json
from math import comb, sqrt
from pathlib import Path

import pytest
from click.testing import CliRunner

from kinesic.cli import kinesic
from kinesic.studies.gesture_perception.analysis import (
    analyse_preference,
    analyse_recognition,
    compare_with_chance,
    confusion_matrix,
    find_position_choosers,
)
from kinesic.studies.gesture_perception.answers import Answers, Recognition, read_gesture_answers

from .participants import CONDITIONS, GESTURES, PAIRS, always_right, first_place, guess, write_answers

NORMAL_QUANTILE = 1.959963984540054  # 97.5 % quantile of the normal distribution


def read(tmp_path: Path, *people) -> Answers:
    return read_gesture_answers([write_answers(tmp_path / "answers.csv", people)])


def binomial_probabilities(total: int, chance: float) -> list[float]:
    """Return the binomial probabilities of 0, 1, 2, ... hits."""
    return [comb(total, k) * chance**k * (1 - chance) ** (total - k) for k in range(total + 1)]


@pytest.mark.parametrize(("hits", "total"), [(0, 10), (3, 10), (10, 10), (1, 1), (17, 96), (700, 960)])
def test_confidence_interval_of_recognition_is_the_wilson_interval(hits: int, total: int):
    """Check the interval's ends by the normal quantile of the observed fraction."""
    low, high = compare_with_chance(hits, total, 1 / 6).interval
    rate, n = hits / total, total
    middle = (rate + NORMAL_QUANTILE**2 / (2 * n)) / (1 + NORMAL_QUANTILE**2 / n)
    half = (
        NORMAL_QUANTILE * sqrt(rate * (1 - rate) / n + NORMAL_QUANTILE**2 / (4 * n**2)) / (1 + NORMAL_QUANTILE**2 / n)
    )
    assert (low, high) == pytest.approx((middle - half, middle + half), abs=1e-9)
    for end in (low, high):
        assert (rate - end) ** 2 == pytest.approx(NORMAL_QUANTILE**2 * end * (1 - end) / n, abs=1e-9)


@pytest.mark.parametrize(("hits", "total", "chance"), [(4, 24, 1 / 6), (12, 24, 1 / 6), (0, 5, 0.5), (9, 12, 0.5)])
def test_p_value_of_recognition_equals_that_of_the_exact_binomial_test(hits: int, total: int, chance: float):
    likely = binomial_probabilities(total, chance)
    above = compare_with_chance(hits, total, chance, "greater").p
    assert above == pytest.approx(sum(likely[hits:]), rel=1e-9, abs=0)
    as_far = sum(item for item in likely if item <= likely[hits] * (1 + 1e-7))
    assert compare_with_chance(hits, total, chance).p == pytest.approx(as_far, rel=1e-9, abs=0)


def test_recognition_rate_of_perfect_participants_is_one(tmp_path: Path):
    answers = read(tmp_path, *[always_right] * 4)
    result = analyse_recognition(answers.recognitions)
    assert result is not None
    assert result.overall.rate == 1.0
    assert result.overall.total == 4 * len(GESTURES)
    assert {share.rate for share in result.gestures.values()} == {1.0}
    assert result.confusions == ()
    preferred = analyse_preference(answers.preferences)
    assert preferred is not None
    assert list(preferred.conditions) == list(CONDITIONS)
    assert {(share.hits, share.total) for share in preferred.conditions.values()} == {(4 * PAIRS, 4 * PAIRS)}
    assert all(share.p < 1e-6 for share in preferred.conditions.values())
    assert preferred.first.rate == 0.5
    assert find_position_choosers(answers) == {}, "right answers are balanced over positions"


def test_recognition_rate_of_guessing_participants_is_one_sixth(tmp_path: Path):
    answers = read(tmp_path, *[guess] * 40)
    result, preferred = analyse_recognition(answers.recognitions), analyse_preference(answers.preferences)
    assert result is not None
    assert preferred is not None
    low, high = result.overall.interval
    assert low < 1 / 6 < high
    assert high - low < 0.06
    assert result.overall.p > 0.01
    outside = sum(not share.interval[0] < 1 / 6 < share.interval[1] for share in result.gestures.values())
    assert outside <= 5  # of 24, by chance one
    assert all(share.interval[0] < 0.5 < share.interval[1] for share in preferred.conditions.values())
    assert find_position_choosers(answers) == {}


def test_participant_who_always_chooses_the_first_option_is_detected(tmp_path: Path):
    answers = read(tmp_path, always_right, first_place, guess)
    position_choosers = find_position_choosers(answers)
    assert set(position_choosers) == {"first_place-1"}
    habit = position_choosers["first_place-1"]
    assert (habit.place, habit.frequency.hits, habit.frequency.total) == (1, 24, 24)
    assert habit.frequency.p == pytest.approx(6 / 6**24, rel=1e-9, abs=0)
    result = analyse_recognition(answers.recognitions)
    assert result is not None
    own = result.participants["first_place-1"]
    assert own.rate == pytest.approx(1 / 6)
    assert own.p == pytest.approx(sum(binomial_probabilities(24, 1 / 6)[4:]), rel=1e-9, abs=0), (
        "as many or more by guessing"
    )


def test_preference_of_all_participants_for_the_first_stimulus_is_detected(tmp_path: Path):
    preferred = analyse_preference(read(tmp_path, *[first_place] * 5).preferences)
    assert preferred is not None
    assert preferred.first.rate == 1.0
    assert preferred.first.p < 1e-9
    assert {share.rate for share in preferred.conditions.values()} == {0.5}, "balanced, so that no condition gains"


def test_confusions_report_how_often_a_wrong_option_was_chosen_and_offered():
    options = ("a", "b", "c", "d", "e", "f")
    answers = [Recognition("p", "a", options, chosen) for chosen in ("a", "b", "b", "c")]
    answers += [Recognition("p", "a", ("a", "g", "c", "d", "e", "f"), "a"), Recognition("p", "b", options, "a")]
    result = analyse_recognition(answers)
    assert result is not None
    results = [
        (confusion.shown, confusion.chosen, confusion.count, confusion.offered) for confusion in result.confusions
    ]
    assert results == [("a", "b", 2, 4), ("a", "c", 1, 5), ("b", "a", 1, 1)]
    assert list(result.gestures) == ["b", "a"]
    names, counts = confusion_matrix(answers)
    assert names == ("a", "b", "c")
    assert counts == ((2, 2, 1), (1, 0, 0), (0, 0, 0))


def test_gesture_study_without_answers_has_no_result():
    assert analyse_recognition(()) is None
    assert analyse_preference(()) is None


def test_analyse_command_prints_gesture_tables_and_json(tmp_path: Path):
    file = write_answers(tmp_path / "answers.csv", [always_right, guess, first_place])
    file.write_text(file.read_text().replace("first_place-2", "[red]x\x1b[2J"))
    outcome = CliRunner().invoke(kinesic, ["study", "analyse", str(file)], standalone_mode=False)
    assert outcome.exception is None
    quoted = "[red]x\\x1b[2J chose position 1"
    for words in ("recognised: ", "confused with", "whole_body=0", "the first of two", quoted):
        assert words in outcome.output
    outcome = CliRunner().invoke(kinesic, ["study", "analyse", str(file), "--json"], standalone_mode=False)
    data = json.loads(outcome.output)
    assert data["answers"] == 3 * (len(GESTURES) + 2 * PAIRS)
    assert len(data["recognition"]["confusion"]["counts"]) == len(GESTURES)
    overall = data["recognition"]["overall"]
    assert overall["share"] == overall["hits"] / overall["answers"]
    assert set(data["preference"]["conditions"]) == set(CONDITIONS)
    assert list(data["choose_by_place"]) == ["[red]x\x1b[2J"]


def test_answers_of_different_studies_together_are_refused(tmp_path: Path):
    gestures, faces = write_answers(tmp_path / "gestures.csv", [guess]), tmp_path / "faces.csv"
    faces.write_text("participant,place,action\np,1,4\n")
    for files in ([gestures, faces], [faces, gestures]):
        outcome = CliRunner().invoke(kinesic, ["study", "analyse", *map(str, files)], standalone_mode=False)
        assert "no column" in str(outcome.exception)
