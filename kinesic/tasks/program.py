"""Version of the running program, for comparison between workers.

Workers with another version give other results.
"""

import hashlib
import os
from collections.abc import Iterator
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from platform import python_version

PACKAGE_FOLDER = Path(__file__).resolve().parents[1]  # folder of the package kinesic
SOURCE_SUFFIXES = (".py", ".toml", ".cpp", ".h")  # suffixes of files in the source hash
FOREIGN_FOLDERS = {"node_modules", "__pycache__"}  # folders inside the package without its own files
VERSIONED_LIBRARIES = ("numpy", "mujoco-core", "casadi", "highspy")  # libraries that affect numerical results


def program_files(endings: tuple[str, ...]) -> Iterator[Path]:
    """Yield the package's files with given suffixes, sorted by path."""
    files: list[Path] = []
    for folder, subfolders, names in os.walk(PACKAGE_FOLDER):
        subfolders[:] = [name for name in subfolders if name not in FOREIGN_FOLDERS]
        files += (Path(folder, name) for name in names if name.endswith(endings))
    yield from sorted(files)


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
