"""Design of a gesture study: questions on meanings and comparisons of performances.

A question has six meanings. The wrong ones belong to other gestures of the study; all are used about equally often, so
that their frequency does not reveal the right one.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from random import Random
from typing import Literal, get_args

from kinesic.body.config import ConfigError, suggestion
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.senses import Sense, nearest_sense

StudyTask = Literal["recognition", "comparison", "mismatching", "realism"]
StimulusVersion = Literal["standard", "changed"]

STUDY_TASKS: tuple[StudyTask, ...] = get_args(StudyTask)
STIMULUS_VERSIONS: tuple[StimulusVersion, ...] = get_args(StimulusVersion)
OPTION_COUNT = 6  # number of meanings offered per gesture
LABEL_WORDS = 3  # largest number of words in the label of a meaning
MEANING_CATEGORIES = ("emblem", "emotion", "iconic")  # categories of gestures whose meaning does not depend on speech
STANDARD_SYSTEM = "standard"  # name of the system with unchanged settings in comparisons
OPTION_SEPARATOR = "|"  # separator of the options in an answer


@dataclass(frozen=True)
class Meaning:
    """Meaning of a gesture, as offered to participants."""

    gesture: str  # id of the gesture
    sense: Sense

    @property
    def label(self) -> str:
        """Text for participants: words for the meaning, not for the form."""
        return ", ".join(self.sense.words[:LABEL_WORDS])

    def is_similar(self, other: "Meaning") -> bool:
        """Return whether two meanings are described by matching words."""
        pairs = ((self, other), (other, self))
        return any(nearest_sense(one.sense.words[:LABEL_WORDS], (two.sense,)) is not None for one, two in pairs)


@dataclass(frozen=True)
class StudyQuestion:
    """A gesture with the meanings offered to participants."""

    right: Meaning
    foils: tuple[Meaning, ...]

    @property
    def options(self) -> tuple[Meaning, ...]:
        """All meanings offered for the gesture, the right one first."""
        return (self.right, *self.foils)


def draw_meanings(lexicon: Lexicon, count: int, seed: int, named: Sequence[str] = ()) -> tuple[Meaning, ...]:
    """Choose gestures with their meanings for a study, in random order.

    Args:
        lexicon: lexicon of gestures.
        count: maximum number of gestures, from `MEANING_CATEGORIES`.
        seed: seed of the draw.
        named: ids of gestures to use instead.

    Raises:
        ConfigError: a gesture does not exist, is named twice, or has a name that answers cannot contain.
    """
    senses = {form.id: sense for form, sense in zip(lexicon.forms, lexicon.senses, strict=True)}
    for name, times in Counter(named).items():
        if name not in senses:
            raise ConfigError(f"no gesture {name}{suggestion(name, list(senses))}")
        if times > 1:
            raise ConfigError(f"gesture {name} is named {times} times; once is enough")
    rng = Random(seed)
    drawn = list(named) or [
        name for name, sense in senses.items() if sense.category in MEANING_CATEGORIES and OPTION_SEPARATOR not in name
    ]
    rng.shuffle(drawn)
    if invalid := [name for name in drawn if OPTION_SEPARATOR in name]:
        raise ConfigError(f"gesture {invalid[0]} cannot be used in answers, which separate names by {OPTION_SEPARATOR}")
    return tuple(Meaning(name, senses[name]) for name in (drawn if named else drawn[:count]))


def draw_questions(meanings: Sequence[Meaning], seed: int) -> tuple[StudyQuestion, ...]:
    """Choose five distinct wrong meanings for each gesture.

    Args:
        meanings: meanings of the study's gestures.
        seed: seed of the choice.

    Raises:
        ConfigError: there are too few different meanings.
    """
    rng, uses = Random(seed), Counter[str]()
    questions = []
    for right in meanings:
        foils = _choose_different(right, sorted(meanings, key=lambda other: (uses[other.gesture], rng.random())))
        if len(foils) < OPTION_COUNT - 1:
            raise ConfigError(
                f"gesture {right.gesture} has only {len(foils)} different meanings among {len(meanings)} gestures "
                f"and needs {OPTION_COUNT - 1}: use more or other gestures"
            )
        uses.update(foil.gesture for foil in foils)
        questions.append(StudyQuestion(right, foils))
    return tuple(questions)


def _choose_different(right: Meaning, others: Iterable[Meaning]) -> tuple[Meaning, ...]:
    """Return up to five distinct meanings besides the right one."""
    chosen = [right]
    for other in others:
        if len(chosen) < OPTION_COUNT and not any(other.is_similar(meaning) for meaning in chosen):
            chosen.append(other)
    return tuple(chosen[1:])
