"""What a lexeme means when it is no entry of the lexicon: its words, and the gesture that they speak of."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from kinesic.bml.block import HandMode
from kinesic.expressivity.lexicon.names import NAMES_KEPT

_WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
_NOISE = frozenset({"a", "an", "the", "of", "to", "ges", "gesture", "pos", "pose", "posture", "hand", "lexeme"})
_SIDES: dict[str, HandMode] = {"l": "left", "r": "right", "b": "both"}
_SIDE_WORDS: dict[str, HandMode] = {"left": "left", "right": "right", "both": "both"}
_ENDINGS = ("s", "es", "d", "ed", "ing", "er", "est", "ly", "ment")
_SHORTEST_STEM = 3  # letters
LONGEST_NAME = 120  # characters of a name that are read; a longer one is none

_EXACT, _NEAR, _CATEGORY = 1.0, 0.75, 0.25


@dataclass(frozen=True)
class LexemeReading:
    """A lexeme taken apart."""

    words: tuple[str, ...]  # that may carry its meaning, lower-case, in order
    mode: HandMode = "unspecified"  # the side that its letters or words name


@dataclass(frozen=True)
class Sense:
    """The words that describe one gesture, the most characteristic first."""

    words: tuple[str, ...]
    category: str
    says: str = ""  # what is done and what it means, in one line


def read_lexeme(lexeme: str) -> LexemeReading:
    """Takes a lexeme apart at underscores, capitals and digits: `Rise_Arm_R2` is ("rise", "arm") on the right.

    Articles, digits and words such as `Ges` say nothing about the meaning. A single letter L, R or B names the
    side; the words left, right and both do so too, if other words are there to carry the meaning.
    """
    if len(lexeme) > LONGEST_NAME:
        return LexemeReading(())
    tokens = [word.lower() for word in _WORD.findall(lexeme)]
    words = [word for word in tokens if len(word) > 1 and word not in _NOISE]
    sides = [_SIDES[word] for word in tokens if word in _SIDES]
    meant = [word for word in words if word not in _SIDE_WORDS]
    if meant:
        sides += [_SIDE_WORDS[word] for word in words if word in _SIDE_WORDS]
    return LexemeReading(tuple(meant or words), sides[-1] if sides else "unspecified")


def nearest_sense(words: Sequence[str], senses: Sequence[Sense]) -> tuple[int, tuple[str, ...]] | None:
    """Finds the sense that most of some words speak of.

    Among equals the one wins that the earliest word speaks of, then the one it is most characteristic of, then
    the first.

    Returns:
        Index of the sense and the words that led to it; None when no word speaks of any.
    """
    best, best_key = None, (0.0, 0.0, 0.0)
    for index, sense in enumerate(senses):
        marks = [_mark(word, sense) for word in words]
        found = [k for k, (quality, _) in enumerate(marks) if quality > 0]
        if not found:
            continue
        key = (sum(quality for quality, _ in marks), -float(found[0]), -float(marks[found[0]][1]))
        if best is None or key > best_key:
            best, best_key = (index, tuple(words[k] for k in found)), key
    return best


def _mark(word: str, sense: Sense) -> tuple[float, int]:
    """How well a word names a sense, and how far down its list."""
    if word in sense.words:
        return _EXACT, sense.words.index(word)
    for rank, known in enumerate(sense.words):
        if _near(word, known):
            return _NEAR, rank
    return (_CATEGORY, 0) if word == sense.category else (0.0, 0)


def _near(word: str, known: str) -> bool:
    """An inflection either way: tables, large-r."""
    return word in _inflections(known) or known in _inflections(word)


@lru_cache(maxsize=NAMES_KEPT)
def _inflections(word: str) -> frozenset[str]:
    """A word with the usual endings, a silent e dropped; words of one or two letters have none."""
    if len(word) < _SHORTEST_STEM:
        return frozenset()
    stem = word.removesuffix("e")
    return frozenset(word + ending for ending in _ENDINGS) | {stem + ending for ending in ("ing", "er", "est", "ed")}
