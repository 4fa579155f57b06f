"""Decoding of text files in several encodings, and of subtitles."""

import codecs
import html
import re
from collections.abc import Sequence

from kinesic.intent.manuscript.pieces import pause

MIN_CUE_PAUSE = 0.3  # [s] shortest silence between subtitle cues that is kept
MAX_CUE_PAUSE = 10.0  # [s] longest silence between subtitle cues; longer ones are shortened
SILENT_BLOCKS = ("WEBVTT", "NOTE", "STYLE", "REGION")  # first words of the blocks of WebVTT that are not spoken
SPEAKER_DASHES = "-\u2013\u2014"  # signs before the line of another speaker
NUL_FRACTION = 0.2  # fraction of zero bytes above which a text without byte order mark is UTF-16
_BYTE_ORDER_MARKS = (  # byte order marks; UTF-32 before UTF-16, whose mark begins it
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_SUBTITLE_TIMES = re.compile(
    r"(?:(\d+):)?(\d{1,2}):(\d{2})[.,](\d{3})\s*-->\s*(?:(\d+):)?(\d{1,2}):(\d{2})[.,](\d{3})[^\n]*"
)
_TIMED_LINE = re.compile(rf"^\s*{_SUBTITLE_TIMES.pattern}", re.MULTILINE)
_CUE_SIGN = re.compile(r"[\u266a\u266b#]+(?=\s|\Z)|^[-\u2013\u2014]+[ \t]*", re.MULTILINE)  # song, change of speaker
_CUE_TAG = re.compile(r"</?(?:v|c|i|b|u|lang|ruby|rt|font)(?:[ .][^<>]*)?>|<\d[\d:.]*>|\{\\[^{}]*\}")


def decode_text(content: bytes) -> tuple[str, tuple[str, ...]]:
    """Decode a text file.

    Returns:
        Text, and a warning if its encoding is only a guess.
    """
    for mark, encoding in _BYTE_ORDER_MARKS:
        if content.startswith(mark):
            return content.decode(encoding, "replace"), ()
    if content.count(0) > NUL_FRACTION * len(content):
        encoding = "utf-16-le" if content[1::2].count(0) > content[::2].count(0) else "utf-16-be"
        return content.decode(encoding, "replace"), (f"the text has no byte order mark: it is read as {encoding}",)
    try:
        return content.decode("utf-8"), ()
    except UnicodeDecodeError as error:
        where = f"byte {error.start} is not UTF-8"
    try:
        return content.decode("cp1252"), (f"{where}: the text is read as cp1252 (Windows, Western Europe)",)
    except UnicodeDecodeError:
        return content.decode("latin-1"), (f"{where}: the text is read as Latin-1",)


def read_text_file(content: bytes) -> tuple[str, tuple[str, ...]]:
    """Decode a text file, and extract the spoken text of subtitles.

    Returns:
        Text and warnings, as of `decode_text`.
    """
    text, warnings = decode_text(content)
    return read_subtitles(text) if is_subtitles(text) else text, warnings


def is_subtitles(text: str) -> bool:
    """Return whether a text contains subtitles (SubRip or WebVTT)."""
    return text.lstrip("\ufeff \n\r\t").startswith("WEBVTT") or _TIMED_LINE.search(text) is not None


def read_subtitles(text: str) -> str:
    """Return the spoken text of subtitles, with pauses between the cues.

    Text before, between and after the cues is kept.
    """
    parts, last_end = list[str](), None
    for block in re.split(r"\n[ \t]*\n", text.replace("\r\n", "\n").replace("\r", "\n")):
        times = _SUBTITLE_TIMES.search(block)
        if times is None:
            is_silent = block.lstrip("\ufeff \n").startswith(SILENT_BLOCKS) or block.strip().isdecimal()
            parts += [] if is_silent else [block]
            continue
        introduction = "\n".join(block[: times.start()].splitlines()[:-1])  # without the number of the cue
        if introduction.strip():
            parts.append(introduction)
        start, end = _seconds(times.groups()[:4]), _seconds(times.groups()[4:])
        said = html.unescape(_CUE_TAG.sub("", block[times.end() :])).strip()
        words = _join_lines(said.splitlines())
        gap = 0.0 if last_end is None else min(start - last_end, MAX_CUE_PAUSE)
        if words:
            parts.append((pause(gap) if gap >= MIN_CUE_PAUSE else "") + words)
            last_end = end
    return "\n".join(parts)


def _join_lines(lines: Sequence[str]) -> str:
    """Join the lines of a subtitle cue, but not those of other speakers.

    A dash begins the line of another speaker.
    """
    joined = ""
    for line in lines:
        words = _CUE_SIGN.sub("", line).strip()
        is_reply = words and joined and line.lstrip()[:1] in SPEAKER_DASHES
        joined += ("\n" if is_reply else " ") + words
    return joined.strip()


def _seconds(parts: tuple[str | None, ...]) -> float:
    hours, minutes, seconds, milliseconds = (float(part or 0.0) for part in parts)
    return 3600.0 * hours + 60.0 * minutes + seconds + milliseconds / 1000.0
