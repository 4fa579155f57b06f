"""Words and phonemes of a recording with their times."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise

from kinesic.body.utterance import Phoneme

MAX_TIME = 1300.0  # [s] latest accepted time; no longer recording is played
MAX_SPANS = 100_000  # largest number of words or phonemes of a file
MAX_SHOWN_LENGTH = 40  # [characters] longest quotation from a file in a message


class TimingError(ValueError):
    """Failure to read the times of words.

    The text names the place and the value.
    """


@dataclass(frozen=True)
class TimedSpan:
    """Word, phrase or phoneme with its times in the recording."""

    text: str  # one word, or several of a subtitle
    start: float  # [s] start in the recording
    end: float  # [s] end in the recording


@dataclass(frozen=True)
class TimedWords:
    """Words and phonemes of a recording in order, with their times."""

    words: tuple[TimedSpan, ...]
    phonemes: tuple[Phoneme, ...] = ()  # empty if the file has none
    file_format: str = ""  # name of the file's format in messages

    @property
    def text(self) -> str:
        """Text of all words, separated by spaces."""
        return " ".join(word.text for word in self.words)


@dataclass(frozen=True)
class RawSpan:
    """Word, phrase or phoneme of a file, with unchecked times."""

    place: str  # place in the file, such as `segments[0].words[3]`
    text: str
    start: float  # in the unit of the file
    end: float | None = None  # end time in the unit of the file; None: the start of the next span


def check_spans(rows: Iterable[RawSpan], *, per_second: float = 1.0) -> tuple[TimedSpan, ...]:
    """Check spans of a file, convert to seconds and drop empty ones.

    A span ends no later than the next one starts.

    Args:
        rows: spans in the order of the file.
        per_second: units of time of the file in a second.

    Raises:
        TimingError: a time is invalid, or before that of the preceding span.
    """
    spans: list[TimedSpan] = []
    for row in rows:
        start = check_time(row.start, f"{row.place} start", per_second=per_second)
        end = start if row.end is None else check_time(row.end, f"{row.place} end", per_second=per_second)
        if end < start:
            raise TimingError(f"{row.place} {shorten(row.text)} ends at {end:g} s, before its start at {start:g} s")
        if spans and start < spans[-1].start:
            raise TimingError(
                f"{row.place} {shorten(row.text)} starts at {start:g} s, before {shorten(spans[-1].text)} "
                f"at {spans[-1].start:g} s: sort the file by time"
            )
        if row.text.strip():
            spans.append(TimedSpan(" ".join(row.text.split()), start, end if row.end is not None else MAX_TIME))
        if len(spans) > MAX_SPANS:
            raise TimingError(f"more than {MAX_SPANS} words or phonemes")
    return tuple(replace(a, end=max(a.start, min(a.end, b.start))) for a, b in pairwise(spans)) + tuple(spans[-1:])


def check_time(value: float, place: str, *, per_second: float = 1.0) -> float:
    """Convert a time of a file to seconds, and check its range.

    Args:
        value: time in the unit of the file.
        place: name of the value in messages.
        per_second: units of time of the file in a second.

    Raises:
        TimingError: the time is not between 0 and `MAX_TIME`.
    """
    if not 0 <= value <= MAX_TIME * per_second:  # also false for NaN, and safe for integers of any length
        shown = f"{value:g}" if isinstance(value, float) else shorten(str(value) if abs(value) < 1e30 else "1e30")
        raise TimingError(f"{place} is {shown}; times are 0 to {MAX_TIME * per_second:.0f}")
    return float(value) / per_second


def make_phonemes(spans: Iterable[TimedSpan]) -> tuple[Phoneme, ...]:
    """Convert spans of phonetic symbols into phonemes."""
    return tuple(Phoneme(span.text, span.start, span.end - span.start) for span in spans)


def shorten(text: str) -> str:
    """Quote a text for a message, cut to a readable length."""
    plain = " ".join(text.split())
    return repr(plain if len(plain) <= MAX_SHOWN_LENGTH else f"{plain[:MAX_SHOWN_LENGTH]}...")
