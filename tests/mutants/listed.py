"""Lists of modules to mutate, and of equivalent mutants."""

import tomllib
from collections.abc import Iterator
from pathlib import Path

HERE = Path(__file__).parent

Name = tuple[str, str, str]  # module, lines as they are, lines as they become


def read_targets() -> dict[str, dict[str, list[str]]]:
    """Return the modules of each part, with the tests that must notice their mutants.

    Raises:
        ValueError: two files list a part of the same name, and one would hide the other.
    """
    parts: dict[str, dict[str, list[str]]] = {}
    for room in _rooms("targets"):
        if twice := parts.keys() & room.keys():
            raise ValueError(f"two files of targets/ list the part {', '.join(sorted(twice))}; rename one")
        parts |= room
    return parts


def read_equivalent() -> dict[Name, str]:
    """Return the equivalent mutants, with the reason."""
    return {
        (item["module"], item["was"], item["now"]): item["why"]
        for room in _rooms("equivalent")
        for item in room.get("mutant", [])
    }


def _rooms(folder: str) -> Iterator[dict]:
    return (tomllib.loads(path.read_text(encoding="utf-8")) for path in sorted((HERE / folder).glob("*.toml")))
