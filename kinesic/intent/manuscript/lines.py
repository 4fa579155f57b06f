"""Markup and pauses at the beginning and end of lines."""

import re

from kinesic.intent.manuscript.acts import load_acts
from kinesic.intent.manuscript.pieces import (
    END_OF_SENTENCE,
    LINE_PAUSE,
    PARAGRAPH_PAUSE,
    Manuscript,
    Step,
    direct,
    pause,
)

MAX_LABEL_WORDS = 3  # largest number of words in a speaker's name
MAX_LABEL_LENGTH = 40  # [characters] longest name of a speaker
MAX_SKIPPED_LENGTH = 2000  # [characters] length from which another speaker's line is skipped before its end arrives
MIN_WRAPPED_LENGTH = 55  # [characters] shortest line that counts as wrapped text; its end causes no pause
# Markdown marker of a heading, list item or quotation at the start of a line.
_MARKER_PATTERN = re.compile(r"[ \t]*(?:#{1,6}[ \t]+|[-+\u2022\u2023\u25e6*][ \t]+|\d{1,3}[.)][ \t]+|(?:>[ \t]?)+)")
_TASK_PATTERN = re.compile(r"\[[ xX]\][ \t]+")
MIN_RULE_LENGTH = 3  # smallest number of signs in a horizontal rule, or below the head of a table
FRONT_MATTER_SIGN = "---"  # line before and after the settings of a document
_SETTING_PATTERN = re.compile(r"\w[\w-]*:(?:[ \t]|$)")
_OPEN_SETTING = re.compile(r"[\w-]*:?")
_FENCE_PATTERN = re.compile(r"[ \t]*(`{3,}|~{3,})([^\n`~]*)")
_TILDE_FENCE = re.compile(r"~{3,4}[ \t]*")  # opens a code block; longer lines of tildes are horizontal rules
# Markdown definition of the address of a link: `[name]: address`.
_REFERENCE_PATTERN = re.compile(r"[ \t]*\[[^\]\n]+\]:[ \t]*(?:<[^>\n]*>|\S*[/#]\S*)(?:[ \t]+[\"'(][^\n]*)?[ \t]*")
_LABEL_PATTERN = re.compile(r"(\*\*|__|\[(?=[^\]:\n]*\]))?([^\W\d_][\w .'\u2019()-]*?)(\*\*|__|\])?:(\*\*|__)?[ \t]+")
_OPEN_LABEL = re.compile(r"(\*\*|\*|__|_|\[)?([^\W\d_][\w .'\u2019()-]*)?(\*\*|\*|__|_|\])?:?(\*\*|\*|__|_)?[ \t]*")
_REMARK_PATTERN = re.compile(r"[^\W\d_]+ \(([^()]*)\)")
_OPEN_REMARK = re.compile(r"[^\W\d_]+(?: (?:\((?:[^()]*(?:\):?[ \t]*)?)?)?)?")  # name with a remark that may follow


def read_line_start(state: Manuscript, *, ends: bool) -> Step | None:
    """Read the Markdown or speaker marker at the start of a line.

    Returns:
        Length 0 without a marker, None if the marker may be incomplete.
    """
    line, newline, _ = state.rest.partition("\n")
    is_whole = bool(newline) or ends
    head = line.lstrip(" \t")
    if not head:
        return Step(len(line)) if is_whole else None
    if line == FRONT_MATTER_SIGN and not state.spoken.strip():
        matter = _read_front_matter(state.rest, ends=ends)
        if matter is None or matter.length:
            return matter
    if head[0] in "-*_=~+|:" and re.fullmatch(r"[-*_=~+|:\s]*", line) and not _TILDE_FENCE.fullmatch(head):
        if not is_whole:
            return None
        if len("".join(line.split())) >= MIN_RULE_LENGTH:
            return Step(len(line), is_block=True)
    if head[0] in "`~" and not is_whole and re.fullmatch(r"[`~]+[^\n`~]*", head):
        return None
    fence = _FENCE_PATTERN.fullmatch(line)
    if fence:
        warning = f"code is not spoken{f': {fence[2].strip()}' if fence[2].strip() else ''}"
        return Step(len(line), "", warning, mode="code", closing=fence[1], is_block=True)
    if head[0] == "[" and re.match(r"\[[^\]\n]*(\](:.*)?)?$", head):
        if not is_whole:
            return None
        if _REFERENCE_PATTERN.fullmatch(line):
            return Step(len(line))
    if head[0] == "|":
        return Step(len(line) - len(head) + 1, is_block=True)
    return _read_marker(state, line, is_whole=is_whole)


def _read_front_matter(rest: str, *, ends: bool) -> Step | None:
    """Skip the settings (YAML) before the text of a document.

    Returns:
        Length 0 without settings, None if the second line may be incomplete.
    """
    second, newline, _ = rest[len(FRONT_MATTER_SIGN) + 1 :].partition("\n")
    if _SETTING_PATTERN.match(second):
        length = len(FRONT_MATTER_SIGN)
        return Step(length, "", "settings before the text are not spoken", mode="skipped", closing=f"\n{rest[:length]}")
    return Step(0) if newline or ends or not _OPEN_SETTING.fullmatch(second) else None


def _read_marker(state: Manuscript, line: str, *, is_whole: bool) -> Step | None:
    marker = _MARKER_PATTERN.match(line)
    if marker is None and not is_whole and re.fullmatch(r"[ \t]*(#{1,6}|[-+\u2022*]|\d{1,3}[.)]?|[> ]+)?", line):
        return None
    if marker:
        length = marker.end()
        if line[length:] == "" and not is_whole:
            return None
        task = _TASK_PATTERN.match(line, length)
        if task is None and not is_whole and re.fullmatch(r"\[([ xX](\][ \t]*)?)?", line[length:]):
            return None
        return Step(task.end() if task else length, is_block=line.lstrip()[0] != ">")
    indent = len(line) - len(line.lstrip(" \t"))
    label = _LABEL_PATTERN.match(line, indent)
    if label and len(label[2]) <= MAX_LABEL_LENGTH and _is_speaker(label[2], state):
        name = _upper(label[2])
        if not state.character or name == state.character:
            remark = _read_remark(label[2])
            return Step(label.end(), direct(remark) if remark else "", is_block=False)
        warning = f"lines of {name} are not spoken: this robot is {state.character}"
        return Step(label.end(), "", warning * (name not in state.others), mode="other", other=name)
    is_open = len(line) - indent <= MAX_LABEL_LENGTH and _OPEN_LABEL.fullmatch(line, indent)
    return None if is_open and not is_whole and _may_be_speaker(line[indent:], state) else Step(indent)


def _may_be_speaker(text: str, state: Manuscript) -> bool:
    """Return whether the beginning of a line may become a speaker's name."""
    if _OPEN_REMARK.fullmatch(text):
        return True
    words = re.sub(r"\(.*", "", text).strip("*_[: \t").split()
    if not words or all(word.upper() == word for word in words):
        return len(words) <= MAX_LABEL_WORDS
    names = (
        *load_acts().classes["roles"],
        *(name.lower() for name in (*state.speakers, *state.others, state.character)),
    )
    name = " ".join(words).lower()
    is_role = load_acts().has("roles", words[0].lower()) and len(words) < MAX_LABEL_WORDS
    return is_role or any(each.startswith(name) for each in names)


def _is_speaker(name: str, state: Manuscript) -> bool:
    words = re.sub(r"\(.*?\)", "", name).split()
    if not 1 <= len(words) <= MAX_LABEL_WORDS:
        return False
    is_loud = all(word.upper() == word for word in words) and (len(name) > 1 or name in "QA")
    is_loud = is_loud and not load_acts().has("headings", words[0].lower())
    is_role = load_acts().has("roles", words[0].lower()) and (
        len(words) == 1 or (words[-1].isalnum() and len(words[-1]) <= 2)
    )
    return (
        is_loud
        or bool(_read_remark(name))
        or (is_role and name != "a")
        or _upper(name) in {*state.speakers, *state.others, state.character}
    )


def _read_remark(name: str) -> str:
    """Return the stage direction in `Robin (laughing)`, or an empty text."""
    remark = _REMARK_PATTERN.fullmatch(name)
    is_act = remark and load_acts().is_direction(remark[1], begins=True, ends=True, is_bracketed=True)
    return remark[1] if remark and is_act else ""


def _upper(name: str) -> str:
    """Return a speaker's name in capitals, without remarks in brackets."""
    return " ".join(re.sub(r"\(.*?\)", "", name).split()).upper()


def skip_other_speaker(state: Manuscript, *, ends: bool) -> Step | None:
    """Skip another speaker's line, or read the label of the played character."""
    line, newline, _ = state.rest.partition("\n")
    if not newline and not ends and len(line) < MAX_SKIPPED_LENGTH:
        return None
    label = _LABEL_PATTERN.match(line, len(line) - len(line.lstrip(" \t")))
    if label and _upper(label[2]) == state.character:
        return Step(label.end())
    if label and _upper(label[2]) not in state.others and _is_speaker(label[2], state):
        name = _upper(label[2])
        warning = f"lines of {name} are not spoken: this robot is {state.character}"
        return Step(label.end(), "", warning, mode="other", other=name)
    return Step(len(line) + len(newline), mode="other")


def find_speakers(text: str) -> frozenset[str]:
    """Return the speakers' names of a dialogue, in capitals.

    A text is a dialogue if every line begins with a name and there are at least two names. Otherwise the result is
    empty.
    """
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    labels = [_LABEL_PATTERN.match(line) for line in lines]
    names = [" ".join(label[2].split()).upper() for label in labels if label and len(label[2].split()) <= 3]
    is_dialogue = len(lines) > 1 and len(names) == len(lines) and len({*names}) > 1
    return frozenset(names) if is_dialogue else frozenset()


def end_line(state: Manuscript, *, ends: bool) -> Step | None:
    """Read the end of a line with all empty lines after it."""
    match = re.match(r"\s+", state.rest)
    assert match is not None  # the rest begins with a line end
    following = state.rest[match.end() : match.end() + 1]
    if not following and not ends:
        return None
    if not following or not state.spoken.strip() or state.spoken.rstrip(" \t").endswith("\n"):
        return Step(match.end(), "\n" if following else "")
    last = state.spoken.rstrip(" \t\"')\u201d\u2019*>")[-1:]
    is_paragraph = match[0].count("\n") > 1
    ends_sentence = last in END_OF_SENTENCE or last in ",;:\u2014-"
    if is_paragraph or state.is_block:
        seconds = PARAGRAPH_PAUSE if is_paragraph else LINE_PAUSE
        return Step(match.end(), ("" if ends_sentence else ".") + pause(seconds) + "\n")
    if ends_sentence:
        return Step(match.end(), "\n")
    if state.line_length >= MIN_WRAPPED_LENGTH:
        return Step(match.end(), "\n")
    is_new = not following.islower()
    return Step(match.end(), ("." if is_new else ",") + pause(LINE_PAUSE) + "\n")
