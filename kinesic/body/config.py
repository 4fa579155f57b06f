"""Reads TOML strictly: unknown keys, wrong types and numbers that are not finite are errors that teach.

Whoever sends somebody a folder names nothing outside of it.
"""

import difflib
import math
import re
import tomllib
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import TypeVar, get_args

import msgspec

CONFIGS = Path(__file__).resolve().parent.parent / "configs"

LARGEST_FILE = 4_000_000  # [bytes]
MOST_PARTS = 32  # of a dotted key
MOST_NESTED = 32  # lists and tables inside one another

_PART = r"""(?:"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+'|[\w+-]++)"""  # of a key, or a value
_DOT = r"[ \t]*+\.[ \t]*+"
_BASIC = r"""\"{3}(?:[^"\\]|\\.?|"{1,2}(?!"))*+(?:"{3,5}|\Z)"""  # strings of several lines
_LITERAL = r"""'{3}(?:[^']|'{1,2}(?!'))*+(?:'{3,5}|\Z)"""
_DEEP = rf"(?P<deep>{_PART}(?:{_DOT}{_PART}){{{MOST_PARTS}}})"
_REST = r"""[^\w+"'#\[\]{}-]++|."""
_TOKENS = re.compile(
    rf"{_BASIC}|{_LITERAL}|{_DEEP}|{_PART}(?:{_DOT}{_PART})*+|\#[^\n]*+|(?P<open>[\[{{])|(?P<close>[\]}}])|{_REST}",
    re.DOTALL,
)

T = TypeVar("T")


class ConfigError(ValueError):
    """A file of facts is missing or wrong: names the file, the place, the value and what would have worked."""


def read_toml(path: Path, schema: type[T]) -> T:
    """Reads a TOML file into a msgspec schema.

    Args:
        path: of the file.
        schema: a `msgspec.Struct` with `forbid_unknown_fields`.

    Raises:
        ConfigError: the file is missing, not TOML, or does not fit the schema.
    """
    return fit_schema(read_tables(path), schema, path)


def read_tables(path: Path) -> dict[str, object]:
    """Reads the tables of a TOML file as they stand there.

    Raises:
        ConfigError: the file is missing, not TOML, or has numbers that are not finite.
    """
    try:
        with path.open("rb") as file:
            raw = file.read(LARGEST_FILE + 1)
        if len(raw) > LARGEST_FILE:
            raise ConfigError(f"{path}: more than {LARGEST_FILE // 1_000_000} MB; such a file has some kB")
        return parse_tables(raw.decode("utf-8"), path)
    except FileNotFoundError:
        raise ConfigError(f"{path}: no such file") from None
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: not TOML: {error}") from None


def parse_tables(text: str, path: Path) -> dict[str, object]:
    """Reads the tables of a TOML text as they stand there.

    Args:
        text: of a file.
        path: of the file, for messages.

    Raises:
        ConfigError: it is not TOML, or has numbers that are not finite.
    """
    try:
        data, odd = _parsed(text, trusted=path.parent.resolve().is_relative_to(CONFIGS))
    except ValueError as error:
        raise ConfigError(f"{path}: not TOML: {error}") from None
    for place, value in odd:
        raise ConfigError(f"{path}: {place} is {value}, must be a finite number")
    return data


def find_excess(text: str) -> str:
    """Says what of a TOML text is too much to be parsed, and where; nothing when it may be parsed.

    The time of the parser grows with the square of the parts of a dotted key, and it calls itself for every nesting.
    """
    nested = 0
    for token in _TOKENS.finditer(text):
        match token.lastgroup:
            case "open":
                nested += 1
                if nested > MOST_NESTED:
                    return f"in {_line(text, token)} more than {MOST_NESTED} lists or tables are inside one another"
            case "close":
                nested -= 1
            case "deep":
                return f"a key in {_line(text, token)} has more than {MOST_PARTS} parts; a.b.c has three"
    return ""


def _line(text: str, token: re.Match[str]) -> str:
    return f"line {text.count(chr(10), 0, token.start()) + 1}"


def fit_schema(data: object, schema: type[T], path: Path) -> T:
    """Fits tables to a schema.

    Args:
        data: as it was read.
        schema: a `msgspec.Struct` with `forbid_unknown_fields`.
        path: of the file, for messages.

    Raises:
        ConfigError: they do not fit; says where, and what would have worked.
    """
    try:
        return msgspec.convert(data, schema)
    except msgspec.ValidationError as error:
        raise ConfigError(f"{path}: {error}{_suggestion(str(error), schema)}") from None


def locate(kind: str, name: str | Path) -> Path:
    """Finds the file of a robot or a style: a path to a TOML file, or a name in `configs/KINDs/`.

    Raises:
        ConfigError: there is nothing of this name.
    """
    path = Path(name)
    if path.suffix == ".toml":
        return path
    path = CONFIGS / f"{kind}s" / f"{name}.toml"
    if not path.exists():
        raise ConfigError(f"no {kind} {name}{suggestion(str(name), names_of(kind))} (or give a .toml file)")
    return path


def check_inside(folder: Path, named: Path) -> None:
    """Refuses a file outside of a folder, by its path or through links, and what is there but no ordinary file.

    Args:
        folder: of the file that names the other one.
        named: path of the other one; where nothing is there, whoever reads it says so.

    Raises:
        ConfigError: it is one of these.
    """
    try:
        place, home = named.resolve(), folder.resolve()
        is_odd = place.exists() and not place.is_file()  # whoever opens a pipe may wait for ever
    except (OSError, RuntimeError, ValueError) as error:  # a ring of links, no name of a file
        raise ConfigError(f"{str(named)!r} names no file: {error}") from None
    if not place.is_relative_to(home):
        raise ConfigError(f"{str(named)!r} is outside of the folder {folder}; copy that file there, and name it alone")
    if is_odd:
        raise ConfigError(f"{str(named)!r} is no ordinary file; name one")


def names_of(kind: str) -> tuple[str, ...]:
    """Lists the names of all that `configs/KINDs/` holds."""
    return tuple(sorted(file.stem for file in (CONFIGS / f"{kind}s").glob("*.toml")))


def suggestion(word: str, known: Iterator[str] | list[str] | tuple[str, ...]) -> str:
    """Suggests the known word nearest to a wrong one, '; did you mean X?', or lists all when none is near."""
    names = sorted(known)
    near = difflib.get_close_matches(word, names, n=1, cutoff=0.6)
    if near:
        return f"; did you mean {near[0]}?"
    return f"; known: {', '.join(names)}" if names else ""


@lru_cache(maxsize=16)
def _parsed(text: str, *, trusted: bool) -> tuple[dict[str, object], list[tuple[str, float]]]:
    """The tree of a TOML text, and its numbers that are not finite, with their places; robots share many files.

    Texts that come with kinesic are trusted not to have more than they need.

    Raises:
        ValueError: it is not TOML, or more than any file needs; also of whole numbers with thousands of digits.
    """
    if not trusted and (excess := find_excess(text)):
        raise ValueError(excess)
    data = tomllib.loads(text)
    return data, [(place, value) for place, value in _numbers(data, "$") if not math.isfinite(value)]


def _numbers(data: object, place: str) -> Iterator[tuple[str, float]]:
    if isinstance(data, dict):
        for key, value in data.items():
            yield from _numbers(value, f"{place}.{key}")
    elif isinstance(data, list):
        for k, value in enumerate(data):
            yield from _numbers(value, f"{place}[{k}]")
    elif isinstance(data, float):
        yield place, data


def _suggestion(message: str, schema: object) -> str:
    """What would have worked, for an unknown field."""
    unknown = re.search(r"unknown field `([^`]+)`", message)
    return suggestion(unknown.group(1), list(_fields(schema, set()))) if unknown else ""


def _fields(schema: object, seen: set[object]) -> Iterator[str]:
    """Names of all fields of a schema and of the schemas inside it."""
    if schema in seen:
        return
    seen.add(schema)
    for inner in get_args(schema):
        yield from _fields(inner, seen)
    if isinstance(schema, type) and issubclass(schema, msgspec.Struct):
        for field in msgspec.structs.fields(schema):
            yield field.encode_name
            yield from _fields(field.type, seen)
