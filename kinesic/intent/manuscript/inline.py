"""Markup within a line: emphasis, stage directions, links, tags, code, emoji."""

import html
import re
import unicodedata

from kinesic.body.pictographs import is_pictograph
from kinesic.intent.manuscript.acts import load_acts
from kinesic.intent.manuscript.addresses import read_address
from kinesic.intent.manuscript.brackets import read_bracket, read_link
from kinesic.intent.manuscript.code import read_code
from kinesic.intent.manuscript.data import read_formula, read_json, read_latex
from kinesic.intent.manuscript.directed_words import (
    begins_phrase,
    direct_words,
    ends_sentence,
    is_interjected,
    is_waiting,
)
from kinesic.intent.manuscript.emoji import read_control, read_emoji, read_short_code
from kinesic.intent.manuscript.emoticons import read_emoticon
from kinesic.intent.manuscript.long_words import cut_long_word
from kinesic.intent.manuscript.pieces import Manuscript, Step, direct, pause
from kinesic.intent.manuscript.tags import read_tag
from kinesic.intent.reading.prosody import VOICE_TAG, write_tag

MAX_STRESS_LENGTH = 400  # [characters] longest emphasised text
MAX_COMMAND_LENGTH = 200  # [characters] longest command of another speech system
_NAOQI_COMMAND = re.compile(r"\^([A-Za-z]+)\(((?:[^()\n]|\([^()\n]*\))*)\)")
_OPEN_NUMBER = re.compile(r"\d[\d/\u2044-]{0,20}")  # number, fraction or range that may go on
_VOICE_TAG = re.compile(r"\\{1,2}([A-Za-z]+)(?:=([^\\\s]*))?\\{1,2}")
_HTML_ENTITY = re.compile(r"&(?:#\d{1,6}|#x[0-9a-fA-F]{1,6}|[A-Za-z]{2,10});")  # `&amp;`, `&#39;`
_SILENT_COMMANDS = frozenset(("wait", "waitTag", "stop", "stopTag"))  # NAOqi commands ignored without a warning
_VOICE_COMMANDS = {"rspd": "rate", "vct": "pitch", "vol": "volume"}  # speech command -> its prosody attribute [%]
_PLAYED_COMMANDS = frozenset(("start", "run", "startTag", "runTag", "startSound", "runSound"))


def read_inline(state: Manuscript, *, ends: bool) -> Step | None:
    """Read the next word or markup, or return None if incomplete."""
    rest, sign = state.rest, state.rest[0]
    address = read_address(state, ends=ends)
    if address is None or address.length:
        return address
    emoticon = read_emoticon(state, ends=ends)
    if emoticon is None or emoticon.length:
        return emoticon
    if sign in "{[$\\":
        data = (read_json if sign in "{[" else read_formula)(rest, ends=ends)
        if data is None or data.length:
            return data
    if sign in "*_":
        return _read_emphasis(state, ends=ends)
    if sign in "([{":
        return read_bracket(state, ends=ends)
    if sign == "!" and rest[1:2] == "[":
        return read_link(rest[1:], 1, ends=ends)
    if sign == "!" and len(rest) == 1 and not ends:
        return None
    if sign == "<":
        return read_tag(rest, ends=ends)
    if sign == ":" and not state.spoken[-1:].isalnum():
        return read_short_code(rest, ends=ends)
    if sign == "~":
        direction = _read_wavy(state, ends=ends)
        if direction is None or direction.length:
            return direction
    if sign in "`~":
        return read_code(state, ends=ends)
    if sign == "^":
        return _read_command(rest, ends=ends)
    if sign == "\\":
        return _read_slashed(rest, state.spoken, ends=ends)
    if sign == "&":
        return _read_entity(rest, ends=ends)
    if is_pictograph(sign):
        return read_emoji(rest, ends=ends)
    if sign in "|#":
        return _read_sign(state, ends=ends)
    if sign == "\x1b" or (sign in "0123456789" and not state.spoken[-1:].isalnum()):
        control = read_control(rest, ends=ends)
        if control is None or control.length:
            return control
    if not ends and _OPEN_NUMBER.fullmatch(rest):
        return None
    return cut_long_word(state) or _read_words(rest)


def _read_emphasis(state: Manuscript, *, ends: bool) -> Step | None:
    """Read emphasis, or a stage direction, in asterisks or underscores."""
    rest, sign = state.rest, state.rest[0]
    count = len(rest) - len(rest.lstrip(sign))
    inside = rest[count:]
    if not inside and not ends:
        return None
    if state.stress == sign * count and not (sign == "_" and inside[:1].isalnum()):
        return Step(count, "</emphasis>", stress="")
    if state.stress or not inside[:1].strip() or (sign == "_" and state.spoken[-1:].isalnum()):
        if state.spoken.rstrip()[-1:].isdigit() and is_waiting(inside, ends=ends):
            return None
        is_operator = sign == "*" and state.spoken.rstrip()[-1:].isdigit() and bool(re.match(r"\s*\d", inside))
        if is_operator or sign == "_":
            return Step(count, "\xd7" if is_operator else " ")
        return Step(count)
    end = _find_run(inside, sign, count, ends=ends)
    if end is None:
        return None
    if end < 0:
        is_operator = state.spoken[-1:].isalnum() and inside[:1].isalnum()
        is_product = is_operator and state.spoken[-1:].isdigit() and inside[:1].isdigit()
        return Step(count, "\xd7" if is_product else " " * is_operator)
    words, after = inside[:end], inside[end + count :]
    if count == 1:
        if is_waiting(after, ends=ends) or (not ends and re.fullmatch(r"[ \t]*\w+", after)):
            return None  # the next word decides
        begins = begins_phrase(state) or is_interjected(state, after)
        if load_acts().is_direction(words, begins=begins, ends=ends_sentence(after)):
            return direct_words(words, end + 2)
    return Step(count, "<emphasis>", stress=sign * count)


def _read_wavy(state: Manuscript, *, ends: bool) -> Step | None:
    """Read a stage direction between single tildes.

    Returns:
        Length 0 without a direction, None if it may be incomplete.
    """
    inside = state.rest[1:]
    if not inside and not ends:
        return None
    if not inside[:1].isalpha() or state.spoken[-1:].isalnum():
        return Step(0)
    end = _find_run(inside, "~", 1, ends=ends)
    after = inside[end + 1 :] if end else ""
    if end is None or (end > 0 and is_waiting(after, ends=ends)):
        return None
    is_direction = end > 0 and load_acts().is_direction(
        inside[:end], begins=begins_phrase(state), ends=ends_sentence(after), is_bracketed=True
    )
    return direct_words(inside[:end], end + 2) if is_direction else Step(0)


def _find_run(text: str, sign: str, count: int, *, ends: bool) -> int | None:
    """Return the index of the signs that close an emphasis or code.

    Returns:
        -1 without closing signs, None if they may follow in text that has not arrived yet.
    """
    for match in re.finditer(re.escape(sign) + "+", text[:MAX_STRESS_LENGTH]):
        if "\n" in text[: match.start()]:
            return -1
        if len(match[0]) == count and match.start() and not text[match.start() - 1].isspace():
            after = text[match.end() : match.end() + 1]
            if not after and not ends:
                return None
            if sign == "*" or not after.isalnum():
                return match.start()
    is_over = ends or "\n" in text or len(text) >= MAX_STRESS_LENGTH
    return -1 if is_over else None


def _read_command(rest: str, *, ends: bool) -> Step | None:
    """Read a command of NAOqi's animated speech, such as `^start(animation)`."""
    match = _NAOQI_COMMAND.match(rest)
    if match is None:
        is_open = re.fullmatch(r"\^([A-Za-z]*|[A-Za-z]+\([^\n]*)", rest) and len(rest) <= MAX_COMMAND_LENGTH
        return None if is_open and not ends else Step(1, " ")
    name, argument = match[1], match[2].split(",")[0].strip()
    if name in _PLAYED_COMMANDS:
        return Step(match.end(), direct(argument.rpartition("/")[2]))
    warning = "" if name in _SILENT_COMMANDS else f"command of another system is not performed: {match[0]}"
    return Step(match.end(), "", warning)


def _read_slashed(rest: str, before: str, *, ends: bool) -> Step | None:
    """Read a LaTeX command, a backslash speech command or an escaped character."""
    latex = read_latex(rest, ends=ends)
    if latex is None or latex.length:
        return latex
    match = _VOICE_TAG.match(rest)
    if match is None:
        if re.fullmatch(r"\\{1,2}([A-Za-z]*(=[^\\\s]*)?)?", rest) and not ends and len(rest) <= MAX_COMMAND_LENGTH:
            return None
        escaped = rest[1:2]
        is_sign = bool(escaped) and escaped in "*_`[]()#+-.!<>|~\\%&$"
        return Step(1 + is_sign, escaped if is_sign and escaped in "().!-[]%&$" else " ")
    if match[2] is None and match[1].lower() != "rst" and (before[-1:].isalnum() or before[-1:] == ":"):
        return Step(1, " ")  # of a file path
    if not ends and match.end() == len(rest):
        return None  # a second sign may follow
    if match[1] == "pau" and (match[2] or "").isdecimal():
        return Step(match.end(), pause(min(int(match[2]) / 1000, 10.0)))
    name, value = match[1].lower(), match[2] or ""
    if name == "rst":
        return Step(match.end(), f"<{VOICE_TAG}/>")
    if name in _VOICE_COMMANDS and re.fullmatch(r"\d{1,3}", value):
        return Step(match.end(), write_tag(VOICE_TAG, {_VOICE_COMMANDS[name]: f"{value}%"}, is_alone=True))
    return Step(match.end(), "", f"command of another system is not performed: {match[0]}")


def _read_entity(rest: str, *, ends: bool) -> Step | None:
    match = _HTML_ENTITY.match(rest)
    if match is None:
        is_open = re.fullmatch(r"&(#?[A-Za-z0-9]{0,9})?", rest)
        return None if is_open and not ends else Step(1, "&")
    text = html.unescape(match[0])
    return Step(match.end(), "" if text == match[0] or text in "*_`^|~#\\\xad" else text.replace("\xa0", " "))


def _read_sign(state: Manuscript, *, ends: bool) -> Step | None:
    sign, after = state.rest[0], state.rest[1:2]
    if sign == "#" and not after and not ends:
        return None
    if sign == "#" and state.spoken[-1:] in ("C", "F") and not state.spoken[-2:-1].isalpha():
        return Step(1, " sharp")
    if sign == "#" and after.isdigit():
        return Step(1, "number ")
    if sign != "|":
        return Step(1)
    if is_waiting(state.rest[1:], ends=ends):
        return None
    following = state.rest[1:].lstrip(" \t")[:1]
    is_between = following.strip() and state.spoken.rstrip(" ")[-1:] not in ("", "\n", ",")
    return Step(1, ", " if is_between else " ")


def _read_words(rest: str) -> Step:
    """Read the next word or punctuation sign of a manuscript line."""
    match = re.match(r"\w+|[^\S\n]+|.", rest, re.DOTALL)
    assert match is not None
    if match[0][0].isalnum():
        plain = re.match(r"[^\W_]+", rest)
        return Step(plain.end() if plain else 1, plain[0] if plain else rest[0])
    if unicodedata.category(rest[0]) in ("Cf", "Cc", "Mn", "Me") and rest[0] in "\u200b\u200d\ufe0e\ufe0f\u20e3\xad":
        return Step(1)
    return Step(match.end(), match[0])
