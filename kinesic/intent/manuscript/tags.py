"""Tags of SSML, HTML and speech systems within a text."""

import html
import re
from collections.abc import Mapping

from kinesic.intent.manuscript.acts import load_acts
from kinesic.intent.manuscript.pieces import LINE_PAUSE, Step, direct, pause
from kinesic.intent.reading.prosody import PROSODY_TAG, write_tag

MAX_TAG_LENGTH = 400  # [characters] longest incomplete tag that waits for its end
BREAK_DURATIONS: Mapping[str, float] = {  # [s] duration of a break by its strength
    "none": 0.0,
    "x-weak": 0.1,
    "weak": 0.2,
    "medium": 0.4,
    "strong": 0.7,
    "x-strong": 1.2,
}
_TAG_PATTERN = re.compile(r"<(/?)([A-Za-z][\w:.-]*)((?:\s[^<>]*)?)(/?)>")
_ATTRIBUTE_PATTERN = re.compile(r"([\w:-]+)\s*=\s*(?:\"([^\"]*)\"|'([^']*)')")
_AUTOLINK_PATTERN = re.compile(r"<(?:https?|ftp|mailto):[^<>\s]*>", re.IGNORECASE)
_MAIL_LINK = re.compile(r"<([\w.+-]{1,64}@[A-Za-z0-9.-]{3,120})>")
_CUT_TAG = re.compile(
    r"</[A-Za-z][^<>\n]*|<[A-Za-z][\w.-]*(?::[^<>\n]*|\s+[\w:-]+\s*=[^<>\n]*)"
)  # incomplete tag: a closing one, or one with a prefix or an attribute
_FUNCTION_TAG = re.compile(r"<function=[\w.-]{1,80}>")  # call of a function by a language model
_CALL_TOKEN = re.compile(r"<\|(?:tool|function)_calls?(_begin)?\|>")
_NUMBERED_PATTERN = re.compile(r"[-_.]?\d+$")


def read_tag(rest: str, *, ends: bool) -> Step | None:
    """Read a tag or a literal `<`, or return None if incomplete."""
    for opening, closing in (("<!--", "-->"), ("<![CDATA[", ""), ("<?", "?>"), ("<!", ">")):
        if rest.startswith(opening):
            return Step(len(opening), "", mode="skipped", closing=closing) if closing else Step(len(opening))
        if not ends and len(rest) < len(opening) and opening.startswith(rest):
            return None
    if rest.startswith("<|"):
        return _read_token(rest, ends=ends)
    call = _FUNCTION_TAG.match(rest)
    if call:
        return Step(call.end(), " ", "a function call is not spoken", mode="skipped", closing="</function>")
    mail = _MAIL_LINK.match(rest)
    if mail:
        return Step(mail.end(), mail[1])
    address = _AUTOLINK_PATTERN.match(rest)
    if address:
        return Step(address.end(), " ", f"an address is not spoken: {address[0][1:-1]}")
    end = rest.find(">")
    if end < 0 or "<" in rest[1:end]:
        is_open = re.fullmatch(r"</?([A-Za-z][^<>]*)?", rest) and len(rest) <= MAX_TAG_LENGTH
        if is_open and ends and _CUT_TAG.fullmatch(rest):
            return Step(len(rest), "", f"a tag without its end is not spoken: {rest}")
        return None if is_open and not ends else Step(1, "<")
    match = _TAG_PATTERN.match(rest[: end + 1])
    if match is None:
        words = rest[1:end]
        is_words = re.fullmatch(r"[A-Za-z][\w' ,.-]*", words)
        return Step(end + 1, direct(words)) if is_words else Step(1, "<")
    attributes = {
        name.lower(): html.unescape(one or other) for name, one, other in _ATTRIBUTE_PATTERN.findall(match[3])
    }
    is_alone = bool(match[4]) or match[3].rstrip().endswith("/")
    return _read_element(match[2], attributes, match.end(), is_end=bool(match[1]), is_alone=is_alone)


def _read_token(rest: str, *, ends: bool) -> Step | None:
    """Skip a special token such as <|im_start|>, with its role."""
    call = _CALL_TOKEN.match(rest)
    if call:
        name = call[0][2:-2]
        closing = f"<|{name.removesuffix('_begin')}_end|>" if call[1] else f"<|/{name}|>"
        return Step(call.end(), " ", "a function call is not spoken", mode="skipped", closing=closing)
    token = re.match(r"<\|[^|<>\n]*\|>(?:(?:assistant|user|system)(?:\n|(?=<\|)))?", rest)
    is_open = re.fullmatch(r"<\|[^|<>\n]{0,40}(?:\|(?:>[a-z]{0,9}<?)?)?", rest)
    return None if is_open and not ends else Step(token.end() if token else 1)


def _read_element(name: str, attributes: Mapping[str, str], length: int, *, is_end: bool, is_alone: bool) -> Step:
    lowered, acts = name.lower(), load_acts()
    if acts.has("thought_tags", lowered) or acts.has("hidden_tags", lowered):
        is_thought = acts.has("thought_tags", lowered)
        if is_end or is_alone:
            return Step(length, " ")
        warning = "" if is_thought else f"content of <{name}> is not spoken"
        return Step(length, " ", warning, mode="thought" if is_thought else "skipped", closing=f"</{name}>")
    if lowered == "break":
        return Step(length, pause(_break_duration(attributes)) if not is_end else "")
    if acts.has("stress_tags", lowered):
        is_weak = attributes.get("level") in ("none", "reduced")
        return Step(length, "" if is_weak else "</emphasis>" if is_end else "<emphasis>")
    if acts.has("line_tags", lowered):
        return Step(length, "\n" if lowered != "s" or is_end else " ")
    if lowered in ("bookmark", "mark") and is_alone:
        return _read_mark(attributes.get("mark", attributes.get("name", "")), length, is_bookmark=lowered == "bookmark")
    if lowered == "sub" and attributes.get("alias") and not is_end:
        alias = re.sub(r"[<>*_`^|~#\\&]", " ", attributes["alias"])
        return Step(length, alias, mode="skipped", closing=f"</{name}>")
    if lowered == "say-as" and attributes.get("interpret-as") in ("characters", "spell-out", "verbatim"):
        return Step(length, "", mode="text")
    if lowered in ("td", "th"):
        return Step(length, ", " if is_end else "")
    if lowered == "img":
        return Step(length, " ", f"a picture is not shown: {attributes.get('alt', 'without description')}")
    if acts.has("spoken_tags", lowered) or lowered == "kinesic:act":
        return Step(length, direct(attributes["words"]) if "words" in attributes else "")
    if lowered == "prosody":
        opening = "" if is_end or is_alone else write_tag(PROSODY_TAG, attributes) or f"<{PROSODY_TAG}>"
        is_empty = opening == f"<{PROSODY_TAG}>"
        warning = f"<{name}> has no rate, pitch or volume that the voice knows" if is_empty else ""
        return Step(length, f"</{PROSODY_TAG}>" if is_end else opening, warning)
    if acts.has("voice_tags", lowered) or ":" in lowered:
        return Step(length, "", "" if is_end else f"<{name}> is not performed, its words are spoken")
    if is_end:
        return Step(length, " ")
    return Step(length, direct(name.replace("_", " ").replace("-", " ")))


def _read_mark(name: str, length: int, *, is_bookmark: bool) -> Step:
    """Read a mark tag as a stage direction, or warn."""
    words = (
        _NUMBERED_PATTERN.sub("", name.removeprefix("gesture.").removeprefix("gesture:"))
        .replace("-", " ")
        .replace("_", " ")
    )
    if is_bookmark or name.startswith("gesture") or load_acts().find(words) is not None:
        return Step(length, direct(words))
    return Step(length, "", f"nothing happens at the mark {name}")


def _break_duration(attributes: Mapping[str, str]) -> float:
    time = re.fullmatch(r"\+?(\d+(?:\.\d*)?|\.\d+)\s*(ms|s)", attributes.get("time", "").strip())
    if time:
        return min(float(time[1]) / (1000 if time[2] == "ms" else 1), 10.0)
    return BREAK_DURATIONS.get(attributes.get("strength", "medium"), LINE_PAUSE)
