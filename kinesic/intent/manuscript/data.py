"""Formulas, data and LaTeX commands, which are not spoken as written."""

import json
import re

from kinesic.intent.manuscript.pieces import Step

MAX_DATA_LENGTH = 4000  # [characters] longest JSON value that is recognised
MAX_COMMAND_LENGTH = 200  # [characters] longest incomplete LaTeX command that waits for its end
_JSON_START = re.compile(r"\{\s*\"[^\"\n]{0,60}\"\s*:|\[\s*\{\s*\"")
_OPEN_JSON = re.compile(r"\{\s*(?:\"[^\"\n]{0,60}\"?\s*)?|\[\s*(?:\{\s*)?")
_SPOKEN_KEYS = ("say", "speech", "text", "answer", "response", "message")  # keys of data whose values are spoken
_FORMULA_PATTERN = re.compile(
    r"\$\$(?P<block>[^$]{1,300})\$\$|\$(?P<inline>(?:[^\s$\d]|\d[\d.,]*[\\^_{=])(?:[^$\n]{0,120}[^\s$])?)\$(?!\d)"
    r"|\\\((?P<round>.{1,300}?)\\\)|\\\[(?P<square>.{1,300}?)\\\]",
    re.DOTALL,
)  # formula between `$$`, `$`, `\(` or `\[`
_OPEN_FORMULA = re.compile(
    r"\$(?:\$[^$]{0,300}\$?|(?:\d[\d.,]*|(?:[^\s$\d]|\d[\d.,]*[\\^_{=])[^$\n]{0,121}\$?)?)"
    r"|\\(?:\((?:(?!\\\)).){0,300}|\[(?:(?!\\\]).){0,300})",
    re.DOTALL,
)
_FORMULA_SIGNS = re.compile(r"\\[A-Za-z]|[\^_{=]")  # signs that distinguish a formula from a price or from brackets
_UNSPOKEN_SIGNS = re.compile(r"[<>*_`^|~#\\&{}]")
_LATEX_COMMAND = re.compile(r"\\([A-Za-z]+)\*?(?:\[[^\]\n]{0,80}\])?\{([^{}\n]{0,120})\}")
_OPEN_LATEX = re.compile(r"\\[A-Za-z]+\*?(?:\[[^\]\n]{0,80}\]?)?(?:\{[^{}\n]{0,120})?")
_SILENT_COMMAND = re.compile(
    r"begin|end|cite\w?|(?:eq)?ref|label|includegraphics|usepackage|documentclass|input|include|[vh]space|bibliography\w*"
)  # LaTeX commands whose argument is not spoken

_UNSPOKEN_BLOCK = re.compile(
    r"(?:(?:display)?math|equation|align|gather|multline|eqnarray|tabular\w?|array|tikzpicture|verbatim|lstlisting)\*?"
)  # LaTeX environments whose content is not spoken


def read_json(rest: str, *, ends: bool) -> Step | None:
    """Skip a JSON value, except for the spoken message in it.

    Returns:
        Length 0 without a JSON value, None if it may be incomplete.
    """
    if not ends and _OPEN_JSON.fullmatch(rest):
        return None
    if not _JSON_START.match(rest):
        return Step(0)
    try:
        value, length = json.JSONDecoder().raw_decode(rest[:MAX_DATA_LENGTH])
    except (json.JSONDecodeError, RecursionError):
        return None if not ends and len(rest) < MAX_DATA_LENGTH else Step(0)
    texts = [value[key] for key in _SPOKEN_KEYS if isinstance(value, dict) and isinstance(value.get(key), str)]
    if texts:
        return Step(length, f" {_UNSPOKEN_SIGNS.sub(' ', texts[0])} ")
    return Step(length, " ", f"data is not spoken: {rest[: min(length, 40)]}")


def read_formula(rest: str, *, ends: bool) -> Step | None:
    r"""Read a formula between `$`, `$$`, `\(` or `\[`.

    Letters and numbers without commands are spoken.

    Returns:
        Length 0 without a formula, None if it may be incomplete.
    """
    if not ends and _OPEN_FORMULA.fullmatch(rest):
        return None
    match = _FORMULA_PATTERN.match(rest)
    formula = match[match.lastgroup or 0] if match else ""
    if match is None or not (_FORMULA_SIGNS.search(formula) or re.fullmatch(r"\s*[A-Za-z]\s*", formula)):
        return Step(0)
    if "\\" in formula or "{" in formula:
        return Step(match.end(), " ", f"a formula is not spoken: {formula.strip()}")
    return Step(match.end(), re.sub(r"[_^]", " ", formula))


def read_latex(rest: str, *, ends: bool) -> Step | None:
    """Read a LaTeX command, and speak only an argument that is text.

    Returns:
        Length 0 without a command, None if it may be incomplete.
    """
    command = _LATEX_COMMAND.match(rest)
    if command and command[1] == "begin" and _UNSPOKEN_BLOCK.fullmatch(command[2]):
        closing = f"\\end{{{command[2]}}}"
        return Step(command.end(), " ", f"LaTeX is not spoken: {command[2]}", mode="skipped", closing=closing)
    if command:
        is_silent = _SILENT_COMMAND.fullmatch(command[1]) is not None
        return Step(command.end(), " " if is_silent else _UNSPOKEN_SIGNS.sub(" ", command[2]))
    if not ends and len(rest) < MAX_COMMAND_LENGTH and "{" in rest and _OPEN_LATEX.fullmatch(rest):
        return None
    item = re.match(r"\\item\b", rest)
    return Step(item.end() if item else 0, " ")
