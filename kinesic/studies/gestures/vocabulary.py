"""The lexicon as a vocabulary: what a planner, or a language model, must know to choose a gesture."""

from dataclasses import dataclass

from kinesic.body.robot import SIDE_NAMES, SIDES
from kinesic.expressivity.durations import stroke_spans
from kinesic.expressivity.hands.poses import poses
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.senses import Sense
from kinesic.expressivity.style.effort import Effort, Tempo
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import NEUTRAL


@dataclass(frozen=True)
class VocabularyEntry:
    """One gesture in words. Fields may be added, never renamed."""

    id: str  # what BML's `lexeme` says
    category: str
    says: str  # one line: what is done, and what it means
    meanings: tuple[str, ...]  # words that speak of it, the most characteristic first
    hands: tuple[str, ...]  # left, right: those that take part
    shapes: tuple[str, ...]  # that they take
    stroke_s: float  # [s] that its stroke naturally takes
    whole_s: float  # [s] from rest to rest
    synonyms: tuple[str, ...] = ()  # names that find it too
    tempo: Tempo = "neutral"  # how it is done by its meaning
    body: str = ""  # what head, trunk, shoulders, eyes and face do beside the hands


def vocabulary(lexicon: Lexicon, pace: Pace) -> list[VocabularyEntry]:
    """Lists every gesture in words, by category and name.

    Args:
        lexicon: of gestures.
        pace: of the robot that would play them.
    """
    found = [
        _entry(form, sense, lexicon.names_of(form.id), pace)
        for form, sense in zip(lexicon.forms, lexicon.senses, strict=True)
    ]
    return sorted(found, key=lambda entry: (entry.category, entry.id))


def _entry(form: GestureForm, sense: Sense, names: tuple[str, ...], pace: Pace) -> VocabularyEntry:
    work = poses(form, pace.robot, NEUTRAL)
    natural = stroke_spans(work, Effort(pace, work.nature), holds=not form.rest)
    return VocabularyEntry(
        id=form.id,
        category=form.category,
        says=sense.says,
        meanings=sense.words,
        hands=tuple(SIDE_NAMES[side] for side in SIDES if side in form.sides),
        shapes=form.shapes,
        stroke_s=round(natural["stroke"] + natural["strokeEnd"], 2),
        whole_s=round(sum(natural.values()), 2),
        synonyms=names,
        tempo=form.tempo,
        body=str(form.body),
    )
