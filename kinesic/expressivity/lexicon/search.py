"""Ranked search for gestures by their names, synonyms, meanings and descriptions."""

import difflib
import math
from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from kinesic.expressivity.lexicon.entries import LexiconEntry
from kinesic.expressivity.lexicon.form import MatchKind
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.names import split_words
from kinesic.expressivity.lexicon.query_words import (
    BODY_WORDS,
    content_words,
    form_words,
    is_function_word,
    related_words,
    search_stem,
)

HitKind = Literal["all", "name", "synonym", "class", "words", "near"]

DEFAULT_HIT_COUNT = 10  # default largest number of gestures in an answer
MAX_QUERY_LENGTH = 200  # [characters] length to which a query is cut
INDEX_CACHE_SIZE = 4  # largest number of lexicons whose index is cached
MIN_SCORE = 0.2  # lowest score of a gesture in an answer
NEAR_SCORE = 0.5  # score below which a gesture counts as merely similar to the query

NAME_SCORE = 1.0  # score of the gesture that the query names
SYNONYM_SCORE = 0.98  # score of the gesture of which the query is a synonym
CLASS_SCORE = 0.95  # score of the gesture that represents the class named by the query
NAME_HITS: Mapping[MatchKind, tuple[HitKind, float]] = {  # kind and score of the gesture for the query as a lexeme
    "exact": ("name", NAME_SCORE),
    "synonym": ("synonym", SYNONYM_SCORE),
    "class": ("class", CLASS_SCORE),
}
MAX_WORD_SCORE = 0.9  # score of a gesture that has all words of the query

ID_WEIGHT = 1.0  # weight of a word in the name of a gesture
MEANING_WEIGHT = 0.95  # weight of the most characteristic word of a meaning
LAST_MEANING_WEIGHT = 0.7  # weight of the least characteristic word of a meaning
SYNONYM_WEIGHT = 0.95  # weight of a synonym that is one word
PHRASE_WEIGHT = 0.6  # weight of a word in a synonym of several words
DESCRIPTION_WEIGHT = 0.5  # weight of a word in the description
BODY_WEIGHT = 0.75  # weight of a part of the body in the description
CATEGORY_WEIGHT = 0.4  # weight of the category's name
FORM_WEIGHT = 0.4  # weight of a word for the gesture's hands or a touched body part

STEM_QUALITY = 0.95  # match quality of another inflection of the word, such as waving for wave
RELATED_QUALITY = 0.6  # match quality of a word of similar meaning, such as silent for quiet
PREFIX_QUALITY = 0.7  # match quality of a word that begins with an unknown word of the query
LONGER_WORD_QUALITY = 0.35  # match quality of a longer word, such as yesterday for yes
SPELLING_QUALITY = 0.6  # match quality of a word spelt similarly to an unknown word of the query
MIN_PREFIX_LENGTH = 3  # [letters] shortest beginning of a word that is completed
MIN_SPELLING_LENGTH = 4  # [letters] shortest word whose spelling is corrected
SPELLING_CUTOFF = 0.8  # lowest similarity of spelling, 0 to 1, of a word that corrects an unknown one


@dataclass(frozen=True)
class GestureHit:
    """Gesture found by a search."""

    id: str  # lexeme in BML
    category: str
    says: str  # movement and meaning in one line
    score: float  # relevance, 0 to 1; below NEAR_SCORE the gesture is only near the query
    kind: HitKind  # part of the gesture's description that the query matched
    words: tuple[str, ...] = ()  # words of the query that the gesture matches


def find_gestures(
    lexicon: Lexicon, query: str, *, category: str = "", count: int = DEFAULT_HIT_COUNT
) -> tuple[GestureHit, ...]:
    """Find gestures by words, the most relevant first.

    The gesture that a document would get for the query as its lexeme comes first. Then words count by how rare they
    are, and by where they occur: in names and meanings more than in descriptions. Other forms of a word, its beginning
    and similar spellings count less.

    Args:
        lexicon: lexicon to search.
        query: words in English, such as "weigh two things"; empty: every gesture, in the order of the lexicon.
        category: category of the gestures; empty: any.
        count: largest number of gestures.

    Returns:
        The gestures; none if no word of the query is near one of the lexicon.
    """
    query, index = query[:MAX_QUERY_LENGTH].strip(), _index(lexicon)
    hits = _rank(index, lexicon, query) if query else [_hit(entry, 1.0, "all") for entry in index.entries]
    return tuple(hit for hit in hits if category in ("", hit.category))[:count]


def _rank(index: "_Index", lexicon: Lexicon, query: str) -> list[GestureHit]:
    """Return the hits of a query with at least `MIN_SCORE`, by relevance."""
    words = content_words(query)
    hits = [_hit(index.entries[k], score, kind, matched) for k, (score, kind, matched) in index.scores(words).items()]
    named = _find_named(lexicon, query, words) if words else None
    if named is not None:
        hits = [named, *(hit for hit in hits if hit.id != named.id)]
    return sorted((hit for hit in hits if hit.score >= MIN_SCORE), key=lambda hit: -hit.score)


def _find_named(lexicon: Lexicon, query: str, words: Sequence[str]) -> GestureHit | None:
    """Return the gesture that the query names as a lexeme, or None.

    A gesture that only some words name is left to the ranking.
    """
    match = lexicon.find(query)
    if match is None or (match.kind != "class" and match.substitute):
        return None
    kind, score = NAME_HITS[match.kind]
    sense = lexicon.sense(match.form)
    return GestureHit(match.form.id, match.form.category, sense.says, score, kind, tuple(words))


def _hit(entry: LexiconEntry, score: float, kind: HitKind, words: Iterable[str] = ()) -> GestureHit:
    return GestureHit(entry.id, entry.category, entry.sense.says, round(score, 3), kind, tuple(words))


@dataclass(frozen=True, eq=False)
class _Index:
    """Inverted index of a lexicon: the gestures of each word."""

    entries: tuple[LexiconEntry, ...]
    weights: Mapping[str, Mapping[int, float]]  # weight, 0 to 1, by word and index of the gesture
    stems: Mapping[str, tuple[str, ...]]  # words by stem
    vocabulary: tuple[str, ...]  # all words, sorted

    def scores(self, words: Sequence[str]) -> dict[int, tuple[float, HitKind, tuple[str, ...]]]:
        """Return score, kind and matched words of each matching gesture."""
        gains_by_gesture: dict[int, dict[str, float]] = {}
        rarities: dict[str, float] = {}
        for word in words:
            matches = dict(self._matches(word))
            known = [other for other, quality in matches.items() if quality >= STEM_QUALITY]
            rarities[word] = max(map(self._rarity, known or matches), default=self._rarity(""))
            for other, quality in matches.items():
                for k, weight in self.weights[other].items():
                    gain = weight * quality * min(1.0, self._rarity(other) / rarities[word])
                    gains_by_gesture.setdefault(k, {})[word] = max(gain, gains_by_gesture.get(k, {}).get(word, 0.0))
        total = sum(rarities.values())
        scored: dict[int, tuple[float, HitKind, tuple[str, ...]]] = {}
        for k, gains in gains_by_gesture.items():
            score = MAX_WORD_SCORE * sum(rarities[word] * gain for word, gain in gains.items()) / total
            scored[k] = (score, "words" if score >= NEAR_SCORE else "near", tuple(gains))
        return scored

    def _matches(self, word: str) -> Iterator[tuple[str, float]]:
        """Yield lexicon words that match a query word, with their quality."""
        alike = [other for other in self.stems.get(search_stem(word), ()) if not is_function_word(other)]
        related = [other for name in related_words(word) for other in self.stems.get(search_stem(name), ())]
        begun = self._words_with_prefix(word)
        begun_quality = LONGER_WORD_QUALITY if alike or word in self.weights else PREFIX_QUALITY
        yield from ((other, RELATED_QUALITY) for other in related)
        yield from ((other, begun_quality) for other in begun)
        yield from ((other, STEM_QUALITY) for other in alike)
        if word in self.weights:
            yield word, 1.0
        elif not alike and not begun and not related and len(word) >= MIN_SPELLING_LENGTH:
            near = difflib.get_close_matches(word, self.vocabulary, cutoff=SPELLING_CUTOFF)
            yield from ((other, SPELLING_QUALITY) for other in near)

    def _words_with_prefix(self, word: str) -> list[str]:
        """Return the lexicon's words that begin with a query word."""
        if len(word) < MIN_PREFIX_LENGTH:
            return []
        first = bisect_left(self.vocabulary, word)
        last = bisect_left(self.vocabulary, word + "\U0010ffff")
        return [other for other in self.vocabulary[first:last] if other != word]

    def _rarity(self, word: str) -> float:
        """Return the inverse document frequency of a word, at least 0."""
        count = len(self.weights.get(word, ()))
        return math.log(1.0 + (len(self.entries) - count + 0.5) / (count + 0.5))


@lru_cache(maxsize=INDEX_CACHE_SIZE)
def _index(lexicon: Lexicon) -> _Index:
    """Build the index of a lexicon, with the first of equal names."""
    entries = {entry.id: entry for entry in reversed(lexicon.entries)}
    ordered = tuple(entry for entry in lexicon.entries if entries[entry.id] is entry)
    names: dict[str, list[str]] = {}
    for name, gesture in lexicon.synonyms:
        names.setdefault(gesture, []).append(name)
    weights: dict[str, dict[int, float]] = {}
    for k, entry in enumerate(ordered):
        for word, weight in _weighted_words(entry, names.get(entry.id, ())):
            by_gesture = weights.setdefault(word, {})
            by_gesture[k] = max(weight, by_gesture.get(k, 0.0))
    stems: dict[str, list[str]] = {}
    for word in weights:
        stems.setdefault(search_stem(word), []).append(word)
    return _Index(ordered, weights, {stem: tuple(words) for stem, words in stems.items()}, tuple(sorted(weights)))


def _weighted_words(entry: LexiconEntry, synonyms: Iterable[str]) -> Iterator[tuple[str, float]]:
    """Yield the words that describe a gesture, weighted 0 to 1."""
    yield from ((word, ID_WEIGHT) for word in split_words(entry.id))
    for name in synonyms:
        words = split_words(name)
        yield from ((word, SYNONYM_WEIGHT if len(words) == 1 else PHRASE_WEIGHT) for word in words)
    meaning = entry.sense.words
    step = (MEANING_WEIGHT - LAST_MEANING_WEIGHT) / max(len(meaning) - 1, 1)
    for rank, name in enumerate(meaning):
        yield from ((word, MEANING_WEIGHT - rank * step) for word in split_words(name))
    for word in split_words(entry.sense.says):
        yield word, BODY_WEIGHT if word in BODY_WORDS else DESCRIPTION_WEIGHT
    yield from ((word, CATEGORY_WEIGHT) for word in split_words(entry.category))
    yield from ((word, FORM_WEIGHT) for word in form_words(entry.form))
