"""Strict reading of TOML files.

Unknown keys, wrong types and numbers that are not finite are errors, and each error names a remedy. A file may only
refer to files inside its own folder.
"""

import difflib
import math
import re
import tomllib
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from types import UnionType
from typing import Annotated, TypeVar, Union, get_args, get_origin

import msgspec

CONFIGS = Path(__file__).resolve().parent.parent / "configs"  # folder of the built-in configuration files

MAX_FILE_SIZE = 4_000_000  # [bytes] largest accepted configuration file
MAX_KEY_PARTS = 32  # Largest number of parts of a dotted TOML key
MAX_NESTING = 32  # Largest depth of nested lists and tables in a TOML file

_KEY_PART = r"""(?:"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+'|[\w+-]++)"""  # pattern of a key part or one-line value
_KEY_DOT = r"[ \t]*+\.[ \t]*+"  # separator of the parts of a dotted key
_BASIC_STRING = r"""\"{3}(?:[^"\\]|\\.?|"{1,2}(?!"))*+(?:"{3,5}|\Z)"""  # multi-line basic strings, also unclosed ones
_LITERAL_STRING = r"""'{3}(?:[^']|'{1,2}(?!'))*+(?:'{3,5}|\Z)"""  # multi-line literal strings, also unclosed ones
_DEEP_KEY = rf"(?P<deep>{_KEY_PART}(?:{_KEY_DOT}{_KEY_PART}){{{MAX_KEY_PARTS}}})"
_OTHER_TEXT = r"""[^\w+"'#\[\]{}-]++|."""  # other text without effect on nesting
_TOKEN_PATTERN = re.compile(
    rf"{_BASIC_STRING}|{_LITERAL_STRING}|{_DEEP_KEY}|{_KEY_PART}(?:{_KEY_DOT}{_KEY_PART})*+|\#[^\n]*+|(?P<open>[\[{{])|(?P<close>[\]}}])|{_OTHER_TEXT}",
    re.DOTALL,
)

T = TypeVar("T")


class ConfigError(ValueError):
    """Missing or invalid configuration file, name or option.

    The message names the file, the place, the value and a valid alternative.
    """


def read_toml(path: Path, schema: type[T]) -> T:
    """Read a TOML file into a msgspec schema.

    Args:
        path: path of the file.
        schema: a `msgspec.Struct` with `forbid_unknown_fields`.

    Raises:
        ConfigError: the file is missing, not TOML, or does not fit the schema.
    """
    return fit_schema(read_tables(path), schema, path)


def read_tables(path: Path) -> dict[str, object]:
    """Read the tables of a TOML file without a schema.

    Raises:
        ConfigError: the file is missing, not TOML, or has numbers that are not finite.
    """
    try:
        with path.open("rb") as file:
            raw = file.read(MAX_FILE_SIZE + 1)
        if len(raw) > MAX_FILE_SIZE:
            raise ConfigError(
                f"{path}: more than {MAX_FILE_SIZE // 1_000_000} MB; configuration files usually have a few kB"
            )
        return parse_tables(raw.decode("utf-8"), path)
    except FileNotFoundError:
        raise ConfigError(f"{path}: no such file") from None
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: not TOML: {error}") from None


def parse_tables(text: str, path: Path) -> dict[str, object]:
    """Parse the tables of a TOML text without a schema.

    Args:
        text: contents of a file.
        path: path of the file, for messages.

    Raises:
        ConfigError: the text is not TOML, or has numbers that are not finite.
    """
    try:
        data, odd = _parse(text, trusted=path.parent.resolve().is_relative_to(CONFIGS))
    except ValueError as error:
        raise ConfigError(f"{path}: not TOML: {error}") from None
    for place, value in odd:
        raise ConfigError(f"{path}: {place} is {value}, must be a finite number")
    return data


def describe_excess(text: str) -> str:
    """Describe the first TOML nesting or dotted key beyond its limit.

    The parser's time grows with the square of the number of parts of a dotted key, and it recurses for each nesting.

    Empty text if there is none.
    """
    nested = 0
    for token in _TOKEN_PATTERN.finditer(text):
        match token.lastgroup:
            case "open":
                nested += 1
                if nested > MAX_NESTING:
                    return f"in {_line(text, token)} more than {MAX_NESTING} lists or tables are nested"
            case "close":
                nested -= 1
            case "deep":
                return f"a key in {_line(text, token)} has more than {MAX_KEY_PARTS} parts; a.b.c has three"
    return ""


def _line(text: str, token: re.Match[str]) -> str:
    return f"line {text.count(chr(10), 0, token.start()) + 1}"


def fit_schema(data: object, schema: type[T], path: Path) -> T:
    """Convert parsed TOML tables to a msgspec schema.

    Args:
        data: the parsed tables.
        schema: a `msgspec.Struct` with `forbid_unknown_fields`.
        path: path of the file, for messages.

    Raises:
        ConfigError: the tables do not fit; the message names the place and a valid key.
    """
    try:
        return msgspec.convert(data, schema)
    except msgspec.ValidationError as error:
        raise ConfigError(f"{path}: {error}{_suggest_key(str(error), schema)}") from None


def locate_config(kind: str, name: str | Path) -> Path:
    """Return the path of a configuration file from its name or path.

    A path ends in .toml; a name is searched in `configs/KINDs/`.

    Raises:
        ConfigError: no file has this name.
    """
    path = Path(name)
    if path.suffix == ".toml":
        return path
    path = CONFIGS / f"{kind}s" / f"{name}.toml"
    if not path.exists():
        raise ConfigError(f"no {kind} {name}{suggestion(str(name), names_of(kind))} (or give a .toml file)")
    return path


def check_inside(folder: Path, named: Path) -> None:
    """Raise an error for paths outside a folder and for special files.

    Links are followed. A missing file passes, because its reader reports it.

    Args:
        folder: folder of the referring file.
        named: path of the referenced file.

    Raises:
        ConfigError: the path is refused.
    """
    try:
        place, home = named.resolve(), folder.resolve()
        is_odd = place.exists() and not place.is_file()  # opening a pipe may block for ever
    except (OSError, RuntimeError, ValueError) as error:  # cyclic links, or an invalid file name
        raise ConfigError(f"{str(named)!r} names no file: {error}") from None
    if not place.is_relative_to(home):
        raise ConfigError(f"{str(named)!r} is outside of the folder {folder}; copy that file there, and name it alone")
    if is_odd:
        raise ConfigError(f"{str(named)!r} is not a regular file; name one")


def names_of(kind: str) -> tuple[str, ...]:
    """List the built-in configuration names of one kind, such as `robot`."""
    return tuple(sorted(file.stem for file in (CONFIGS / f"{kind}s").glob("*.toml")))


def suggestion(word: str, valid_names: Iterator[str] | list[str] | tuple[str, ...]) -> str:
    """Return a hint with the nearest valid name, or all names.

    Returns:
        '; did you mean X?', or a list of all valid names if none is near.
    """
    names = sorted(valid_names)
    near = difflib.get_close_matches(word, names, n=1, cutoff=0.6)
    if near:
        return f"; did you mean {near[0]}?"
    return f"; known: {', '.join(names)}" if names else ""


@lru_cache(maxsize=16)
def _parse(text: str, *, trusted: bool) -> tuple[dict[str, object], list[tuple[str, float]]]:
    """Parse a TOML text and return its tree and its non-finite numbers.

    Each number comes with its place in the tree. Results are cached, because robots extend the same files. Files of
    kinesic itself are trusted not to contain excess.

    Raises:
        ValueError: the text is not TOML, has an excess, or has a whole number with thousands of digits.
    """
    if not trusted and (excess := describe_excess(text)):
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


def _suggest_key(message: str, schema: object) -> str:
    """Return a hint with the valid keys for a schema error.

    Empty if the error is about a value.
    """
    place = re.search(r" at `\$([^`]*)`", message)
    schemas = [schema]
    for part in re.findall(r"\.[^.\[]+|\[[^\]]*\]", place.group(1) if place else ""):
        schemas = [inner for outer in schemas for inner in _enter(outer, part)]
    valid_keys = list(dict.fromkeys(name for outer in schemas for name in _list_keys(outer)))
    if unknown := re.search(r"unknown field `([^`]+)`", message):
        return suggestion(unknown.group(1), valid_keys or list(_list_fields(schema, set())))
    return f"; a table with {', '.join(valid_keys)}" if valid_keys and "Expected `object" in message else ""


def _enter(schema: object, part: str) -> Iterator[object]:
    """Yield the type of a schema's field, or of its items."""
    if isinstance(schema, type) and issubclass(schema, msgspec.Struct):
        yield from (field.type for field in msgspec.structs.fields(schema) if part == f".{field.encode_name}")
    elif get_origin(schema) in (Union, UnionType, Annotated):
        yield from (item for inner in get_args(schema) for item in _enter(inner, part))
    elif part.startswith("["):
        yield from get_args(schema)


def _list_keys(schema: object) -> Iterator[str]:
    """Yield the keys of a struct type, or of a union's structs."""
    if isinstance(schema, type) and issubclass(schema, msgspec.Struct):
        yield from (field.encode_name for field in msgspec.structs.fields(schema))
    for inner in get_args(schema) if get_origin(schema) in (Union, UnionType, Annotated) else ():
        yield from _list_keys(inner)


def _list_fields(schema: object, seen: set[object]) -> Iterator[str]:
    """Yield all field names of a schema and its nested schemas."""
    if schema in seen:
        return
    seen.add(schema)
    for inner in get_args(schema):
        yield from _list_fields(inner, seen)
    if isinstance(schema, type) and issubclass(schema, msgspec.Struct):
        for field in msgspec.structs.fields(schema):
            yield field.encode_name
            yield from _list_fields(field.type, seen)
