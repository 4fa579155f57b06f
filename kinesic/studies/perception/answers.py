"""Reader and analysis of answers to face studies (thesis Tables 4.3-4.5).

An answer is one CSV row per face. Likert scales are not normally distributed, so two conditions are compared by the
Mann-Whitney test (thesis 4.5). It takes answers as independent; a second test compares the means of each participant.
"""

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import Literal, get_args

from kinesic.body.config import ConfigError
from kinesic.studies.perception.design import FACIAL_ACTIONS, LIKERT_POINTS, Presentation, Strength
from kinesic.studies.perception.significance import (
    SIGNIFICANCE_LEVEL,
    PairedTest,
    adjust_holm,
    compare_groups,
    compare_pairs,
)
from kinesic.studies.questionnaire.answers import read_rows

Wrinkles = Literal["with", "without"]

OPINION_COLUMNS = ("naturalness", "realism")  # columns of the answer file with the rated statements
ACTION_NAMES = tuple(action.name for action in FACIAL_ACTIONS)
CONDITION_VALUES: Mapping[str, tuple[str, ...]] = {
    "strength": get_args(Strength),
    "wrinkles": get_args(Wrinkles),
    "presentation": get_args(Presentation),
}
ANSWER_COLUMNS = (
    *("participant", "place", "stimulus", "agent", "action", "region", *CONDITION_VALUES),
    *ACTION_NAMES,
    *OPINION_COLUMNS,
    "seconds",
    "age",
)
REQUIRED_COLUMNS = ("participant", "action", *CONDITION_VALUES, *ACTION_NAMES, *OPINION_COLUMNS)
ACCEPTED_AGES = range(10, 120)  # [years] accepted ages
ALL_ACTIONS = "all"  # name of the row for all actions together


@dataclass(frozen=True)
class FaceRating:
    """Ratings of one face by one participant, on Likert scales."""

    action: str
    conditions: Mapping[str, str]  # strength, wrinkles, presentation
    labels: Mapping[str, int]  # action -> 1..5
    opinions: Mapping[str, int]  # naturalness, realism -> 1..5
    participant: str = ""
    age: int | None = None  # [years] of the participant, optional

    @property
    def first_choice(self) -> bool:
        """Whether the true label alone got the most points (thesis 4.5)."""
        others = (points for name, points in self.labels.items() if name != self.action)
        return self.labels[self.action] > max(others, default=0)


def read_answers(paths: Sequence[Path]) -> tuple[FaceRating, ...]:
    """Read the answers of all participants, except those about distractor faces.

    Raises:
        ConfigError: a file or column is missing, or a value is out of range.
    """
    rows = read_rows(paths, REQUIRED_COLUMNS)
    answers = tuple(_answer(location, row) for location, row in rows if row["action"] in ACTION_NAMES)
    if not answers:
        raise ConfigError(f"{', '.join(map(str, paths))}: no answer for any of {', '.join(ACTION_NAMES)}")
    return answers


# Measure as named in the thesis -> points (1 to 5) of an answer.
RATING_MEASURES: Mapping[str, Callable[[FaceRating], int]] = {
    "EXP": lambda answer: answer.labels[answer.action],  # recognition of the expression
    "NAT": lambda answer: answer.opinions["naturalness"],
    "RE": lambda answer: answer.opinions["realism"],
}
Cell = tuple[str, str]  # action or `ALL_ACTIONS`, measure


@dataclass(frozen=True)
class ComparedMeans:
    """Means of one measure and action under two conditions."""

    means: tuple[float, float]  # 1..5; NaN without answers
    counts: tuple[int, int]
    p: float  # two-sided p-value of equal distributions; NaN if one side has no answers
    corrected_p: float  # `p` after Holm's correction
    delta: float  # Cliff's delta, -1..1; positive if the first side has more points
    paired: PairedTest  # differences within participants
    corrected_paired_p: float  # p-value of `paired` after Holm's correction

    @property
    def significant(self) -> bool:
        """Whether the conditions differ significantly, after the correction."""
        return self.corrected_p < SIGNIFICANCE_LEVEL


@dataclass(frozen=True)
class Comparison:
    """Effect of one study condition, by action and for all actions.

    Thesis Table 4.3 shows strength, Table 4.4 presentation.
    """

    condition: str
    sides: tuple[str, str]
    cells: Mapping[Cell, ComparedMeans]


@dataclass(frozen=True)
class FirstChoices:
    """Fraction of answers whose first choice is correct (thesis Table 4.5)."""

    shares: Mapping[tuple[str, str], float]  # (action, "with" or "without" wrinkles) -> 0..1; NaN without answers
    counts: Mapping[tuple[str, str], int]


def compare_sides(answers: Sequence[FaceRating], condition: str, sides: tuple[str, str]) -> Comparison:
    """Compare mean ratings under two values of a study condition, by action.

    Args:
        answers: answers of all participants.
        condition: strength, wrinkles or presentation.
        sides: two values of the condition.
    """
    groups = {action: [a for a in answers if a.action == action] for action in ACTION_NAMES} | {ALL_ACTIONS: answers}
    points = {
        (action, name): tuple(_collect_points(group, condition, side, measure) for side in sides)
        for action, group in groups.items()
        for name, measure in RATING_MEASURES.items()
    }
    tests = {cell: compare_groups(*map(_flatten, pair)) for cell, pair in points.items()}
    differences = {(action, name): _subtract_means(*points[action, name]) for action, name in points}
    for name in RATING_MEASURES:
        differences[ALL_ACTIONS, name] = _average([differences[action, name] for action in ACTION_NAMES])
    paired = {cell: compare_pairs(list(by_person.values())) for cell, by_person in differences.items()}
    corrected = _correct({cell: test.p for cell, test in tests.items()})
    corrected_paired = _correct({cell: test.p for cell, test in paired.items()})
    cells = {
        cell: ComparedMeans(
            (_mean(left), _mean(right)),
            (len(_flatten(left)), len(_flatten(right))),
            tests[cell].p,
            corrected[cell],
            tests[cell].delta,
            paired[cell],
            corrected_paired[cell],
        )
        for cell, (left, right) in points.items()
    }
    return Comparison(condition, sides, cells)


@dataclass(frozen=True)
class People:
    """Number and ages of a study's participants."""

    count: int
    ages: tuple[int, ...]  # [years] in ascending order, where given


def count_participants(answers: Sequence[FaceRating]) -> People:
    """Count the participants and list their ages."""
    ages = {answer.participant: answer.age for answer in answers}
    return People(len(ages), tuple(sorted(age for age in ages.values() if age is not None)))


def count_first_choices(answers: Sequence[FaceRating]) -> FirstChoices:
    """Return the fraction of correct first choices, by action and wrinkles."""
    groups = {
        (action, side): [a.first_choice for a in answers if a.action == action and a.conditions["wrinkles"] == side]
        for action in ACTION_NAMES
        for side in ("with", "without")
    }
    return FirstChoices(
        {key: fmean(group) if group else float("nan") for key, group in groups.items()},
        {key: len(group) for key, group in groups.items()},
    )


Points = Mapping[str, Sequence[int]]  # participant -> rating points of all answers


def _collect_points(
    answers: Sequence[FaceRating], condition: str, side: str, measure: Callable[[FaceRating], int]
) -> dict[str, list[int]]:
    """Return the rating points of answers with one condition value, by participant."""
    points: dict[str, list[int]] = defaultdict(list)
    for answer in answers:
        if answer.conditions[condition] == side:
            points[answer.participant].append(measure(answer))
    return points


def _flatten(points: Points) -> list[int]:
    return [value for values in points.values() for value in values]


def _mean(points: Points) -> float:
    return fmean(_flatten(points)) if points else float("nan")


def _subtract_means(left: Points, right: Points) -> dict[str, float]:
    """Return each participant's difference of means between both compared conditions."""
    return {person: fmean(values) - fmean(right[person]) for person, values in left.items() if person in right}


def _average(differences: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Return each participant's mean difference over the actions."""
    people = dict.fromkeys(person for by_person in differences for person in by_person)
    return {person: fmean(each[person] for each in differences if person in each) for person in people}


def _correct(p_values: Mapping[Cell, float]) -> dict[Cell, float]:
    """Holm-correct p-values, separately for single actions and for all actions together."""
    single = {cell: p for cell, p in p_values.items() if cell[0] != ALL_ACTIONS}
    return adjust_holm(single) | adjust_holm({cell: p for cell, p in p_values.items() if cell[0] == ALL_ACTIONS})


def _answer(location: str, row: Mapping[str, str]) -> FaceRating:
    conditions = {name: row[name] for name in CONDITION_VALUES}
    for name, value in conditions.items():
        if value not in CONDITION_VALUES[name]:
            raise ConfigError(f"{location}: {name} is {value!r}, must be one of {', '.join(CONDITION_VALUES[name])}")
    labels = {name: _points(location, name, row[name]) for name in ACTION_NAMES if row[name]}
    if row["action"] not in labels:
        raise ConfigError(f"{location}: no answer in column {row['action']}, which is the shown action")
    opinions = {name: _points(location, name, row[name]) for name in OPINION_COLUMNS}
    age_text = row.get("age", "")
    age = _whole(location, "age", age_text, ACCEPTED_AGES) if age_text else None
    return FaceRating(row["action"], conditions, labels, opinions, row["participant"], age)


def _points(location: str, name: str, text: str) -> int:
    return _whole(location, name, text, range(1, LIKERT_POINTS + 1))


def _whole(location: str, name: str, text: str, allowed: range) -> int:
    if not (text.isascii() and text.isdecimal() and len(text) < 4 and int(text) in allowed):
        raise ConfigError(f"{location}: {name} is {text!r}, must be a whole number from {allowed[0]} to {allowed[-1]}")
    return int(text)
