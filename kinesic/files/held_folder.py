"""Folders held open: whatever their names lead to meanwhile, what is done in them is done in the same place."""

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from kinesic.body.config import ConfigError
from kinesic.files.plain_name import cut_name

FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW


@contextmanager
def hold_folder(path: Path | str, *, inside: int | None = None) -> Iterator[int]:
    """Holds a folder open and yields its descriptor.

    Args:
        path: of the folder; its last name must be no link.
        inside: descriptor of the folder that the path starts in.
    """
    descriptor = os.open(path, FOLDER, dir_fd=inside)
    try:
        yield descriptor
    finally:
        os.close(descriptor)


def find_place(path: Path) -> Path:
    """Finds where a path leads: links above it are followed once, and the last name is kept as it is.

    Raises:
        ConfigError: the links above it go in a circle.
    """
    try:
        if path.name in ("", ".."):  # here, the root, or the folder above: no name of its own to keep
            return path.resolve()
        return path.parent.resolve() / path.name
    except (OSError, RuntimeError) as error:
        raise ConfigError(f"{path}: {error}") from None


def check_above(place: Path, path: Path) -> None:
    """Refuses a place that could not be written, because what is above it is no folder, or closed to us.

    Raises:
        ConfigError: it is so; names the path as it was given.
    """
    above = next((folder for folder in place.parents if os.path.lexists(folder)), place)
    if not above.is_dir():
        raise ConfigError(f"{path}: {above} is no folder")
    if not os.access(above, os.W_OK | os.X_OK):
        raise ConfigError(f"{path}: {above} may not be written; name another place")


def name_beside(name: str) -> str:
    """Makes up a hidden name that nobody has, with the same ending, since endings name formats."""
    stem, ending = os.path.splitext(name)
    return f".{cut_name(stem, limit=100)}-{secrets.token_hex(6)}{cut_name(ending, limit=100)}"


@contextmanager
def name_failures(path: Path) -> Iterator[None]:
    """Tells failures of the file system in one line, with the path as it was given.

    Raises:
        ConfigError: something could not be written.
    """
    try:
        yield
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror or error}") from None
