"""Behaviours that a text requests by stage directions, emoji and tags."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import get_args

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.search import find_gestures
from kinesic.intent.behaviour_sets import Channel
from kinesic.intent.behaviours import ChosenBehaviour
from kinesic.intent.intents import Intent, Moment
from kinesic.intent.manuscript.acts import base_forms, load_acts
from kinesic.intent.reading.passage import Passage

MIN_SEARCH_SCORE = 0.75  # lowest search score of a gesture that may perform a stage direction
ACT_CACHE_SIZE = 1024  # number of stage directions whose behaviour is cached
ACT_SPACING = 1.5  # [s] between gestures of stage directions at the same place in the text
FIRST_STROKE_TIME = 1.0  # [s] stroke time of the first stage direction of a text without words
AFTER_WORDS_DELAY = 0.6  # [s] from the last word to the stroke of a stage direction after it
MIN_ACT_DURATION = 1.2  # [s] shortest head movement or facial expression of a stage direction
DIRECTION_INTENT = "direction"  # name of the intents of stage directions


@dataclass(frozen=True, eq=False)
class Directed:
    """Behaviours of a text's stage directions, with warnings about unperformed directions."""

    behaviours: tuple[ChosenBehaviour, ...]
    warnings: tuple[str, ...]


def find_directed(passage: Passage, lexicon: Lexicon, words: range | None = None, *, is_last: bool = True) -> Directed:
    """Find the behaviours that a text requests by stage directions.

    Args:
        passage: text with directions.
        lexicon: gestures that may perform them.
        words: spoken words before which they stand; None: all.
        is_last: whether the directions after the last word count too.
    """
    words = range(len(passage.words)) if words is None else words
    behaviours, warnings = list[ChosenBehaviour](), list[str]()
    counts: dict[tuple[int, Channel], int] = {}
    seen = set[tuple[int, str]]()
    for index, direction in passage.directions:
        if index not in words and not (is_last and index == words.stop == len(passage.words)):
            continue
        act = find_act(direction, lexicon)
        if act is None:
            warnings.append(f"no gesture or expression shows the direction '{direction}'")
        elif (index, act[1]) not in seen:
            seen.add((index, act[1]))
            later = ACT_SPACING * counts.get((index, act[0]), 0)
            counts[index, act[0]] = counts.get((index, act[0]), 0) + 1
            intent = replace(_place(passage, index, direction, later), lexemes=(act[1],))
            behaviours.append(ChosenBehaviour(*act, intent))
    return Directed(tuple(behaviours), tuple(warnings))


@lru_cache(maxsize=ACT_CACHE_SIZE)
def find_act(direction: str, lexicon: Lexicon) -> tuple[Channel, str] | None:
    """Return channel and lexeme that perform a stage direction, or None."""
    acts = load_acts()
    known = acts.find(direction)
    if known is not None:
        channel, _, lexeme = known.partition(" ")
        return next(((name, lexeme) for name in get_args(Channel) if name == channel), None)
    for name in _names(direction):
        match = lexicon.find(name)
        if match is not None and not match.substitute:
            return "gesture", match.form.id
    content = acts.content(direction)
    hits = find_gestures(lexicon, " ".join(content), count=1)
    is_meant = bool(hits) and hits[0].score >= MIN_SEARCH_SCORE and set(content) <= set(hits[0].words)
    return ("gesture", hits[0].id) if is_meant else None


def _names(direction: str) -> Iterator[str]:
    """Yield a stage direction as written, and with its verb's base forms."""
    yield direction
    first, *others = load_acts().content(direction) or [""]
    for verb in base_forms(first):
        yield " ".join((verb, *others))


def _place(passage: Passage, index: int, direction: str, later: float) -> Intent:
    """Create the intent of a stage direction at its position.

    Args:
        passage: text.
        index: of the word that follows it.
        direction: its words.
        later: delay [s] after other directions at the same place.
    """
    words = passage.words
    if not words:
        start = stroke = Moment(f"{FIRST_STROKE_TIME:.2f}", FIRST_STROKE_TIME)
        phrase = -1
        end = stroke.later(MIN_ACT_DURATION)
    elif index < len(words):
        phrase = words[index].phrase
        start, stroke = passage.onset(index), passage.stress(index)
        end = passage.close(passage.phrases[phrase][-1])
    else:
        phrase = words[-1].phrase
        start = passage.close(index - 1)
        stroke = start.later(AFTER_WORDS_DELAY)
        end = start.later(MIN_ACT_DURATION)
    start, stroke, end = start.later(later), stroke.later(later), end.later(later)
    reason = f"the text asks for '{direction}'"
    return Intent(DIRECTION_INTENT, start, stroke, end, 1.0, reason, word=min(index, len(words) - 1), phrase=phrase)
