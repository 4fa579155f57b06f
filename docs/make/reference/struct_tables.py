"""Markdown tables of msgspec structs, described by the comments of their fields."""

import ast
import inspect
import re
import types
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Literal, Union, get_args, get_origin, get_type_hints

import msgspec

PLAIN_TYPES = {str: "text", float: "number", int: "whole number", bool: "true or false", bytes: "base64", object: "any"}
PLURALS: dict[object, str] = {str: "texts", float: "numbers", int: "whole numbers"}
UNITS: dict[object, str] = {bytes: "bytes"}
NO_KINDS: Mapping[str, str] = {}


@dataclass(frozen=True, eq=False)
class Key:
    """One key of a table: its type, default and meaning."""

    name: str
    kind: str
    default: str
    meaning: str


def list_keys(table: type[msgspec.Struct]) -> list[Key]:
    """Return all keys of a struct in their order."""
    hints, meanings = get_type_hints(table, include_extras=True), read_meanings(table)
    return [
        Key(field.encode_name, describe_type(hints[field.name]), default_of(field), meanings.get(field.name, ""))
        for field in msgspec.structs.fields(table)
    ]


def read_meanings(table: type[msgspec.Struct]) -> dict[str, str]:
    """Return the comment of each field of a struct, inherited ones included."""
    meanings: dict[str, str] = {}
    for part in reversed(table.__mro__):
        if part is not msgspec.Struct and issubclass(part, msgspec.Struct):
            meanings |= read_comments(part)
    return meanings


def read_comments(table: type) -> dict[str, str]:
    """Return the comment of each field that a class itself declares."""
    source = inspect.getsource(table)
    lines = source.splitlines()
    (definition,) = ast.parse(source).body
    assert isinstance(definition, ast.ClassDef)
    meanings = {}
    for statement in definition.body:
        if isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name):
            text = "\n".join(lines[statement.lineno - 1 : statement.end_lineno])
            comments = re.findall(r"  # (.+)", text)
            meanings[statement.target.id] = " ".join(comment.split("  # ")[0] for comment in comments)
    return meanings


def default_of(field: msgspec.structs.FieldInfo) -> str:
    """Return a field's default as written in a file, or "required"."""
    if field.required:
        return "required"
    value = field.default_factory() if field.default is msgspec.NODEFAULT else field.default
    if value is None or isinstance(value, msgspec.Struct) or value in ([], {}, ()):
        return ""
    if isinstance(value, float) and value == float("inf"):
        return "no limit"
    return f"`{str(value).lower() if isinstance(value, bool) else msgspec.json.encode(value).decode()}`"


def describe_type(hint: object) -> str:
    """Describe a Python type in terms of TOML and JSON."""
    origin, parts = get_origin(hint), get_args(hint)
    if hint in PLAIN_TYPES:
        return PLAIN_TYPES[hint]
    if origin is Annotated:
        (limits,) = [part for part in parts[1:] if isinstance(part, msgspec.Meta)]
        if limits.max_length is not None:
            unit = "elements" if get_origin(parts[0]) in (list, tuple) else UNITS.get(parts[0], "characters")
            return f"{describe_type(parts[0])}, at most {limits.max_length} {unit}"
        if limits.pattern is not None:
            return f"{describe_type(parts[0])} matching `{limits.pattern}`"
        return f"{describe_type(parts[0])} in [{limits.ge:g}, {limits.le:g}]"
    if origin is Literal:
        return ", ".join(f"`{value}`" for value in parts)
    if origin in (Union, types.UnionType):
        return " or ".join(describe_type(part) for part in parts if part is not type(None))
    if origin is tuple and parts[-1] is not Ellipsis:
        words = list(dict.fromkeys(describe_type(part) for part in parts))
        return f"[{', '.join(words * len(parts) if len(words) == 1 else words)}]"
    if origin in (list, tuple):
        return f"list of {PLURALS.get(parts[0]) or describe_type(parts[0])}"
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return f"table: {describe_name(parts[0])} = {describe_type(parts[1])}"
    if isinstance(hint, type) and issubclass(hint, msgspec.Struct):
        return f"[{title_of(hint)}](#{title_of(hint).lower().replace(' ', '-')})"
    raise TypeError(f"no words for the type {hint}")


def describe_name(hint: object) -> str:
    """Describe the key type of a mapping."""
    return "name" if hint is str else describe_type(hint)


def title_of(table: type[msgspec.Struct]) -> str:
    """Return the heading of a struct (`BodyFormTable`: "Body form")."""
    words = re.findall(r"[A-Z][a-z]+", table.__name__.strip("_"))
    return " ".join(words[:-1] if len(words) > 1 and words[-1] == "Table" else words).capitalize()


def nested_tables(table: type[msgspec.Struct]) -> Iterator[type[msgspec.Struct]]:
    """Yield a struct and all nested structs, outer ones first."""
    seen: list[type[msgspec.Struct]] = []

    def visit(hint: object) -> None:
        if isinstance(hint, type) and issubclass(hint, msgspec.Struct):
            if hint not in seen:
                seen.append(hint)
                for inner in get_type_hints(hint, include_extras=True).values():
                    visit(inner)
        else:
            for part in get_args(hint):
                visit(part)

    visit(table)
    yield from seen


def key_table(table: type[msgspec.Struct], other_kinds: Mapping[str, str] = NO_KINDS) -> list[str]:
    """Return the lines of a Markdown table of all keys.

    Args:
        table: the struct.
        other_kinds: kinds of keys that the struct's type leaves open.
    """
    return [
        "| key | value | default | meaning |",
        "|---|---|---|---|",
        *(
            f"| `{key.name}` | {other_kinds.get(key.name, key.kind)} | {key.default} | {_cell(key.meaning)} |"
            for key in list_keys(table)
        ),
    ]


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;")
