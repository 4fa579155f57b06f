"""Writes files as wholes: they appear when they are complete, and what was there before stays until then."""

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from kinesic.body.config import ConfigError
from kinesic.files.held_folder import check_above, find_place, hold_folder, name_beside, name_failures

NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
MORE = os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_NOFOLLOW


def check_file(path: Path, *, force: bool = False) -> None:
    """Refuses a file that `new_file` would not write, before any work is done for it.

    Args:
        path: of the file.
        force: whether an ordinary file that is there may be replaced.

    Raises:
        ConfigError: it is there already, it is a folder or a link, or there is no folder for it.
    """
    place = find_place(path)
    check_above(place, path)
    if not place.parent.is_dir():
        raise ConfigError(f"{path}: there is no folder {path.parent}; make it first")
    with name_failures(path), hold_folder(place.parent) as parent:
        _check_name(parent, place.name, path, force=force)


@contextmanager
def new_file(path: Path, *, force: bool = False) -> Iterator[Path]:
    """Yields the path of a file beside to write to; it takes its place when all went well, else nothing has changed.

    Args:
        path: of the file.
        force: whether an ordinary file that is there may be replaced.

    Raises:
        ConfigError: as `check_file`, or it could not be written.
    """
    check_file(path, force=force)
    place = find_place(path)
    with name_failures(path), hold_folder(place.parent) as parent:
        fresh = name_beside(place.name)
        try:
            yield place.parent / fresh
            _check_name(parent, place.name, path, force=force)
            if not force:
                os.close(os.open(place.name, NEW, 0o666, dir_fd=parent))  # ours from here on, or an error
            os.replace(fresh, place.name, src_dir_fd=parent, dst_dir_fd=parent)
        finally:
            with suppress(FileNotFoundError):
                os.unlink(fresh, dir_fd=parent)


def write_text(path: Path, text: str, *, force: bool = False) -> None:
    """Writes a text to a file, as a whole.

    Raises:
        ConfigError: as `new_file`.
    """
    with new_file(path, force=force) as fresh:
        fresh.write_text(text, encoding="utf-8")


def open_to_add(path: Path) -> BinaryIO:
    """Opens a file to add to it, and makes it where there is none; unbuffered, and never through a link.

    Raises:
        OSError: it cannot be written, or is a link.
    """
    return open(path, "ab", buffering=0, opener=lambda name, _: os.open(name, MORE, 0o666))


def _check_name(parent: int, name: str, path: Path, *, force: bool) -> None:
    """Refuses what stands under a name in an open folder."""
    try:
        mode = os.stat(name or ".", dir_fd=parent, follow_symlinks=False).st_mode
    except FileNotFoundError:
        return
    if stat.S_ISLNK(mode):
        raise ConfigError(f"{path} is a link, and links are never followed; name the file itself")
    if stat.S_ISDIR(mode):
        raise ConfigError(f"{path} is a folder; name a file in it")
    if not stat.S_ISREG(mode):
        raise ConfigError(f"{path} is no ordinary file; name another")
    if not force:
        raise ConfigError(f"{path} exists already; --force replaces it, --out names another")
