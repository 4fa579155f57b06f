"""What answers say: how often gestures are recognised, what they are taken for, and what is preferred.

Shares have Wilson's interval, which keeps its coverage for few answers and near 0 and 1, and exact binomial tests.
Both take answers as independent; those of one participant are not quite, so that true intervals are a little wider.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeVar

from kinesic.studies.gesture_perception.answers import Answers, ParticipantAnswer, Preference, Recognition
from kinesic.studies.gesture_perception.design import OPTIONS, SIDES

Tail = Literal["greater", "two-sided"]
AnyAnswer = TypeVar("AnyAnswer", bound=ParticipantAnswer)

CONFIDENCE = 0.95
HABIT = 0.001  # share of chance below which a participant's favourite place is told


@dataclass(frozen=True)
class Share:
    """How many of some answers are of a kind."""

    hits: int
    total: int
    interval: tuple[float, float]  # of the share, at `CONFIDENCE`
    p: float  # that chance alone gives so many, or ones as far from it

    @property
    def rate(self) -> float:
        """The share itself, 0..1."""
        return self.hits / self.total


@dataclass(frozen=True)
class Confusion:
    """How often a gesture was taken for another."""

    shown: str
    chosen: str
    count: int
    offered: int  # so often it could have been chosen


@dataclass(frozen=True)
class Habit:
    """How much a participant, or all, choose by the place where an answer stands."""

    place: int  # the favourite, from 1
    share: Share  # of the answers; p that any place would be chosen so often by chance


@dataclass(frozen=True)
class RecognitionResult:
    """What the recognition task says."""

    overall: Share
    gestures: Mapping[str, Share]  # the least recognised first
    confusions: tuple[Confusion, ...]  # the most frequent first; the right answers are not among them
    participants: Mapping[str, Share]
    habits: Mapping[str, Habit]  # by participant


@dataclass(frozen=True)
class PreferenceResult:
    """What the comparisons say."""

    conditions: Mapping[str, Share]  # of answers that prefer the standard to the changed setting
    first: Share  # of answers that prefer the first interval, whatever it was
    habits: Mapping[str, Habit]  # by participant


def share_of_hits(hits: int, total: int, chance: float, tail: Tail = "two-sided") -> Share:
    """Compares a share with chance.

    Args:
        hits: answers of the kind.
        total: answers, at least 1.
        chance: share that guessing gives.
        tail: which deviations from it count.
    """
    from scipy.stats import binomtest  # noqa: PLC0415 - slow to import, and only answers need it

    test = binomtest(hits, total, chance, alternative=tail)
    whole = binomtest(hits, total).proportion_ci(CONFIDENCE, method="wilson")
    return Share(hits, total, (float(whole.low), float(whole.high)), float(test.pvalue))


def analyse_recognition(answers: Sequence[Recognition]) -> RecognitionResult | None:
    """Says how well gestures are recognised; None without answers."""
    if not answers:
        return None
    gestures = _by(answers, lambda answer: answer.stimulus)
    shares = {gesture: _recognised(own) for gesture, own in gestures.items()}
    return RecognitionResult(
        _recognised(answers),
        dict(sorted(shares.items(), key=lambda item: (item[1].rate, item[0]))),
        confusions(answers),
        {person: _recognised(own) for person, own in _by(answers, lambda answer: answer.participant).items()},
        habits(answers),
    )


def analyse_preference(answers: Sequence[Preference]) -> PreferenceResult | None:
    """Says which performances are preferred; None without answers."""
    if not answers:
        return None
    return PreferenceResult(
        {
            condition: share_of_hits(sum(answer.chosen == SIDES[0] for answer in own), len(own), 1 / len(SIDES))
            for condition, own in sorted(_by(answers, lambda answer: answer.condition).items())
        },
        share_of_hits(sum(answer.place == 0 for answer in answers), len(answers), 1 / len(SIDES)),
        habits(answers),
    )


def confusions(answers: Iterable[Recognition]) -> tuple[Confusion, ...]:
    """Counts what each gesture was taken for, and how often it could have been."""
    taken, offered = Counter[tuple[str, str]](), Counter[tuple[str, str]]()
    for answer in answers:
        offered.update((answer.stimulus, option) for option in answer.options if option != answer.stimulus)
        if not answer.right:
            taken[answer.stimulus, answer.chosen] += 1
    found = (Confusion(shown, chosen, count, offered[shown, chosen]) for (shown, chosen), count in taken.items())
    return tuple(sorted(found, key=lambda each: (-each.count, each.shown, each.chosen)))


def confusion_matrix(answers: Sequence[Recognition]) -> tuple[tuple[str, ...], tuple[tuple[int, ...], ...]]:
    """Counts choices: one row for each gesture that was shown or chosen, one column for what it was taken for."""
    counts = Counter((answer.stimulus, answer.chosen) for answer in answers)
    names = tuple(sorted({name for pair in counts for name in pair}))
    return names, tuple(tuple(counts[shown, chosen] for chosen in names) for shown in names)


def habits(answers: Sequence[ParticipantAnswer]) -> dict[str, Habit]:
    """Finds the place that each participant chooses most often; right answers stand in each equally often."""
    return {person: _habit(own) for person, own in _by(answers, lambda answer: answer.participant).items()}


def strange(found: Answers) -> dict[str, Habit]:
    """Lists participants who choose by place and not by what they see, each with the clearer of two habits."""
    told: dict[str, Habit] = {}
    for own in (habits(found.recognitions), habits(found.preferences)):
        for person, habit in own.items():
            if habit.share.p < min(HABIT, told[person].share.p if person in told else HABIT):
                told[person] = habit
    return told


def _habit(answers: Sequence[ParticipantAnswer]) -> Habit:
    """The favourite place; its p counts that it is the best of all places."""
    choices = len(answers[0].options)
    (place, hits), *_ = Counter(answer.place for answer in answers).most_common(1)
    share = share_of_hits(hits, len(answers), 1 / choices, "greater")
    return Habit(place + 1, Share(share.hits, share.total, share.interval, min(1.0, choices * share.p)))


def _recognised(answers: Sequence[Recognition]) -> Share:
    return share_of_hits(sum(answer.right for answer in answers), len(answers), 1 / OPTIONS, "greater")


def _by(answers: Iterable[AnyAnswer], key: Callable[[AnyAnswer], str]) -> dict[str, list[AnyAnswer]]:
    groups: dict[str, list[AnyAnswer]] = {}
    for answer in answers:
        groups.setdefault(key(answer), []).append(answer)
    return groups
