"""Word and viseme times of Amazon Polly's speech marks."""

from bisect import bisect_right
from collections.abc import Sequence

import msgspec

from kinesic.body.utterance import Phoneme
from kinesic.speech.timings.timed_words import (
    RawSpan,
    TimedSpan,
    TimedWords,
    TimingError,
    check_spans,
    check_time,
    make_phonemes,
)

TIME_UNITS_PER_SECOND = 1000.0  # [1/s] units of time of speech marks
SILENCE_VISEME = "sil"  # viseme of a closed, silent mouth
VISEME_SOUNDS = {"T": "θ", "S": "ʃ", "@": "ə", "E": "ɛ", "O": "ɔ"}  # viseme -> sound; others are phonetic letters


class _Mark(msgspec.Struct):
    time: float  # [ms]
    type: str
    value: str = ""


def read_polly(content: bytes) -> TimedWords:
    """Read the words and visemes of Polly's speech marks.

    A mark has no end: a word lasts until the next word, or until the silence before it.

    Raises:
        TimingError: a time is invalid.
        msgspec.DecodeError: a line has another structure.
    """
    marks = _read_lines(content)
    words = _list_spans(marks, "word")
    visemes = _list_spans(marks, "viseme")
    spans = tuple(
        TimedSpan(VISEME_SOUNDS.get(span.text, span.text), span.start, span.end)
        for span in visemes
        if span.text != SILENCE_VISEME
    )
    silences = [span.start for span in visemes if span.text == SILENCE_VISEME]
    timed = tuple(TimedSpan(word.text, word.start, _find_end(word, silences)) for word in words)
    return TimedWords(timed, _drop_endless(make_phonemes(spans)), "Polly speech marks")


def _find_end(word: TimedSpan, silences: Sequence[float]) -> float:
    """Return the start [s] of a word's first silence, or its end."""
    following = bisect_right(silences, word.start)
    return min([word.end, *silences[following : following + 1]])


def _read_lines(content: bytes) -> list[tuple[str, _Mark]]:
    marks: list[tuple[str, _Mark]] = []
    for number, line in enumerate(content.splitlines(), 1):
        if line.strip():
            try:
                marks.append((f"line {number}", msgspec.json.decode(line, type=_Mark)))
            except msgspec.DecodeError as error:
                raise TimingError(f"line {number}: {error}") from None
    return marks


def _list_spans(marks: Sequence[tuple[str, _Mark]], kind: str) -> tuple[TimedSpan, ...]:
    rows = [(place, mark) for place, mark in marks if mark.type == kind]
    last = max(
        (check_time(mark.time, f"{place} time", per_second=TIME_UNITS_PER_SECOND) for place, mark in marks), default=0.0
    )
    spans = check_spans(
        (RawSpan(place, mark.value, mark.time) for place, mark in rows), per_second=TIME_UNITS_PER_SECOND
    )
    return tuple(TimedSpan(span.text, span.start, max(span.start, min(span.end, last))) for span in spans)


def _drop_endless(phonemes: tuple[Phoneme, ...]) -> tuple[Phoneme, ...]:
    return tuple(phoneme for phoneme in phonemes if phoneme.duration > 0.0)
