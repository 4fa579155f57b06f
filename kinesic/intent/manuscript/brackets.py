"""Stage directions, requests and links in brackets."""

import re

from kinesic.intent.manuscript.acts import load_acts
from kinesic.intent.manuscript.addresses import WEB_ADDRESS
from kinesic.intent.manuscript.directed_words import begins_phrase, direct_words, ends_sentence, is_waiting
from kinesic.intent.manuscript.pieces import Manuscript, Step, pause

MAX_BRACKET_LENGTH = 120  # [characters] longest text in brackets or asterisks that may be a stage direction
MAX_LINK_LENGTH = 2000  # [characters] longest web address of a link
CLOSING_BRACKETS = {"(": ")", "[": "]", "{": "}"}  # opening bracket -> closing bracket
_TIMESTAMP_PATTERN = re.compile(r"\d{1,2}:\d{2}(?::\d{2})?(?:[.,]\d{1,3})?")  # time stamp of a transcript line
# Request in square brackets, such as `[emotion: happy]`.
_REQUEST_PATTERN = re.compile(
    r"\s*(?:emotion|mood|feeling|expression|face|gesture|action|animation|pose|motion|tone|voice|sound|pause)\s*[:=]\s*(.+)",
    re.IGNORECASE,
)
_SECONDS_PATTERN = re.compile(r"\s*(\d{1,5}(?:\.\d+)?)\s*(ms|s|sec|seconds?)?\s*")
_PROMPT_MARKS = frozenset(
    ("INST", "/INST", "TOOL_CALLS", "AVAILABLE_TOOLS", "/AVAILABLE_TOOLS")
)  # bracketed marks of prompts for language models


def read_bracket(state: Manuscript, *, ends: bool) -> Step | None:
    """Read a stage direction, label or link in brackets, or one bracket."""
    rest, sign = state.rest, state.rest[0]
    line, newline, _ = rest[1 : MAX_BRACKET_LENGTH + 1].partition("\n")
    end = line.find(CLOSING_BRACKETS[sign])
    if end < 0:
        is_over = ends or newline or len(rest) > MAX_BRACKET_LENGTH
        return Step(1, sign) if is_over else None
    if sign == "[":
        after = rest[end + 2 : end + 3]
        if not after and not ends:
            return None
        if after in ("(", "[") and after:
            return read_link(rest, 0, ends=ends)
    words, after = line[:end], rest[end + 2 :]
    if is_waiting(after, ends=ends):
        return None
    if load_acts().is_direction(words, begins=begins_phrase(state), ends=ends_sentence(after), is_bracketed=True):
        return direct_words(words, end + 2)
    request = _REQUEST_PATTERN.fullmatch(words) if sign == "[" else None
    if request or (sign == "[" and load_acts().has("moods", words.strip().lower())):
        seconds = _SECONDS_PATTERN.fullmatch(request[1]) if request else None
        if seconds:
            return Step(end + 2, pause(min(float(seconds[1]) / (1000 if seconds[2] == "ms" else 1), 10.0)))
        return direct_words(request[1] if request else words, end + 2)
    is_label = state.is_line_start and words.isupper() and words.isalpha() and len(words) > 1
    if sign == "[" and is_label and ends_sentence(after):
        return Step(end + 2, " ", f"a label is not spoken: {words}")
    is_time = state.is_line_start and _TIMESTAMP_PATTERN.fullmatch(words)
    if sign == "[" and (is_time or words in _PROMPT_MARKS):
        return Step(end + 2)
    if sign == "[" and words.startswith("^"):  # a footnote
        return Step(end + 2 + after.startswith(":"))
    return Step(1, sign)


def read_link(rest: str, begin: int, *, ends: bool) -> Step | None:
    """Read a Markdown link or picture from its opening bracket."""
    match = re.match(r"\[([^\]\n]*)\]", rest)
    if match is None:
        is_over = ends or "\n" in rest or "]" in rest or len(rest) > MAX_BRACKET_LENGTH
        return Step(1 + begin, "!" * begin if begin else "[") if is_over else None
    opening = rest[match.end() : match.end() + 1]
    if not opening and not ends:
        return None
    if opening not in ("(", "["):
        return Step(begin, "!") if begin else Step(1, "[")
    end, closing = match.end() + 1, {"(": ")", "[": "]"}[opening]
    depth = 1
    while depth and end < len(rest) and end - match.end() < MAX_LINK_LENGTH and rest[end] != "\n":
        depth += (rest[end] == opening) - (rest[end] == closing)
        end += 1
    if depth:
        is_over = ends or end < len(rest)
        return Step(begin + 1, "" if begin else "[") if is_over else None
    text = re.sub(r"[<>*_`^|~#\\&]", " ", match[1])
    if begin:
        return Step(end + 1, " ", f"a picture is not shown: {match[1].strip() or 'without description'}")
    is_address = WEB_ADDRESS.match(match[1])
    return Step(end, "" if is_address else text)
