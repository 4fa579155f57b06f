"""Which program a process runs: workers that run another one give other results."""

import hashlib
from collections.abc import Iterator
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from platform import python_version

PACKAGE = Path(__file__).resolve().parents[1]
PARTS = (".py", ".toml", ".cpp", ".h")  # endings of the sources, which are the same wherever they are compiled
LIBRARIES = ("numpy", "scipy", "mujoco-core", "casadi")  # whose figures results depend on


def program_files(endings: tuple[str, ...]) -> Iterator[Path]:
    """Yields the files of the program with some endings, in order."""
    return (file for file in sorted(PACKAGE.rglob("*")) if file.suffix in endings)


@cache
def program_version() -> str:
    """Says which program this process runs: a hash of its sources, and the versions of what it calculates with."""
    digest = hashlib.blake2b(digest_size=6)
    for file in program_files(PARTS):
        digest.update(str(file.relative_to(PACKAGE)).encode() + b"\0" + file.read_bytes())
    libraries = ", ".join(f"{name} {_version(name)}" for name in LIBRARIES)
    return f"sources {digest.hexdigest()}, python {python_version()}, {libraries}"


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "missing"
