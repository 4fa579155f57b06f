"""What the answers say, in the form of the thesis's Tables 4.3 to 4.5.

Likert scales are not normally distributed; two conditions are compared by the Mann-Whitney test (thesis 4.5).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean

from kinesic.studies.perception.answers import LABELS, Rating

SIGNIFICANT = 0.05
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
    """The effect of one condition (Table 4.3: strength; 4.4: presentation)."""

    condition: str
    sides: tuple[str, str]
    cells: Mapping[tuple[str, str], ComparedMeans]  # (action, measure)


@dataclass(frozen=True)
class Choices:
    """How often the true label was the first choice (Table 4.5)."""

    shares: Mapping[tuple[str, str], float]  # (action, "with" or "without" wrinkles) -> 0..1; NaN without answers
    counts: Mapping[tuple[str, str], int]


def compare_sides(answers: Sequence[Rating], condition: str, sides: tuple[str, str]) -> Comparison:
    """Compares two sides of a condition, for each action and measure.

    Args:
        answers: of all participants.
        condition: strength, wrinkles or presentation.
        sides: its two values.
    """
    cells = {
        (action, name): _cell(
            *([measure(a) for a in answers if a.action == action and a.conditions[condition] == side] for side in sides)
        )
        for action in LABELS
        for name, measure in MEASURES.items()
    }
    return Comparison(condition, sides, cells)


def first_choices(answers: Sequence[Rating]) -> Choices:
    """Shares of answers in which the true label got more than every other one, with and without wrinkles."""
    groups = {
        (action, side): [a.first_choice for a in answers if a.action == action and a.conditions["wrinkles"] == side]
        for action in LABELS
        for side in ("with", "without")
    }
    return Choices(
        {key: fmean(group) if group else float("nan") for key, group in groups.items()},
        {key: len(group) for key, group in groups.items()},
    )


def _cell(one: Sequence[int], other: Sequence[int]) -> ComparedMeans:
    from scipy.stats import mannwhitneyu  # noqa: PLC0415 - slow to import, and only answers need it

    means = (fmean(one) if one else float("nan"), fmean(other) if other else float("nan"))
    p = float(mannwhitneyu(one, other, alternative="two-sided").pvalue) if one and other else float("nan")
    return ComparedMeans(means, (len(one), len(other)), p)
