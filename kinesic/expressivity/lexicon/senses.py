"""Search for the gesture whose meaning best matches an unknown lexeme."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from kinesic.bml.block import HandMode
from kinesic.expressivity.lexicon.names import NAME_CACHE_SIZE

_WORD_PATTERN = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
_EMPTY_WORDS = frozenset({"a", "an", "the", "of", "to", "ges", "gesture", "pos", "pose", "posture", "hand", "lexeme"})
_SIDE_LETTERS: dict[str, HandMode] = {"l": "left", "r": "right", "b": "both"}
_SIDE_WORDS: dict[str, HandMode] = {"left": "left", "right": "right", "both": "both"}
_WORD_ENDINGS = ("s", "es", "d", "ed", "ing", "er", "est", "ly", "ment")  # endings of inflected words
_MIN_STEM_LENGTH = 3  # [letters] shortest word that has inflections
MAX_NAME_LENGTH = 120  # [characters] longer lexemes are not interpreted

_EXACT_SCORE = 1.0  # score of a word that describes the gesture
_INFLECTION_SCORE = 0.75  # score of an inflection of a word that names the gesture
_CATEGORY_SCORE = 0.25  # score of the name of the gesture's category


@dataclass(frozen=True)
class LexemeReading:
    """Words and hand found in a lexeme."""

    words: tuple[str, ...]  # meaningful words, lower-case, in order
    mode: HandMode = "unspecified"  # hand named by a letter or word


@dataclass(frozen=True)
class Sense:
    """Words that describe a gesture, the most characteristic first."""

    words: tuple[str, ...]
    category: str
    says: str = ""  # movement and meaning in one line


def read_lexeme(lexeme: str) -> LexemeReading:
    """Split a lexeme into words, and find the named hand.

    `Rise_Arm_R2` gives ("rise", "arm") on the right. It is split at underscores, capitals and digits. Articles, digits
    and words such as `Ges` are removed. A single letter L, R or B names the hand; the words left, right and both do so
    too if other words remain.
    """
    if len(lexeme) > MAX_NAME_LENGTH:
        return LexemeReading(())
    tokens = [word.lower() for word in _WORD_PATTERN.findall(lexeme)]
    words = [word for word in tokens if len(word) > 1 and word not in _EMPTY_WORDS]
    sides = [_SIDE_LETTERS[word] for word in tokens if word in _SIDE_LETTERS]
    meaningful = [word for word in words if word not in _SIDE_WORDS]
    if meaningful:
        sides += [_SIDE_WORDS[word] for word in words if word in _SIDE_WORDS]
    return LexemeReading(tuple(meaningful or words), sides[-1] if sides else "unspecified")


def nearest_sense(words: Sequence[str], senses: Sequence[Sense]) -> tuple[int, tuple[str, ...]] | None:
    """Find the gesture meaning that best matches some words.

    Ties go to the sense that matches the earliest word, then to the one of which this word is most characteristic, then
    to the first.

    Returns:
        Index of the sense and the matching words; None when no word matches.
    """
    best, best_key = None, (0.0, 0.0, 0.0)
    for index, sense in enumerate(senses):
        scores = [_score(word, sense) for word in words]
        matches = [k for k, (quality, _) in enumerate(scores) if quality > 0]
        if not matches:
            continue
        key = (sum(quality for quality, _ in scores), -float(matches[0]), -float(scores[matches[0]][1]))
        if best is None or key > best_key:
            best, best_key = (index, tuple(words[k] for k in matches)), key
    return best


def _score(word: str, sense: Sense) -> tuple[float, int]:
    """Return match score and position of a word in a gesture's meaning."""
    if word in sense.words:
        return _EXACT_SCORE, sense.words.index(word)
    for rank, sense_word in enumerate(sense.words):
        if _is_inflection(word, sense_word):
            return _INFLECTION_SCORE, rank
    return (_CATEGORY_SCORE, 0) if word == sense.category else (0.0, 0)


def _is_inflection(word: str, sense_word: str) -> bool:
    """Return whether one word is an inflection of the other."""
    return word in _inflections(sense_word) or sense_word in _inflections(word)


@lru_cache(maxsize=NAME_CACHE_SIZE)
def _inflections(word: str) -> frozenset[str]:
    """Return the inflected forms of a word, such as plural and participle.

    Words of one or two letters have none.
    """
    if len(word) < _MIN_STEM_LENGTH:
        return frozenset()
    stem = word.removesuffix("e")
    return frozenset(word + ending for ending in _WORD_ENDINGS) | {
        stem + ending for ending in ("ing", "er", "est", "ed")
    }
