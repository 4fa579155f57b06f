"""Writes files as wholes: they appear when they are complete, and what was there before stays until then."""

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from kinesic.body.config import ConfigError
from kinesic.files.draft import hold_draft
from kinesic.files.held_folder import check_above, find_place, hold_folder, name_failures

NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
ANY_WRITE = stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH
PERMISSION_BITS = stat.S_IRWXU | stat.S_IRWXG | stat.S_IRWXO
APPEND_FLAGS = os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_NOFOLLOW | os.O_NONBLOCK  # a pipe may have no reader


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
def new_file(path: Path, *, force: bool = False, durable: bool = False) -> Iterator[Path]:
    """Yield a draft path whose file becomes final without an error.

    The path is in a hidden folder beside the file, which later runs remove if this process is killed. A file that is
    replaced keeps its permissions.

    Args:
        path: of the file.
        force: whether an ordinary file that is there may be replaced.
        durable: whether the file must survive a power failure once this returns; waits for the disk.

    Raises:
        ConfigError: as `check_file`, or it could not be written.
    """
    check_file(path, force=force)
    place = find_place(path)
    with (
        name_failures(path),
        hold_folder(place.parent) as parent,
        hold_draft(place.name, parent=parent) as draft,
    ):
        yield place.parent / draft.name / place.name
        mode = _check_name(parent, place.name, path, force=force)
        _settle(draft.folder, place.name, mode, durable=durable)
        if not force:
            os.close(os.open(place.name, NEW, 0o666, dir_fd=parent))  # ours from here on, or an error
        os.replace(place.name, place.name, src_dir_fd=draft.folder, dst_dir_fd=parent)
        if durable:
            os.fsync(parent)


def write_text(path: Path, text: str, *, force: bool = False, durable: bool = False) -> None:
    """Write a text file atomically, with the arguments of `new_file`.

    Raises:
        ConfigError: as `new_file`.
    """
    with new_file(path, force=force, durable=durable) as fresh:
        fresh.write_text(text, encoding="utf-8")


def open_to_add(path: Path) -> BinaryIO:
    """Open a file for appending, unbuffered, creating it if missing.

    Raises:
        OSError: it cannot be written, or is a link, or a pipe that no process reads.
    """
    return open(path, "ab", buffering=0, opener=lambda name, _: os.open(name, APPEND_FLAGS, 0o666))


def _check_name(parent: int, name: str, path: Path, *, force: bool) -> int | None:
    """Refuse to replace links, folders, devices and protected files.

    Returns:
        Permissions of the file that is there; None where there is none.

    Raises:
        ConfigError: it must stay.
    """
    try:
        mode = os.stat(name or ".", dir_fd=parent, follow_symlinks=False).st_mode
    except FileNotFoundError:
        return None
    if stat.S_ISLNK(mode):
        raise ConfigError(f"{path} is a link, and links are never followed; name the file itself")
    if stat.S_ISDIR(mode):
        raise ConfigError(f"{path} is a folder; name a file in it")
    if not stat.S_ISREG(mode):
        raise ConfigError(f"{path} is no ordinary file; name another")
    if not force:
        raise ConfigError(f"{path} exists already; --force replaces it, --out names another")
    if not mode & ANY_WRITE or not os.access(name, os.W_OK, dir_fd=parent):  # root may write, whatever the mode says
        raise ConfigError(f"{path} is read-only and is not replaced; chmod u+w it, or name another")
    return mode & PERMISSION_BITS


def _settle(folder: int, name: str, mode: int | None, *, durable: bool) -> None:
    """Set the permissions of the replaced file and flush to the disk."""
    if mode is None and not durable:
        return
    descriptor = os.open(name, os.O_RDONLY | os.O_NOFOLLOW, dir_fd=folder)
    try:
        if mode is not None:
            os.fchmod(descriptor, mode)
        if durable:
            os.fsync(descriptor)
    finally:
        os.close(descriptor)
