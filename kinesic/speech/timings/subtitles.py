"""Times of phrases and words in subtitles (SubRip and WebVTT)."""

import html
import re
from collections.abc import Iterator

from kinesic.speech.timings.timed_words import RawSpan, TimedWords, TimingError, check_spans, shorten

_TIME_PATTERN = r"(?:(\d{1,4}):)?(\d{1,2}):(\d{1,2})[.,](\d{1,3})"
_CUE_PATTERN = re.compile(rf"^[ \t]*{_TIME_PATTERN}[ \t]*-->[ \t]*{_TIME_PATTERN}[^\n]*$", re.MULTILINE)
_INNER_TIME = re.compile(rf"<{_TIME_PATTERN}>")  # time of the word after it, inside a cue
_TAG_PATTERN = re.compile(r"<[^<>\n]{0,200}>|\{\\[^{}\n]{0,200}\}|[\u266a\u266b]|^[-\u2013\u2014]+[ \t]*", re.MULTILINE)
_ARROW_PATTERN = re.compile(r"^.*-->.*$", re.MULTILINE)


def read_subtitles(text: str) -> TimedWords:
    """Read cues of subtitles, divided at word times inside them.

    Raises:
        TimingError: the file has no cue, or a time is invalid.
    """
    plain = text.replace("\r\n", "\n").replace("\r", "\n")
    good = {match.start() for match in _CUE_PATTERN.finditer(plain)}
    for arrow in _ARROW_PATTERN.finditer(plain):
        if arrow.start() not in good:
            line = plain.count("\n", 0, arrow.start()) + 1
            wrong = f"line {line}: {shorten(arrow[0])} is no time of a cue"
            raise TimingError(f"{wrong}; write 00:00:01,000 --> 00:00:02,000")
    spans = check_spans(_list_cues(plain))
    if not spans:
        raise TimingError("no cue has text")
    return TimedWords(spans, file_format="WebVTT" if plain.lstrip("\ufeff \n").startswith("WEBVTT") else "SubRip")


def _list_cues(text: str) -> Iterator[RawSpan]:
    cues = list(_CUE_PATTERN.finditer(text))
    for number, match in enumerate(cues, 1):
        following = cues[number].start() if number < len(cues) else len(text)
        body = re.split(r"\n[ \t]*\n", text[match.end() + 1 : following], maxsplit=1)[0]
        place = f"cue {number}"
        begin, end = _seconds(*match.groups()[:4]), _seconds(*match.groups()[4:])
        pieces = _INNER_TIME.split(body)
        starts = [begin, *(_seconds(*pieces[k : k + 4]) for k in range(1, len(pieces), 5))]
        texts = [html.unescape(_TAG_PATTERN.sub("", piece)).strip() for piece in pieces[::5]]
        for k, (start, piece) in enumerate(zip(starts, texts, strict=True)):
            yield RawSpan(place, piece, start, starts[k + 1] if k + 1 < len(starts) else end)


def _seconds(hours: str | None, minutes: str, seconds: str, fraction: str) -> float:
    return 3600.0 * int(hours or 0) + 60.0 * int(minutes) + int(seconds) + int(fraction) / 10.0 ** len(fraction)
