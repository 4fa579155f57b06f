"""Analysis of gesture studies: recognition rates, confusions and preferences.

Fractions have Wilson intervals, which keep their coverage for few answers and near 0 and 1, and exact binomial tests.
Both treat answers as independent; those of one participant are slightly correlated, so the true intervals are a little
wider.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeVar

from kinesic.studies.gesture_perception.answers import Answers, ParticipantAnswer, Preference, Recognition, SpeechMatch
from kinesic.studies.gesture_perception.design import OPTION_COUNT, STIMULUS_VERSIONS
from kinesic.studies.gesture_perception.power import find_detectable_rate

Tail = Literal["greater", "two-sided"]
AnyAnswer = TypeVar("AnyAnswer", bound=ParticipantAnswer)

CONFIDENCE_LEVEL = 0.95  # probability covered by the reported confidence intervals
MAX_HABIT_P = 0.001  # p-value below which a participant's preferred answer position is reported


@dataclass(frozen=True)
class Fraction:
    """Fraction of answers with confidence interval and p-value."""

    hits: int
    total: int
    interval: tuple[float, float]  # of the fraction, at `CONFIDENCE_LEVEL`
    p: float  # p-value of the deviation from chance

    @property
    def rate(self) -> float:
        """Fraction of answers, 0..1."""
        return self.hits / self.total


@dataclass(frozen=True)
class Confusion:
    """Number of times that participants took one gesture for another."""

    shown: str
    chosen: str
    count: int
    offered: int  # number of times that the chosen gesture was among the options


@dataclass(frozen=True)
class Habit:
    """Answer position that a participant chooses most often, with its frequency."""

    place: int  # preferred position, from 1
    frequency: Fraction  # of the answers; its p-value is for any position to be chosen as often by chance


@dataclass(frozen=True)
class RecognitionResult:
    """Recognition rates and confusions of a gesture study."""

    overall: Fraction
    gestures: Mapping[str, Fraction]  # least recognised first
    confusions: tuple[Confusion, ...]  # most frequent first, without correct answers
    participants: Mapping[str, Fraction]
    habits: Mapping[str, Habit]  # by participant


@dataclass(frozen=True)
class PreferenceResult:
    """Preferences between pairs of performances in a gesture study."""

    conditions: Mapping[str, Fraction]  # fraction of answers that prefer the standard to the changed setting
    first: Fraction  # fraction of answers that prefer the first interval
    habits: Mapping[str, Habit]  # by participant


def compare_with_chance(hits: int, total: int, chance: float, tail: Tail = "two-sided") -> Fraction:
    """Compare a fraction of answers with chance.

    Args:
        hits: number of answers of the kind.
        total: number of answers, at least 1.
        chance: fraction expected from guessing.
        tail: deviations that count.
    """
    from scipy.stats import binomtest  # noqa: PLC0415 - slow import, only needed for answers

    test = binomtest(hits, total, chance, alternative=tail)
    whole = binomtest(hits, total).proportion_ci(CONFIDENCE_LEVEL, method="wilson")
    return Fraction(hits, total, (float(whole.low), float(whole.high)), float(test.pvalue))


def analyse_recognition(answers: Sequence[Recognition]) -> RecognitionResult | None:
    """Compute recognition rates and confusions of each gesture.

    The result is None without answers.
    """
    if not answers:
        return None
    gestures = _by(answers, lambda answer: answer.stimulus)
    shares = {gesture: _recognised(group) for gesture, group in gestures.items()}
    return RecognitionResult(
        _recognised(answers),
        dict(sorted(shares.items(), key=lambda item: (item[1].rate, item[0]))),
        confusions(answers),
        {person: _recognised(group) for person, group in _by(answers, lambda answer: answer.participant).items()},
        habits(answers),
    )


def analyse_preference(answers: Sequence[Preference]) -> PreferenceResult | None:
    """Analyse the preferred performances of a gesture study.

    The result is None without answers.
    """
    if not answers:
        return None
    return PreferenceResult(
        {
            condition: compare_with_chance(
                sum(answer.chosen == STIMULUS_VERSIONS[0] for answer in group), len(group), 1 / len(STIMULUS_VERSIONS)
            )
            for condition, group in sorted(_by(answers, lambda answer: answer.condition).items())
        },
        compare_with_chance(sum(answer.place == 0 for answer in answers), len(answers), 1 / len(STIMULUS_VERSIONS)),
        habits(answers),
    )


@dataclass(frozen=True)
class MatchResult:
    """Fraction of answers that match a motion with its speech, by system."""

    systems: Mapping[str, Fraction]  # best matched first; chance is one half
    first: Fraction  # fraction of answers that choose the first speech
    detectable: Mapping[str, float]  # smallest rate that the answers of a system show with a power of 80 %


def analyse_matches(answers: Sequence[SpeechMatch]) -> MatchResult | None:
    """Analyse how often participants match a motion to its own speech.

    The result is None without answers.
    """
    if not answers:
        return None
    shares = {
        system: compare_with_chance(sum(answer.right for answer in group), len(group), 0.5)
        for system, group in _by(answers, lambda answer: answer.system).items()
    }
    return MatchResult(
        dict(sorted(shares.items(), key=lambda item: (-item[1].rate, item[0]))),
        compare_with_chance(sum(answer.place == 0 for answer in answers), len(answers), 0.5),
        {system: find_detectable_rate(frequency.total) for system, frequency in shares.items()},
    )


def confusions(answers: Iterable[Recognition]) -> tuple[Confusion, ...]:
    """Count how often participants mistook each gesture for another."""
    taken, offered = Counter[tuple[str, str]](), Counter[tuple[str, str]]()
    for answer in answers:
        offered.update((answer.stimulus, option) for option in answer.options if option != answer.stimulus)
        if not answer.right:
            taken[answer.stimulus, answer.chosen] += 1
    pairs = (Confusion(shown, chosen, count, offered[shown, chosen]) for (shown, chosen), count in taken.items())
    return tuple(sorted(pairs, key=lambda confusion: (-confusion.count, confusion.shown, confusion.chosen)))


def confusion_matrix(answers: Sequence[Recognition]) -> tuple[tuple[str, ...], tuple[tuple[int, ...], ...]]:
    """Return gesture names and confusion matrix, shown by row, chosen by column."""
    counts = Counter((answer.stimulus, answer.chosen) for answer in answers)
    names = tuple(sorted({name for pair in counts for name in pair}))
    return names, tuple(tuple(counts[shown, chosen] for chosen in names) for shown in names)


def habits(answers: Sequence[ParticipantAnswer]) -> dict[str, Habit]:
    """Find the answer position that each participant chooses most often.

    Correct answers are at all positions equally often.
    """
    return {person: _find_habit(group) for person, group in _by(answers, lambda answer: answer.participant).items()}


def find_position_choosers(answers: Answers) -> dict[str, Habit]:
    """Return participants whose choices depend on the position of the answers.

    Of the habits in several tasks the one with the smallest p-value is returned.
    """
    result: dict[str, Habit] = {}
    for group in map(habits, (answers.recognitions, answers.preferences, answers.matches, answers.realisms)):
        for person, habit in group.items():
            if habit.frequency.p < min(MAX_HABIT_P, result[person].frequency.p if person in result else MAX_HABIT_P):
                result[person] = habit
    return result


def _find_habit(answers: Sequence[ParticipantAnswer]) -> Habit:
    """Return the most chosen answer position, with its p-value.

    The p-value is corrected for the number of positions.
    """
    choices = len(answers[0].options)
    (place, hits), *_ = Counter(answer.place for answer in answers).most_common(1)
    frequency = compare_with_chance(hits, len(answers), 1 / choices, "greater")
    return Habit(
        place + 1, Fraction(frequency.hits, frequency.total, frequency.interval, min(1.0, choices * frequency.p))
    )


def _recognised(answers: Sequence[Recognition]) -> Fraction:
    return compare_with_chance(sum(answer.right for answer in answers), len(answers), 1 / OPTION_COUNT, "greater")


def _by(answers: Iterable[AnyAnswer], key: Callable[[AnyAnswer], str]) -> dict[str, list[AnyAnswer]]:
    groups: dict[str, list[AnyAnswer]] = {}
    for answer in answers:
        groups.setdefault(key(answer), []).append(answer)
    return groups
