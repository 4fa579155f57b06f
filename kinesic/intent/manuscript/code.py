"""Code within a line, between backticks or tildes."""

import re

from kinesic.intent.manuscript.pieces import Manuscript, Step

MAX_CODE_LENGTH = 400  # [characters] longest code within a line
FENCE_LENGTH = 3  # smallest number of signs that enclose a code block
_LANGUAGE_NAME = re.compile(r"[\w+#.-]*[ \t]*")  # name of a programming language after the opening signs


def read_code(state: Manuscript, *, ends: bool) -> Step | None:
    """Read code between backticks, or between three or more tildes.

    A single word is spoken. A run before the end of a line opens a code block. Other tildes are not spoken.

    Returns:
        None if the code may be incomplete.
    """
    sign = state.rest[0]
    inside = state.rest.lstrip(sign)
    count = len(state.rest) - len(inside)
    if not inside and not ends:
        return None
    is_decoration = count < FENCE_LENGTH or not inside[:1].strip() or state.spoken[-1:].isalnum()
    if sign == "~" and is_decoration:
        return Step(count)
    line, newline, _ = inside[:MAX_CODE_LENGTH].partition("\n")
    for match in re.finditer(re.escape(sign) + "+", line):
        if len(match[0]) != count or (count < FENCE_LENGTH and line[match.start() - 1].isspace()):
            continue
        after = inside[match.end() : match.end() + 1]
        if not after and not ends:
            return None
        if not after.isalnum():
            return _skip(line[: match.start()], count + match.end())
    if not (ends or newline or len(inside) >= MAX_CODE_LENGTH):
        return None
    if newline and count >= FENCE_LENGTH and _LANGUAGE_NAME.fullmatch(line):
        warning = f"code is not spoken: {line.strip()}" if line.strip() else "code is not spoken"
        return Step(count + len(line), " ", warning, mode="skipped", closing=sign * count)
    return Step(count)


def _skip(code: str, length: int) -> Step:
    """Skip a code span, unless it consists only of plain words."""
    is_word = re.fullmatch(r"[\w' .,-]+", code) and "_" not in code
    return Step(length, code if is_word else " ", "" if is_word else f"code is not spoken: {code.strip()}")
