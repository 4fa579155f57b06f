"""Paths of values in a JSON document, such as `behaviours[2].stroke`."""

import json
import re
from dataclasses import dataclass

TOKEN_PATTERN = re.compile(r'"(?:[^"\\]|\\.)*"|[{}\[\],:]|[^\s{}\[\],:"]+')  # text, punctuation or literal
PLAIN_KEY_PATTERN = re.compile(r"[A-Za-z_]\w*")  # keys that a path shows as `.key`, without brackets
KEY_PREFIX_PATTERN = re.compile(r"([A-Za-z_][\w:.-]*)(?==|: )")  # attribute name at the beginning of an error message
MAX_PATH_LENGTH = 200  # [characters] longest JSON path in a message; the rest is cut off


@dataclass(eq=False)
class _Level:
    """Open JSON object or list, with its current key or index."""

    is_object: bool
    at: str | int | None  # current key or index; None: no key of the object was read yet


def find_json_path(text: str, line: int, column: int, *, problem: str = "") -> str:
    """Return the path of the JSON value at a line and column.

    Args:
        text: the document; it may be invalid after the place.
        line: from 1.
        column: from 1.
        problem: error text; an attribute named at its beginning is appended if the object has it.

    Returns:
        The path, such as `behaviours[2].stroke`; empty for the whole document.
    """
    offset = sum(len(row) + 1 for row in text.split("\n")[: line - 1]) + column - 1
    levels = _open_levels(text, offset)
    path = "".join(_step(level.at) for level in levels if level.at is not None).removeprefix(".")
    named = KEY_PREFIX_PATTERN.match(problem)
    if named is not None and named[1] in _keys_at(text, offset):
        path = f"{path}{_step(named[1])}".removeprefix(".")
    return path[:MAX_PATH_LENGTH]


def _open_levels(text: str, offset: int) -> list[_Level]:
    """Return the objects and lists open at an offset, outermost first."""
    levels: list[_Level] = []
    for token in TOKEN_PATTERN.finditer(text):
        if token.start() >= offset:
            break
        match token[0]:
            case "{" | "[":
                levels.append(_Level(token[0] == "{", None if token[0] == "{" else 0))
            case "}" | "]":
                del levels[-1:]
            case "," if levels:
                level = levels[-1]
                level.at = level.at + 1 if isinstance(level.at, int) else None
            case key if levels and levels[-1].is_object and levels[-1].at is None and key[0] == '"':
                levels[-1].at = _read_key(key)
    return levels


def _keys_at(text: str, offset: int) -> frozenset[str]:
    """Return the keys of the JSON object that begins at an offset.

    Other values have no keys.
    """
    try:
        value, _ = json.JSONDecoder().raw_decode(text, offset)
    except (ValueError, RecursionError):
        return frozenset()
    return frozenset(value) if isinstance(value, dict) else frozenset()


def _read_key(token: str) -> str:
    try:
        return str(json.loads(token))
    except ValueError:  # invalid escape sequence
        return token[1:-1]


def _step(at: str | int) -> str:
    if isinstance(at, int):
        return f"[{at}]"
    return f".{at}" if PLAIN_KEY_PATTERN.fullmatch(at) else f"[{json.dumps(at, ensure_ascii=False)}]"
