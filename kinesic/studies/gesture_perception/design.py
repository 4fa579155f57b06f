"""What a study of gestures asks: which of six meanings a gesture has, and which of two performances is more natural.

The wrong meanings of a gesture are those of others in the same study, each used about as often as any other, so that
nobody can tell the right one by how often it is offered.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from random import Random
from typing import Literal, get_args

from kinesic.body.config import ConfigError, suggestion
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.senses import Sense, nearest_sense

StudyTask = Literal["recognition", "comparison"]
StimulusVersion = Literal["standard", "changed"]

TASKS: tuple[StudyTask, ...] = get_args(StudyTask)
SIDES: tuple[StimulusVersion, ...] = get_args(StimulusVersion)
OPTIONS = 6  # meanings that a gesture is offered with
WORDS = 3  # of a meaning, as participants read it
CATEGORIES = ("emblem", "emotion", "iconic")  # gestures that mean something without words
SEPARATOR = "|"  # between the options of one answer


@dataclass(frozen=True)
class Meaning:
    """What a gesture says."""

    gesture: str  # its id
    sense: Sense

    @property
    def label(self) -> str:
        """As participants read it: its most characteristic words, which say nothing of how it is done."""
        return ", ".join(self.sense.words[:WORDS])

    def like(self, other: "Meaning") -> bool:
        """Whether a word of one speaks of the other."""
        pairs = ((self, other), (other, self))
        return any(nearest_sense(one.sense.words[:WORDS], (two.sense,)) is not None for one, two in pairs)


@dataclass(frozen=True)
class StudyQuestion:
    """A gesture, and the meanings that participants choose from."""

    right: Meaning
    foils: tuple[Meaning, ...]

    @property
    def options(self) -> tuple[Meaning, ...]:
        """The right one first."""
        return (self.right, *self.foils)


def draw_meanings(lexicon: Lexicon, count: int, seed: int, named: Sequence[str] = ()) -> tuple[Meaning, ...]:
    """Draws the gestures of a study, in an order of chance.

    Args:
        lexicon: of gestures.
        count: of gestures at most, of those in `CATEGORIES`.
        seed: of the draw.
        named: gestures by their ids, which are taken instead.

    Raises:
        ConfigError: there is no such gesture, one is named twice, or its name cannot stand in answers.
    """
    known = {form.id: sense for form, sense in zip(lexicon.forms, lexicon.senses, strict=True)}
    for name, times in Counter(named).items():
        if name not in known:
            raise ConfigError(f"no gesture {name}{suggestion(name, list(known))}")
        if times > 1:
            raise ConfigError(f"gesture {name} is named {times} times; once is enough")
    chance = Random(seed)
    drawn = list(named) or [
        name for name, sense in known.items() if sense.category in CATEGORIES and SEPARATOR not in name
    ]
    chance.shuffle(drawn)
    if strange := [name for name in drawn if SEPARATOR in name]:
        raise ConfigError(f"gesture {strange[0]} cannot stand in answers, which have {SEPARATOR} between names")
    return tuple(Meaning(name, known[name]) for name in (drawn if named else drawn[:count]))


def draw_questions(meanings: Sequence[Meaning], seed: int) -> tuple[StudyQuestion, ...]:
    """Gives each gesture the meanings of five others, none of which is like its own or like one another.

    Args:
        meanings: of the gestures of a study.
        seed: of what is left to chance.

    Raises:
        ConfigError: there are too few different ones.
    """
    chance, uses = Random(seed), Counter[str]()
    questions = []
    for right in meanings:
        foils = _different(right, sorted(meanings, key=lambda other: (uses[other.gesture], chance.random())))
        if len(foils) < OPTIONS - 1:
            raise ConfigError(
                f"gesture {right.gesture} finds {len(foils)} other meanings among {len(meanings)} gestures, "
                f"and needs {OPTIONS - 1}: take more gestures, or others"
            )
        uses.update(foil.gesture for foil in foils)
        questions.append(StudyQuestion(right, foils))
    return tuple(questions)


def _different(right: Meaning, others: Iterable[Meaning]) -> tuple[Meaning, ...]:
    """The first five of others that are neither like a meaning nor like one another."""
    taken = [right]
    for other in others:
        if len(taken) < OPTIONS and not any(other.like(each) for each in taken):
            taken.append(other)
    return tuple(taken[1:])
