"""Robot files that extend another robot file.

`extends = "NAME"` in [robot] names a robot of this package, or a file in the same folder. Entries of lists are matched
by name: keys of the new file replace those of an existing entry, and unmatched entries are appended. Tables are
merged. Exclusions add up. Buses, if the new file describes any, replace those of the other robot.
"""

from collections.abc import Mapping
from pathlib import Path

from kinesic.body.config import (
    ConfigError,
    T,
    check_inside,
    fit_schema,
    locate_config,
    names_of,
    read_tables,
    suggestion,
)

MAX_EXTENSION_DEPTH = 8  # Largest number of robot files in a chain of extensions

Tables = dict[str, object]


def read_robot(path: Path, schema: type[T]) -> T:
    """Read a robot's file, merged with the files that it extends.

    Raises:
        ConfigError: a file is missing, invalid, or extends itself.
    """
    return fit_schema(_read(path, ()), schema, path)


def find_extended(path: Path) -> Path | None:
    """Return the path of the extended robot file, or None without one.

    Raises:
        ConfigError: a file is missing or invalid.
    """
    extends = _get_extended(read_tables(path))
    return None if extends is None else _find(extends, path)


def _get_extended(tables: Tables) -> str | None:
    robot = tables.get("robot")
    extends = robot.get("extends") if isinstance(robot, Mapping) else None
    return extends if isinstance(extends, str) else None


def _read(path: Path, below: tuple[Path, ...]) -> Tables:
    tables = read_tables(path)
    extends = _get_extended(tables)
    if extends is None:
        return tables
    if path in below or len(below) >= MAX_EXTENSION_DEPTH:
        chain = ", which extends ".join(file.name for file in (*below, path))
        raise ConfigError(f"{path}: it extends itself: {chain}; one of them must describe a whole robot")
    return _extended(_read(_find(extends, path), (*below, path)), tables)


def _find(extends: str, path: Path) -> Path:
    """Convert the value of `extends` to the path of a robot file.

    It is a robot of this package, or a file in the folder of this one or below.
    """
    if extends in names_of("robot"):
        return locate_config("robot", extends)
    if not extends.endswith(".toml"):
        hint = suggestion(extends, names_of("robot"))
        raise ConfigError(f"{path}: no robot {extends}{hint} (or name a .toml file in the same folder)")
    named = path.parent / extends
    try:
        check_inside(path.parent, named)
    except ConfigError as error:
        raise ConfigError(f"{path}: extends = {extends!r}: {error}") from None
    return named


def _extended(tables: Tables, added: Tables) -> Tables:
    merged = dict(tables)
    for key, value in added.items():
        merged[key] = value if key == "bus" else _joined(tables.get(key), value)
    return merged


def _joined(old: object, new: object) -> object:
    if isinstance(old, Mapping) and isinstance(new, Mapping):
        return {
            **old,
            **{key: _joined(old.get(key), value) if key == "exclude" else value for key, value in new.items()},
        }
    if isinstance(old, list) and isinstance(new, list):
        named = {_name_of(entry, k): entry for k, entry in enumerate(old) if isinstance(entry, Mapping)}
        for k, entry in enumerate(new, len(old)):
            name = _name_of(entry, k)
            named[name] = {**named.get(name, {}), **entry} if isinstance(entry, Mapping) else entry
        return list(named.values())
    return new


def _name_of(entry: object, index: int) -> str | int:
    """Return the name of a TOML entry, or its index if unnamed.

    The schema refuses names that are not text.
    """
    name = entry.get("name") if isinstance(entry, Mapping) else None
    return name if isinstance(name, str) else index
