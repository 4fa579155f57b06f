"""Assignment of word times from a file to a text's words."""

import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher

from kinesic.speech.timings.timed_words import TimedSpan


@dataclass(frozen=True)
class GivenTime:
    """Start and end of a recorded word, as stated in a file."""

    start: float | None = None  # [s]; None: inside a phrase
    end: float | None = None  # [s]; None: inside a phrase


def match_words(words: Sequence[str], spans: Sequence[TimedSpan]) -> list[GivenTime]:
    """Return the times from a file for each word of a text.

    Case and punctuation are ignored. A phrase gives its start to its first word, and its end to its last.

    Args:
        words: of the text, in order.
        spans: words or phrases with times, in order.
    """
    tokens = [token for span in spans for token in _divide(span)]
    matcher = SequenceMatcher(None, [_plain(word) for word in words], [text for text, _ in tokens], autojunk=False)
    times = [GivenTime() for _ in words]
    for begin, other, size in matcher.get_matching_blocks():
        for k in range(size):
            times[begin + k] = tokens[other + k][1]
    return times


def _divide(span: TimedSpan) -> Iterator[tuple[str, GivenTime]]:
    """Yield a span's plain words, with times of the first and last."""
    texts = [plain for text in span.text.split() if (plain := _plain(text))]
    for k, text in enumerate(texts):
        yield text, GivenTime(span.start if k == 0 else None, span.end if k + 1 == len(texts) else None)


def _plain(text: str) -> str:
    letters = unicodedata.normalize("NFKD", text.casefold())
    return "".join(letter for letter in letters if letter.isalnum())
