"""Answers with a known effect in them, and what is found."""

import csv
import json
from math import isnan
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from kinesic.cli.verbs import study
from kinesic.studies.perception.answers import (
    ALL,
    COLUMNS,
    LABELS,
    People,
    Rating,
    compare_sides,
    first_choices,
    participants,
    read_answers,
)
from kinesic.studies.perception.design import stimuli

PEOPLE = 60
SHOWN = stimuli()
REGIONS = {each.action.name: each.action.region for each in SHOWN}


def made(path: Path, *, strong: float, wrinkled: float, seed: int = 0) -> Path:
    """Answers of people who see strong faces better by some points, and a frown better when it has wrinkles."""
    rng = np.random.default_rng(seed)

    def points(mean: float) -> int:
        return int(np.clip(np.round(rng.normal(mean, 1.0)), 1, 5))

    with path.open("w", newline="") as lines:
        rows = csv.DictWriter(lines, COLUMNS, restval="")
        rows.writeheader()
        for person in range(PEOPLE):
            for place, k in enumerate(rng.choice(128, 32, replace=False)):
                shown = SHOWN[k]
                better = strong * (shown.strength == "high") + wrinkled * (shown.wrinkles and shown.action.name == "4")
                labels = [a for a in LABELS if REGIONS[a] == shown.action.region]
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
    return made(tmp_path_factory.mktemp("answers") / "all.csv", strong=1.2, wrinkled=1.0)


@pytest.fixture(scope="module")
def answers(file: Path) -> tuple[Rating, ...]:
    return read_answers([file])


def test_an_effect_that_is_there_is_found(answers: tuple[Rating, ...]):
    found = compare_sides(answers, "strength", ("high", "low"))
    for action in (*LABELS, ALL):
        cell = found.cells[action, "EXP"]
        assert cell.significant
        assert cell.means[0] > cell.means[1] + 0.5


def test_the_global_test_is_over_all_actions(answers: tuple[Rating, ...]):
    """What is too faint to be found for one action alone is found for all of them together."""
    found = compare_sides(answers, "strength", ("high", "low")).cells
    assert found[ALL, "NAT"].counts == tuple(sum(found[a, "NAT"].counts[side] for a in LABELS) for side in (0, 1))
    assert found[ALL, "EXP"].p < min(found[a, "EXP"].p for a in LABELS)
    assert not found[ALL, "NAT"].significant


def test_participants_are_counted_once_and_need_not_tell_their_age():
    conditions = {"strength": "high", "wrinkles": "with", "presentation": "image"}
    opinions = {"naturalness": 3, "realism": 3}
    told = [Rating("4", conditions, {"4": 4}, opinions, name, age) for name, age in (("a", 51), ("b", None), ("a", 51))]
    assert participants(told) == People(2, (51,))


def test_an_effect_that_is_not_there_is_mostly_not_found(answers: tuple[Rating, ...]):
    found = compare_sides(answers, "presentation", ("animation", "image"))
    assert sum(cell.significant for cell in found.cells.values()) <= 4  # of 18, by chance 1


def test_wrinkles_help_the_frown_alone(answers: tuple[Rating, ...]):
    shares = first_choices(answers).shares
    assert shares["4", "with"] > shares["4", "without"] + 0.15
    found = compare_sides(answers, "wrinkles", ("with", "without"))
    assert found.cells["4", "EXP"].significant


def test_p_is_that_of_the_test_by_hand():
    """All of one side above all of the other: U = 0; exact p of 5 against 5 is 2 / C(10, 5)."""
    conditions = {"wrinkles": "with", "presentation": "image"}
    answers = [
        Rating(
            "4", conditions | {"strength": side}, {"4": points, "1+2": 1, "1+4": 1}, {"naturalness": 1, "realism": 1}
        )
        for side, points in [*(("high", 5),) * 5, *(("low", 1),) * 5]
    ]
    cell = compare_sides(answers, "strength", ("high", "low")).cells["4", "EXP"]
    assert cell.means == (5.0, 1.0)
    assert cell.counts == (5, 5)
    assert cell.p < 0.01
    assert isnan(compare_sides(answers, "strength", ("high", "low")).cells["6", "EXP"].p)


def test_a_tie_is_no_first_choice():
    conditions = {"strength": "high", "wrinkles": "with", "presentation": "image"}
    opinions = {"naturalness": 3, "realism": 3}
    assert not Rating("4", conditions, {"4": 4, "1+2": 4, "1+4": 1}, opinions).first_choice
    assert Rating("4", conditions, {"4": 4, "1+2": 3, "1+4": 1}, opinions).first_choice


def test_the_command_prints_the_tables_of_the_thesis(file: Path):
    told = CliRunner().invoke(study, ["analyse", str(file)], standalone_mode=False)
    assert told.exception is None
    said = (
        *("effect of intensity", "effect of presentation", "first choice", "NAT", "p < 0.05", "< 0.001"),
        "answers of 60 participants (age 19-51, median 34, told by 59)",
    )
    for words in said:
        assert words in told.output
    assert sum(line.split()[0] == ALL for line in told.output.splitlines() if line.strip()) == 3
    told = CliRunner().invoke(study, ["analyse", str(file), "--json"], standalone_mode=False)
    data = json.loads(told.output)
    assert {row["action"] for row in data["intensity"]} == {*LABELS, ALL}
    assert data["participants"] == 60
    assert len(data["ages"]) == 59
    assert all(row["p"] < 0.05 for row in data["intensity"] if row["measure"] == "EXP")
