"""Word and phoneme times of Praat's TextGrid."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from kinesic.speech.timings.phone_symbols import SILENCE_LABELS, to_phonetic
from kinesic.speech.timings.timed_words import (
    MAX_SPANS,
    RawSpan,
    TimedSpan,
    TimedWords,
    TimingError,
    check_spans,
    make_phonemes,
    shorten,
)

WORD_TIERS = ("words", "word", "orthography", "ort", "ort-mau")  # names of tiers with words, in lower case
PHONE_TIERS = ("phones", "phonemes", "phone", "phons", "mau", "segments")  # names of tiers with phonemes, in lower case
MAX_TIERS = 1000  # largest number of tiers

# As in Praat, only quoted texts, flags and free-standing numbers count; everything else is a comment.
_TOKEN_PATTERN = re.compile(
    r'"(?:[^"]|"")*+"|<\w+>|(?<!\S)(?:[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?(?!\S)|nan\b)'
)


@dataclass(frozen=True)
class _Tier:
    name: str
    rows: tuple[RawSpan, ...]


class _Tokens:
    """Texts and numbers of a TextGrid, in order."""

    def __init__(self, text: str) -> None:
        self._matches = _TOKEN_PATTERN.finditer(text)
        self._text = text
        self._place = (0, 0)  # of the last token in the text

    def text(self, what: str) -> str:
        """Return the next token, a quoted text."""
        token = self._next(what)
        if not token.startswith('"'):
            raise self._error(what, "a text in quotes")
        return token[1:-1].replace('""', '"')

    def number(self, what: str) -> float:
        """Return the next token, a number."""
        token = self._next(what)
        if token.startswith(('"', "<")):
            raise self._error(what, "a number")
        return float(token)

    def count(self, what: str, most: int) -> int:
        """Return the next token, an integer count up to a limit."""
        value = self.number(what)
        if not (0 <= value <= most and value == int(value)):
            raise self._error(what, f"a whole number from 0 to {most}")
        return int(value)

    def skip_flag(self) -> None:
        """Skip the flag before the number of tiers."""
        self._next("<exists>")

    def _next(self, what: str) -> str:
        match = next(self._matches, None)
        if match is None:
            raise TimingError(f"the file ends before {what}: it is cut off")
        self._place = match.span()
        return match[0]

    def _error(self, what: str, expected: str) -> TimingError:
        begin, end = self._place
        line = self._text.count("\n", 0, begin) + 1
        return TimingError(f"line {line}: {what} is {shorten(self._text[begin:end])}; it must be {expected}")


def read_textgrid(text: str) -> TimedWords:
    """Read the word and phoneme tiers of a TextGrid.

    Without a tier of these names, the first tier with text counts as words.

    Raises:
        TimingError: the file is cut off, or a value is invalid.
    """
    tiers = list(_read_tiers(_Tokens(text)))
    words = _find_tier(tiers, WORD_TIERS)
    phones = _find_tier(tiers, PHONE_TIERS)
    if words is None:
        words = next((tier for tier in tiers if tier is not phones and any(row.text for row in tier.rows)), None)
    if words is None and phones is None:
        names = ", ".join(shorten(tier.name) for tier in tiers) or "none"
        raise TimingError(f"no tier has text; the tiers are {names}")
    return TimedWords(
        _check_tier(words),
        make_phonemes(TimedSpan(to_phonetic(s.text), s.start, s.end) for s in _check_tier(phones)),
        "TextGrid",
    )


def _read_tiers(tokens: _Tokens) -> Iterator[_Tier]:
    for what in ("the file type", "the object class"):
        tokens.text(what)
    for what in ("the start time", "the end time"):
        tokens.number(what)
    tokens.skip_flag()
    left = MAX_SPANS
    for number in range(1, tokens.count("the number of tiers", MAX_TIERS) + 1):
        kind, name = tokens.text(f"the class of tier {number}"), tokens.text(f"the name of tier {number}")
        place = f"tier {shorten(name)}"
        for what in ("start", "end"):
            tokens.number(f"the {what} of {place}")
        count = tokens.count(f"the size of {place}", left)
        left -= count
        yield _Tier(name, tuple(_read_row(tokens, f"{place} {k}", kind == "IntervalTier") for k in range(1, count + 1)))


def _read_row(tokens: _Tokens, place: str, has_end: bool) -> RawSpan:
    start = tokens.number(f"the start of {place}")
    end = tokens.number(f"the end of {place}") if has_end else None
    text = tokens.text(f"the text of {place}").strip()
    return RawSpan(place, "" if text.lower() in SILENCE_LABELS else text, start, end)


def _find_tier(tiers: Sequence[_Tier], names: Sequence[str]) -> _Tier | None:
    """Return the first tier with one of the names."""
    for tier in tiers:
        if tier.name.lower() in names or tier.name.lower().rpartition(" - ")[2] in names:
            return tier
    return None


def _check_tier(tier: _Tier | None) -> tuple[TimedSpan, ...]:
    return () if tier is None else check_spans(tier.rows)
