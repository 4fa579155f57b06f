"""Version of the running program, for comparison between workers.

Workers with another version give other results.
"""

import hashlib
from collections.abc import Iterator
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from platform import python_version

PACKAGE_FOLDER = Path(__file__).resolve().parents[1]
SOURCE_SUFFIXES = (".py", ".toml", ".cpp", ".h")  # suffixes of files in the source hash
VERSIONED_LIBRARIES = ("numpy", "mujoco-core", "casadi", "highspy")  # libraries that affect numerical results


def program_files(endings: tuple[str, ...]) -> Iterator[Path]:
    """Yield the package's files with given suffixes, sorted by path."""
    return (file for file in sorted(PACKAGE_FOLDER.rglob("*")) if file.suffix in endings)


@cache
def program_version() -> str:
    """Return source hash, Python version and numerical library versions as text."""
    digest = hashlib.blake2b(digest_size=6)
    for file in program_files(SOURCE_SUFFIXES):
        digest.update(str(file.relative_to(PACKAGE_FOLDER)).encode() + b"\0" + file.read_bytes())
    libraries = ", ".join(f"{name} {_version(name)}" for name in VERSIONED_LIBRARIES)
    return f"sources {digest.hexdigest()}, python {python_version()}, {libraries}"


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "missing"
