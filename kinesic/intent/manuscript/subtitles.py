"""Incremental reader of subtitles (SubRip, WebVTT) inside a text.

Its result does not depend on where the text is cut. Text without subtitles passes unchanged and almost without delay.
"""

import html
import re
from dataclasses import replace

from kinesic.intent.manuscript.pieces import SubtitleState, pause

MIN_CUE_PAUSE = 0.3  # [s] shortest silence between subtitle cues that is kept
MAX_CUE_PAUSE = 10.0  # [s] longest silence between subtitle cues; longer silences are shortened to this
MAX_CUE_LINE = 1000  # [characters] longest line of a cue; longer lines are plain text
HEADER_SIGN = "WEBVTT"  # first word of a WebVTT file
SILENT_BLOCKS = ("NOTE", "STYLE", "REGION")  # first words of the blocks of WebVTT that are not spoken
SPEAKER_DASHES = "-\u2013\u2014"  # signs before the line of another speaker
CODE_FENCES = ("```", "~~~")  # Markdown signs that begin or end a code block

_TIME_PATTERN = r"(?:(\d+):)?(\d{1,2}):(\d{2})[.,](\d{3})"
_CUE_TIMES = re.compile(rf"[ \t]*{_TIME_PATTERN}[ \t]*-->[ \t]*{_TIME_PATTERN}(?:[ \t].*)?")
_OPEN_TIMES = re.compile(r"[ \t]*(?:\d[\d:.,]*[ \t]*(?:-{1,2}|-->[ \t\d:.,]*|-->[ \t]*\d[\d:.,]*[ \t].*)?)?")
_CUE_NUMBER = re.compile(r"[ \t]*\d+[ \t]*")
_CUE_SIGN = re.compile(r"[\u266a\u266b#]+(?=\s|\Z)|^[-\u2013\u2014]+[ \t]*")  # signs of songs and changes of speaker
_CUE_TAG = re.compile(r"</?(?:v|c|i|b|u|lang|ruby|rt|font)(?:[ .][^<>]*)?>|<\d[\d:.]*>|\{\\[^{}]*\}")


def read_subtitles(text: str) -> str:
    """Return the spoken text of subtitles, with pauses between the cues.

    Text before, between and after the cues is kept.
    """
    return read_more_subtitles(SubtitleState(), text, ends=True)[1]


def read_more_subtitles(state: SubtitleState, text: str, *, ends: bool = False) -> tuple[SubtitleState, str]:
    """Convert the next part of a text with subtitles to spoken text.

    Args:
        state: after the text before it.
        text: part, cut anywhere.
        ends: whether the text ends with it.

    Returns:
        State and spoken text, with tags for pauses.
    """
    received = state.rest + text
    held = "\r" if received.endswith("\r") and not ends else ""  # may be the first half of a line end
    received = received.removesuffix(held).replace("\r\n", "\n").replace("\r", "\n")
    spoken, begin = list[str](), 0
    while begin < len(received):
        step = _read_line(state, received, begin, ends=ends)
        if step is None:
            break
        state, words, begin = step
        spoken.append(words)
    return replace(state, rest=received[begin:] + held), "".join(spoken)


def _read_line(state: SubtitleState, text: str, begin: int, *, ends: bool) -> tuple[SubtitleState, str, int] | None:
    """Read a subtitle line, or the rest of one, from an index.

    Returns:
        State, spoken text and index of the next line; None if the line may be incomplete.
    """
    end = text.find("\n", begin)
    is_whole = end >= 0 or ends
    stop = end + 1 if end >= 0 else len(text)
    line = text[begin : end if end >= 0 else stop]
    if not state.is_line_start or len(line) > MAX_CUE_LINE:
        return _pass_text(state, text[begin:stop], stop)
    if not is_whole:
        return None if _may_be_cue(state, line) else _pass_text(state, line, stop)
    times = _CUE_TIMES.fullmatch(line)
    if times:
        return _begin_cue(state, times), "", stop
    if _may_be_identifier(state, line) and end >= 0:
        following = text[stop:].partition("\n")
        if not (following[1] or ends) and _OPEN_TIMES.fullmatch(following[0]) and len(following[0]) <= MAX_CUE_LINE:
            return None
        if len(following[0]) <= MAX_CUE_LINE and _CUE_TIMES.fullmatch(following[0]):
            return state, "", stop
    if state.place == "silent":
        return replace(state, place="silent" if line.strip() else "text", is_block_start=not line.strip()), "", stop
    if state.place == "cue" and not line.lstrip().startswith(CODE_FENCES):
        return *_read_cue_line(state, line), stop
    if _is_silent_block(state, line, is_closed=end >= 0):
        is_webvtt = state.is_webvtt or line.startswith(HEADER_SIGN)
        return replace(state, place="silent", is_start=False, is_webvtt=is_webvtt), "", stop
    return _pass_text(state, text[begin:stop], stop)


def _pass_text(state: SubtitleState, text: str, stop: int) -> tuple[SubtitleState, str, int]:
    """Pass on all or part of a line outside of subtitles.

    An empty line that follows a cue is dropped.
    """
    is_empty = state.is_line_start and not text.strip()
    if state.is_line_open and is_empty and text.endswith("\n"):  # between a cue and the next text
        return replace(state, place="text", is_block_start=True), "", stop
    passed = replace(
        state,
        place="text",
        is_start=state.is_start and is_empty,
        is_line_start=text.endswith("\n"),
        is_block_start=is_empty,
        is_line_open=False,
    )
    return passed, "\n" * state.is_line_open + text, stop


def _may_be_cue(state: SubtitleState, line: str) -> bool:
    """Return whether an incomplete line may belong to a subtitle."""
    if state.place != "text" or (state.is_webvtt and state.is_block_start):
        return True
    is_header = state.is_start and (HEADER_SIGN.startswith(line) or line.startswith(HEADER_SIGN))
    return is_header or bool(_OPEN_TIMES.fullmatch(line))


def _may_be_identifier(state: SubtitleState, line: str) -> bool:
    """Return whether a line may be the identifier of a cue."""
    is_name = state.is_webvtt and state.is_block_start and state.place == "text" and bool(line.strip())
    return is_name or bool(_CUE_NUMBER.fullmatch(line))


def _is_silent_block(state: SubtitleState, line: str, *, is_closed: bool) -> bool:
    """Return whether a line begins an unspoken block of WebVTT."""
    first = line.partition(" ")[0].partition("\t")[0]
    if state.is_start and first == HEADER_SIGN:
        return is_closed or line.strip() == HEADER_SIGN
    return state.is_webvtt and state.is_block_start and first in SILENT_BLOCKS


def _begin_cue(state: SubtitleState, times: re.Match[str]) -> SubtitleState:
    start, end = _seconds(times.groups()[:4]), _seconds(times.groups()[4:])
    gap = 0.0 if state.last_end is None else min(start - state.last_end, MAX_CUE_PAUSE)
    return replace(state, place="cue", is_start=False, is_block_start=False, has_words=False, pause=gap, end=end)


def _read_cue_line(state: SubtitleState, line: str) -> tuple[SubtitleState, str]:
    """Return state and spoken words of one line of a cue.

    A dash begins the line of another speaker.
    """
    if not line.strip():
        return replace(state, place="text", is_block_start=True), ""
    plain = html.unescape(_CUE_TAG.sub("", line)).strip()
    words = _CUE_SIGN.sub("", plain).strip()
    if not words:
        return state, ""
    if state.has_words:
        return state, ("\n" if plain[0] in SPEAKER_DASHES else " ") + words
    silence = pause(state.pause) if state.pause >= MIN_CUE_PAUSE else ""
    spoken = "\n" * state.is_line_open + silence + words
    return replace(state, has_words=True, is_line_open=True, last_end=state.end), spoken


def _seconds(parts: tuple[str | None, ...]) -> float:
    hours, minutes, seconds, milliseconds = (float(part or 0.0) for part in parts)
    return 3600.0 * hours + 60.0 * minutes + seconds + milliseconds / 1000.0
