"""Phoneme letters of an English phrase and its words.

hibari rewrites dates, units and abbreviations before it reads them ("3 km": "3 kilometers"). Written and rewritten
words are matched in order, so that each written word has its letters.
"""

import importlib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from functools import lru_cache
from typing import Protocol

from kinesic.body.pictographs import blank_pictographs
from kinesic.speech.engines.phrase import EngineError
from kinesic.speech.hibari.model import PACKAGE_NAME

SIGN_LETTERS = frozenset(' ;:,.!?\u2014\u2026"()\u201c\u201d')  # letters of hibari for punctuation and spaces
FINAL_STOP = "."  # added to a phrase without a stop, so that its last sound is not cut
CUSTOM_READING = "]("  # start of a custom pronunciation in hibari's own markup, which is not used

Span = tuple[int, int]  # begin and end


class _Token(Protocol):
    """Token of hibari with its phonemes."""

    @property
    def text(self) -> str: ...
    @property
    def whitespace(self) -> str: ...
    @property
    def phonemes(self) -> str | None: ...


class _Reader(Protocol):
    """Conversion of text to phonemes by hibari."""

    def tokenize(self, text: str, /) -> list[_Token]: ...
    def phonemize_tokens(self, tokens: list[_Token], /) -> list[_Token]: ...


class _Rewriter(Protocol):
    """Function that writes numbers, dates and abbreviations as words."""

    def __call__(self, text: str, /) -> str: ...


@dataclass(frozen=True)
class Pronunciation:
    """Phoneme letters of a phrase."""

    letters: str  # letters of hibari's alphabet, with spaces and punctuation
    words: tuple[tuple[Span, Span], ...]  # (range of characters in the phrase, range of `letters`), ends excluded


@lru_cache(maxsize=1)
def load_reader() -> tuple[_Reader, _Rewriter]:
    """Load hibari's lexicon and rules of American English once per process.

    Raises:
        EngineError: the package is missing or differs.
    """
    try:
        reader: _Reader = importlib.import_module(f"{PACKAGE_NAME}.g2p").G2P()
        rewrite: _Rewriter = importlib.import_module(f"{PACKAGE_NAME}.g2p.normalize").normalize
    except (ImportError, AttributeError, OSError) as error:
        raise EngineError(f"hibari-tts cannot be loaded: {error}") from None
    return reader, rewrite


def pronounce(text: str, alphabet: Iterable[str]) -> Pronunciation:
    """Return the phoneme letters of a phrase, and those of each word.

    Args:
        text: one phrase.
        alphabet: letters of the model; others are omitted.

    Raises:
        EngineError: the phrase cannot be read.
    """
    reader, rewrite = load_reader()
    written = blank_pictographs(text).replace(CUSTOM_READING, "] ")
    written += "" if len(written) == len(text) else " " * (len(text) - len(written))
    rewritten = rewrite(written)
    if not rewritten:
        return Pronunciation("", ())
    try:
        tokens = reader.phonemize_tokens(reader.tokenize(rewritten))
    except (ValueError, KeyError, IndexError, TypeError, AttributeError) as error:
        raise EngineError(f"{text!r} cannot be read: {error}") from None
    known = frozenset(alphabet)
    letters, spans = _write_letters(tokens, rewritten, known)
    chunks = _chunks(written)
    matched = _match([written[begin:end] for begin, end in chunks], [rewritten[b:e] for b, e in _chunks(rewritten)])
    words: dict[int, Span] = {}
    for (begin, _), (first, last) in spans:
        chunk = matched[_find_chunk(rewritten, begin)]
        words[chunk] = (min(first, words.get(chunk, (first, 0))[0]), max(last, words.get(chunk, (0, last))[1]))
    ordered = sorted((chunks[chunk], span) for chunk, span in words.items())
    if not letters.rstrip().endswith(tuple(SIGN_LETTERS - {" "})):
        letters = letters.rstrip() + FINAL_STOP
    return Pronunciation(letters, tuple(ordered))


def _write_letters(
    tokens: Sequence[_Token], text: str, alphabet: frozenset[str]
) -> tuple[str, list[tuple[Span, Span]]]:
    """Return the phoneme letters, and character and letter ranges of audible tokens."""
    letters = ""
    spans: list[tuple[Span, Span]] = []
    position = 0
    for token in tokens:
        found = text.find(token.text, position)
        begin = position if found < 0 else found
        position = begin + len(token.text)
        sounds = "".join(letter for letter in token.phonemes or "" if letter in alphabet)
        if not letters:
            sounds = sounds.lstrip()
        core = sounds.strip("".join(SIGN_LETTERS))
        if core:
            first = len(letters) + sounds.index(core)
            spans.append(((begin, position), (first, first + len(core))))
        letters += sounds + (" " if token.whitespace and (letters or sounds) else "")
    return letters, spans


def _chunks(text: str) -> list[Span]:
    """Return the character range of each space-separated chunk of a text."""
    spans: list[Span] = []
    begin = 0
    for chunk in text.split():
        begin = text.index(chunk, begin)
        spans.append((begin, begin + len(chunk)))
        begin += len(chunk)
    return spans


def _find_chunk(text: str, position: int) -> int:
    """Return the index of the chunk between spaces at a position."""
    before = text[: position + 1].split()
    return max(len(before) - 1, 0)


def _match(written: Sequence[str], rewritten: Sequence[str]) -> list[int]:
    """Return the index of the written chunk for each rewritten chunk."""
    return list(_matches(written, rewritten))


def _matches(written: Sequence[str], rewritten: Sequence[str]) -> Iterator[int]:
    for _, first, last, begin, end in SequenceMatcher(None, written, rewritten, autojunk=False).get_opcodes():
        for index in range(begin, end):
            if last > first:
                yield first + (index - begin) * (last - first) // (end - begin)
            else:  # added words belong to the one before
                yield max(first - 1, 0)
