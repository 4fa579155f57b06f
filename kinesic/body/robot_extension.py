"""A robot's file that extends another one: it says only what is different.

`extends = "NAME"` in [robot] names a robot of this package, or a file in the folder of this one. Entries of lists are
known by their names: one that is there already takes the keys that are written anew, others are added at the end.
Tables take further keys. Exclusions add up, and buses, where any are described, replace those of the other robot.
"""

from collections.abc import Mapping
from pathlib import Path

from kinesic.body.config import ConfigError, T, check_inside, fit_schema, locate, names_of, read_tables, suggestion

DEEPEST = 8  # robots that extend one another

Tables = dict[str, object]


def read_robot(path: Path, schema: type[T]) -> T:
    """Reads a robot's file, with what it takes over from others, into a schema.

    Raises:
        ConfigError: a file is missing, wrong, or extends itself.
    """
    return fit_schema(_read(path, ()), schema, path)


def _read(path: Path, below: tuple[Path, ...]) -> Tables:
    tables = read_tables(path)
    robot = tables.get("robot")
    extends = robot.get("extends") if isinstance(robot, Mapping) else None
    if not isinstance(extends, str):
        return tables
    if path in below or len(below) >= DEEPEST:
        chain = ", which extends ".join(each.name for each in (*below, path))
        raise ConfigError(f"{path}: it extends itself: {chain}; one of them must describe a whole robot")
    return _extended(_read(_find(extends, path), (*below, path)), tables)


def _find(extends: str, path: Path) -> Path:
    """Where the other robot is: one of this package, or a file in the folder of this one or below."""
    if extends in names_of("robot"):
        return locate("robot", extends)
    if not extends.endswith(".toml"):
        known = suggestion(extends, names_of("robot"))
        raise ConfigError(f"{path}: no robot {extends}{known} (or name a .toml file beside this one)")
    named = path.parent / extends
    try:
        check_inside(path.parent, named)
    except ConfigError as error:
        raise ConfigError(f"{path}: extends = {extends!r}: {error}") from None
    return named


def _extended(tables: Tables, added: Tables) -> Tables:
    found = dict(tables)
    for key, value in added.items():
        found[key] = value if key == "bus" else _joined(tables.get(key), value)
    return found


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
    """Return the name of an entry, or its index without one.

    The schema refuses names that are not text.
    """
    name = entry.get("name") if isinstance(entry, Mapping) else None
    return name if isinstance(name, str) else index
