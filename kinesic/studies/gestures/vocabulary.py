"""Lexicon as a vocabulary for planners or language models that choose gestures."""

from dataclasses import dataclass

from kinesic.body.robot import SIDE_NAMES, SIDES
from kinesic.expressivity.durations import stroke_durations
from kinesic.expressivity.hands.poses import poses
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.senses import Sense
from kinesic.expressivity.style.effort import Effort, Tempo
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import NEUTRAL_EXPRESSIVITY


@dataclass(frozen=True)
class VocabularyEntry:
    """Description of one gesture in words.

    Fields may be added, never renamed.
    """

    id: str  # lexeme in BML
    category: str
    says: str  # one line: form and meaning
    meanings: tuple[str, ...]  # words for its meaning, most characteristic first
    hands: tuple[str, ...]  # left, right: hands that take part
    shapes: tuple[str, ...]  # hand shapes
    stroke_s: float  # [s] natural duration of the stroke
    whole_s: float  # [s] duration from rest to rest
    synonyms: tuple[str, ...] = ()  # further names of the gesture
    tempo: Tempo = "neutral"  # tempo by its meaning
    body: str = ""  # motion of head, trunk, shoulders, eyes and face


def list_vocabulary(lexicon: Lexicon, pace: Pace) -> list[VocabularyEntry]:
    """List every gesture in words, by category and name.

    Args:
        lexicon: lexicon of gestures.
        pace: pace of the performing robot.
    """
    entries = [
        _entry(form, sense, lexicon.names_of(form.id), pace)
        for form, sense in zip(lexicon.forms, lexicon.senses, strict=True)
    ]
    return sorted(entries, key=lambda entry: (entry.category, entry.id))


def _entry(form: GestureForm, sense: Sense, names: tuple[str, ...], pace: Pace) -> VocabularyEntry:
    hand_poses = poses(form, pace.robot, NEUTRAL_EXPRESSIVITY)
    natural = stroke_durations(hand_poses, Effort(pace, hand_poses.traits), holds=not form.rest)
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
