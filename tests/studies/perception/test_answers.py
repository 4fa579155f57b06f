"""Analysis of simulated answers with a known effect."""

import csv
import json
from math import isnan
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from kinesic.cli import kinesic
from kinesic.studies.perception.answers import (
    ACTION_NAMES,
    ALL_ACTIONS,
    ANSWER_COLUMNS,
    FaceRating,
    People,
    compare_sides,
    count_first_choices,
    count_participants,
    read_answers,
)
from kinesic.studies.perception.design import list_stimuli

PARTICIPANT_COUNT = 60
ALL_STIMULI = list_stimuli()
REGIONS = {item.action.name: item.action.region for item in ALL_STIMULI}


def simulate_answers(path: Path, *, strong: float, wrinkled: float, seed: int = 0) -> Path:
    """Write simulated answers that prefer strong faces and wrinkled frowns."""
    rng = np.random.default_rng(seed)

    def points(mean: float) -> int:
        return int(np.clip(np.round(rng.normal(mean, 1.0)), 1, 5))

    with path.open("w", newline="") as lines:
        rows = csv.DictWriter(lines, ANSWER_COLUMNS, restval="")
        rows.writeheader()
        for person in range(PARTICIPANT_COUNT):
            for place, k in enumerate(rng.choice(128, 32, replace=False)):
                shown = ALL_STIMULI[k]
                better = strong * (shown.strength == "high") + wrinkled * (shown.wrinkles and shown.action.name == "4")
                labels = [a for a in ACTION_NAMES if REGIONS[a] == shown.action.region]
                rows.writerow(
                    {
                        "participant": person,
                        "place": place + 1,
                        "stimulus": shown.id,
                        "agent": shown.agent,
                        "action": shown.action.name,
                        "region": shown.action.region,
                        "strength": shown.strength,
                        "wrinkles": "with" if shown.wrinkles else "without",
                        "presentation": shown.presentation,
                        **{name: points(2.7 + better * (name == shown.action.name)) for name in labels},
                        "naturalness": points(3.0),
                        "realism": points(3.0),
                        "seconds": "1.0",
                        "age": 19 + person % 33 if person else "",
                    }
                )
    return path


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return simulate_answers(tmp_path_factory.mktemp("answers") / "all.csv", strong=1.2, wrinkled=1.0)


@pytest.fixture(scope="module")
def answers(file: Path) -> tuple[FaceRating, ...]:
    return read_answers([file])


def test_simulated_study_effect_is_significant(answers: tuple[FaceRating, ...]):
    comparison = compare_sides(answers, "strength", ("high", "low"))
    for action in (*ACTION_NAMES, ALL_ACTIONS):
        cell = comparison.cells[action, "EXP"]
        assert cell.significant
        assert cell.means[0] > cell.means[1] + 0.5


def test_overall_significance_test_pools_all_facial_actions(answers: tuple[FaceRating, ...]):
    """An effect too weak for one action is significant over all actions."""
    cells = compare_sides(answers, "strength", ("high", "low")).cells
    assert cells[ALL_ACTIONS, "NAT"].counts == tuple(
        sum(cells[a, "NAT"].counts[side] for a in ACTION_NAMES) for side in (0, 1)
    )
    assert cells[ALL_ACTIONS, "EXP"].p < min(cells[a, "EXP"].p for a in ACTION_NAMES)
    assert not cells[ALL_ACTIONS, "NAT"].significant


def test_each_participant_of_the_face_study_counts_once_and_age_is_optional():
    conditions = {"strength": "high", "wrinkles": "with", "presentation": "image"}
    opinions = {"naturalness": 3, "realism": 3}
    results = [
        FaceRating("4", conditions, {"4": 4}, opinions, name, age) for name, age in (("a", 51), ("b", None), ("a", 51))
    ]
    assert count_participants(results) == People(2, (51,))


def test_study_conditions_without_a_true_effect_rarely_differ_significantly(answers: tuple[FaceRating, ...]):
    comparison = compare_sides(answers, "presentation", ("animation", "image"))
    assert sum(cell.significant for cell in comparison.cells.values()) <= 4  # of 18, by chance 1


def test_analysis_finds_the_simulated_effect_of_wrinkles_on_the_frown(answers: tuple[FaceRating, ...]):
    shares = count_first_choices(answers).shares
    assert shares["4", "with"] > shares["4", "without"] + 0.15
    comparison = compare_sides(answers, "wrinkles", ("with", "without"))
    assert comparison.cells["4", "EXP"].significant


def test_fully_separated_ratings_are_significant():
    """Compare two groups of five ratings without overlap."""
    conditions = {"wrinkles": "with", "presentation": "image"}
    answers = [
        FaceRating(
            "4", conditions | {"strength": side}, {"4": points, "1+2": 1, "1+4": 1}, {"naturalness": 1, "realism": 1}
        )
        for side, points in [*(("high", 5),) * 5, *(("low", 1),) * 5]
    ]
    cell = compare_sides(answers, "strength", ("high", "low")).cells["4", "EXP"]
    assert cell.means == (5.0, 1.0)
    assert cell.counts == (5, 5)
    assert cell.p < 0.01
    assert isnan(compare_sides(answers, "strength", ("high", "low")).cells["6", "EXP"].p)


def test_label_of_a_face_with_the_same_rating_as_another_label_is_not_the_first_choice():
    conditions = {"strength": "high", "wrinkles": "with", "presentation": "image"}
    opinions = {"naturalness": 3, "realism": 3}
    assert not FaceRating("4", conditions, {"4": 4, "1+2": 4, "1+4": 1}, opinions).first_choice
    assert FaceRating("4", conditions, {"4": 4, "1+2": 3, "1+4": 1}, opinions).first_choice


def test_analyse_command_prints_face_study_tables_of_the_thesis(file: Path):
    outcome = CliRunner().invoke(kinesic, ["study", "analyse", str(file)], standalone_mode=False)
    assert outcome.exception is None
    said = (
        *("effect of intensity", "effect of presentation", "first choice", "NAT", "p < 0.05", "< 0.001"),
        "answers of 60 participants (age 19-51, median 34, given by 59)",
    )
    for words in said:
        assert words in outcome.output
    assert sum(line.split()[0] == ALL_ACTIONS for line in outcome.output.splitlines() if line.strip()) == 6
    outcome = CliRunner().invoke(kinesic, ["study", "analyse", str(file), "--json"], standalone_mode=False)
    data = json.loads(outcome.output)
    assert {row["action"] for row in data["intensity"]} == {*ACTION_NAMES, ALL_ACTIONS}
    assert data["participants"] == 60
    assert len(data["ages"]) == 59
    strong = [row for row in data["intensity"] if row["measure"] == "EXP"]
    assert all(row["p"] <= row["p_holm"] < 0.05 for row in strong)
    assert all(row["delta"] > 0.3 and row["within"]["r"] > 0.3 for row in strong)
    assert all(row["within"]["p_holm"] < 0.05 for row in strong)


def rate_frown(person: str, strength: str, points: int) -> FaceRating:
    conditions = {"wrinkles": "with", "presentation": "image", "strength": strength}
    labels = {"4": points, "1+2": 1, "1+4": 1}
    return FaceRating("4", conditions, labels, {"naturalness": 3, "realism": 3}, person)


def test_paired_test_finds_differences_hidden_by_variation_between_people():
    """Simulate ten people with different levels and the same difference."""
    answers = [
        rate_frown(f"p{k}", strength, points)
        for k in range(10)
        for strength, points in (("high", 2 + k % 4), ("low", 1 + k % 4))
    ]
    cell = compare_sides(answers, "strength", ("high", "low")).cells["4", "EXP"]
    assert cell.paired.participants == 10
    assert cell.paired.difference == 1.0
    assert cell.paired.correlation == 1.0
    assert cell.paired.p < 0.005 < 0.05 < cell.p


def test_participant_without_both_conditions_is_excluded_from_the_paired_test():
    answers = [rate_frown("a", "high", 5), rate_frown("a", "low", 2), rate_frown("b", "high", 5)]
    cell = compare_sides(answers, "strength", ("high", "low")).cells["4", "EXP"]
    assert cell.paired.participants == 1
    assert cell.paired.difference == 3.0
    nowhere = compare_sides(answers, "strength", ("high", "low")).cells["6", "EXP"]
    assert nowhere.paired.participants == 0
    assert isnan(nowhere.corrected_paired_p)


def test_p_values_of_single_facial_actions_and_of_all_together_are_corrected_separately(
    answers: tuple[FaceRating, ...],
):
    cells = compare_sides(answers, "presentation", ("animation", "image")).cells
    for family in ([a for a in cells if a[0] != ALL_ACTIONS], [a for a in cells if a[0] == ALL_ACTIONS]):
        smallest = min(family, key=lambda cell: cells[cell].p)
        assert cells[smallest].corrected_p == pytest.approx(min(1.0, len(family) * cells[smallest].p))
