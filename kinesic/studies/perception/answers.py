"""Answers of participants, one row of CSV per face, and what they say in the form of the thesis's Tables 4.3-4.5.

Likert scales are not normally distributed; two conditions are compared by the Mann-Whitney test (thesis 4.5).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import Literal, get_args

from kinesic.body.config import ConfigError
from kinesic.studies.perception.design import ACTIONS, POINTS, Presentation, Strength
from kinesic.studies.questionnaire.answers import read_rows

Wrinkles = Literal["with", "without"]

OPINIONS = ("naturalness", "realism")
LABELS = tuple(action.name for action in ACTIONS)
CONDITIONS: Mapping[str, tuple[str, ...]] = {
    "strength": get_args(Strength),
    "wrinkles": get_args(Wrinkles),
    "presentation": get_args(Presentation),
}
COLUMNS = (
    *("participant", "place", "stimulus", "agent", "action", "region", *CONDITIONS),
    *LABELS,
    *OPINIONS,
    "seconds",
    "age",
)
SIGNIFICANT = 0.05  # share of chance below which two conditions differ
NEEDED_COLUMNS = ("participant", "action", *CONDITIONS, *LABELS, *OPINIONS)
AGES = range(10, 120)  # [years] that are believed
ALL = "all"  # the row of all actions together


@dataclass(frozen=True)
class Rating:
    """What one participant said of one face."""

    action: str
    conditions: Mapping[str, str]  # strength, wrinkles, presentation
    labels: Mapping[str, int]  # action asked for -> 1..5
    opinions: Mapping[str, int]  # naturalness, realism -> 1..5
    participant: str = ""
    age: int | None = None  # [years] of the participant, who need not tell it

    @property
    def first_choice(self) -> bool:
        """Whether the true label got more than every other one (thesis 4.5)."""
        others = (points for name, points in self.labels.items() if name != self.action)
        return self.labels[self.action] > max(others, default=0)


def read_answers(paths: Sequence[Path]) -> tuple[Rating, ...]:
    """Reads the answers of all participants, but for those about distractor faces.

    Raises:
        ConfigError: a file or a column is missing, or a value is out of its range.
    """
    rows = read_rows(paths, NEEDED_COLUMNS)
    found = tuple(_answer(where, row) for where, row in rows if row["action"] in LABELS)
    if not found:
        raise ConfigError(f"{', '.join(map(str, paths))}: no answer for any of {', '.join(LABELS)}")
    return found


MEASURES: Mapping[str, Callable[[Rating], int]] = {
    "EXP": lambda answer: answer.labels[answer.action],  # the expression was seen
    "NAT": lambda answer: answer.opinions["naturalness"],
    "RE": lambda answer: answer.opinions["realism"],
}


@dataclass(frozen=True)
class ComparedMeans:
    """One measure of one action under two conditions."""

    means: tuple[float, float]  # 1..5; NaN without answers
    counts: tuple[int, int]
    p: float  # that both are one distribution, two-sided; NaN where one side has no answers

    @property
    def significant(self) -> bool:
        """Whether the conditions differ."""
        return self.p < SIGNIFICANT


@dataclass(frozen=True)
class Comparison:
    """The effect of one condition (Table 4.3: strength; 4.4: presentation), for each action and for `ALL` together."""

    condition: str
    sides: tuple[str, str]
    cells: Mapping[tuple[str, str], ComparedMeans]  # (action, measure)


@dataclass(frozen=True)
class FirstChoices:
    """How often the true label was the first choice (Table 4.5)."""

    shares: Mapping[tuple[str, str], float]  # (action, "with" or "without" wrinkles) -> 0..1; NaN without answers
    counts: Mapping[tuple[str, str], int]


def compare_sides(answers: Sequence[Rating], condition: str, sides: tuple[str, str]) -> Comparison:
    """Compares two sides of a condition, for each action and measure, and for all actions together (thesis 4.5).

    Args:
        answers: of all participants.
        condition: strength, wrinkles or presentation.
        sides: its two values.
    """
    groups = {action: [a for a in answers if a.action == action] for action in LABELS} | {ALL: answers}
    cells = {
        (action, name): _cell(*([measure(a) for a in own if a.conditions[condition] == side] for side in sides))
        for action, own in groups.items()
        for name, measure in MEASURES.items()
    }
    return Comparison(condition, sides, cells)


@dataclass(frozen=True)
class People:
    """The participants of a study, by number and age."""

    count: int
    ages: tuple[int, ...]  # [years] of those who told it, in rising order


def participants(answers: Sequence[Rating]) -> People:
    """Counts who answered, and how old they are."""
    ages = {answer.participant: answer.age for answer in answers}
    return People(len(ages), tuple(sorted(age for age in ages.values() if age is not None)))


def first_choices(answers: Sequence[Rating]) -> FirstChoices:
    """Counts the share of answers in which the true label got more than every other, with and without wrinkles."""
    groups = {
        (action, side): [a.first_choice for a in answers if a.action == action and a.conditions["wrinkles"] == side]
        for action in LABELS
        for side in ("with", "without")
    }
    return FirstChoices(
        {key: fmean(group) if group else float("nan") for key, group in groups.items()},
        {key: len(group) for key, group in groups.items()},
    )


def _cell(left: Sequence[int], right: Sequence[int]) -> ComparedMeans:
    from scipy.stats import mannwhitneyu  # noqa: PLC0415 - slow to import, and only answers need it

    means = (fmean(left) if left else float("nan"), fmean(right) if right else float("nan"))
    p = float(mannwhitneyu(left, right, alternative="two-sided").pvalue) if left and right else float("nan")
    return ComparedMeans(means, (len(left), len(right)), p)


def _answer(where: str, row: Mapping[str, str]) -> Rating:
    conditions = {name: row[name] for name in CONDITIONS}
    for name, value in conditions.items():
        if value not in CONDITIONS[name]:
            raise ConfigError(f"{where}: {name} is {value!r}, must be one of {', '.join(CONDITIONS[name])}")
    labels = {name: _points(where, name, row[name]) for name in LABELS if row[name]}
    if row["action"] not in labels:
        raise ConfigError(f"{where}: no answer in column {row['action']}, which is what was shown")
    opinions = {name: _points(where, name, row[name]) for name in OPINIONS}
    told = row.get("age", "")
    age = _whole(where, "age", told, AGES) if told else None
    return Rating(row["action"], conditions, labels, opinions, row["participant"], age)


def _points(where: str, name: str, text: str) -> int:
    return _whole(where, name, text, range(1, POINTS + 1))


def _whole(where: str, name: str, text: str, among: range) -> int:
    if not (text.isascii() and text.isdecimal() and len(text) < 4 and int(text) in among):
        raise ConfigError(f"{where}: {name} is {text!r}, must be a whole number from {among[0]} to {among[-1]}")
    return int(text)
