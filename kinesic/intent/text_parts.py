"""Division of long texts into parts, each short enough for one plan."""

import re
from collections.abc import Iterator, Sequence

from kinesic.intent.manuscript.pieces import PARAGRAPH_PAUSE, SpokenText
from kinesic.intent.manuscript.reading import read_manuscript
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.passage import Word
from kinesic.intent.reading.prosody import reopen
from kinesic.intent.reading.words import read_text

MAX_TEXT_WORDS = 4000  # largest number of spoken words of one plan, about 27 minutes
MAX_PART_WORDS = 600  # largest number of spoken words of a part of a longer text, about 4 minutes
MIN_PART_WORDS = 300  # smallest number of words of a part before the last one
_PUNCTUATION_PATTERN = re.compile(r"[^\w\s<]*")  # pattern of the signs directly behind a word


def divide_long_text(text: str, *, language: str = "en", character: str = "") -> tuple[SpokenText, ...]:
    """Divide a long text into parts between paragraphs or sentences.

    A text of at most `MAX_TEXT_WORDS` words has one part. All warnings about omitted text are in the first part.

    Args:
        text: as people write it.
        language: its tag.
        character: speaker of a dialogue whose lines are spoken; empty: all.
    """
    spoken, warnings = read_manuscript(text, character=character)
    words = read_text(spoken, load_language(language)).words
    if len(words) <= MAX_TEXT_WORDS:
        return (SpokenText(spoken, warnings),)
    cuts = [(_find_cut(spoken, words[start - 1]), reopen(words[start - 1].prosody)) for start in _part_starts(words)]
    begins, ends = [(0, ""), *cuts], [*(cut for cut, _ in cuts), len(spoken)]
    parts = [f"{opening}{spoken[begin:end]}" for (begin, opening), end in zip(begins, ends, strict=True)]
    return (SpokenText(parts[0], warnings), *map(SpokenText, parts[1:]))


def _part_starts(words: Sequence[Word]) -> Iterator[int]:
    """Yield the indices of first words of the second and later parts."""
    start = 0
    while len(words) - start > MAX_PART_WORDS:
        candidates = range(start + MIN_PART_WORDS, start + MAX_PART_WORDS + 1)
        start = max(candidates, key=lambda k: (_rank_boundary(words[k - 1], words[k]), k))
        yield start


def _rank_boundary(before: Word, after: Word) -> int:
    """Return how well a text can be divided between two words.

    The larger of two ranks is preferred: paragraph, sentence, phrase, word, and never within a number.
    """
    if before.end == after.end:
        return -1
    if before.sentence == after.sentence:
        return int(before.phrase != after.phrase)
    return 3 if after.pause >= PARAGRAPH_PAUSE else 2


def _find_cut(spoken: str, last: Word) -> int:
    """Return the position behind a part's last word and its punctuation."""
    punctuation = _PUNCTUATION_PATTERN.match(spoken, last.end)
    return punctuation.end() if punctuation else last.end
