"""Atomic writing of files.

A file appears when it is complete, and the earlier one stays until then.
"""

import os
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from kinesic.body.config import ConfigError
from kinesic.files.draft import hold_draft
from kinesic.files.held_folder import HeldFolder, check_above, find_place, hold_folder, name_failures
from kinesic.files.unicode_text import check_encodable
from kinesic.host import NO_LINK_FLAG, NO_WAIT_FLAG

CREATE_FLAGS = os.O_WRONLY | os.O_CREAT | os.O_EXCL | NO_LINK_FLAG  # flags that create a file unless the name exists
SYNC_FLAGS = NO_LINK_FLAG | (os.O_RDONLY if sys.platform != "win32" else os.O_RDWR)  # Flags for fsync (Windows: O_RDWR)
WRITE_BITS = stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH  # Write permissions of user, group and others
PERMISSION_BITS = stat.S_IRWXU | stat.S_IRWXG | stat.S_IRWXO  # All permissions of user, group and others
APPEND_FLAGS = os.O_WRONLY | os.O_CREAT | os.O_APPEND | NO_LINK_FLAG | NO_WAIT_FLAG  # Flags for appending


def check_file(path: Path, *, force: bool = False) -> None:
    """Raise an error if `new_file` could not write a file.

    Args:
        path: path of the file.
        force: whether an existing regular file may be replaced.

    Raises:
        ConfigError: the file exists, is a folder or a link, or its folder is missing.
    """
    place = find_place(path)
    check_above(place, path)
    if not place.parent.is_dir():
        raise ConfigError(f"{path}: there is no folder {path.parent}; make it first")
    with name_failures(path), hold_folder(place.parent) as parent:
        _check_name(parent, place.name, path, force=force)


@contextmanager
def new_file(path: Path, *, force: bool = False, durable: bool = False) -> Iterator[Path]:
    """Yield a temporary path, renamed to the final path on success.

    The draft is in a hidden folder next to the file, which later runs remove if this process is killed. A replaced file
    keeps its permissions.

    Args:
        path: path of the file.
        force: whether an existing regular file may be replaced.
        durable: whether the file must survive a power failure after return, which waits for the disk.

    Raises:
        ConfigError: as `check_file`, or writing failed.
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
            os.close(parent.open_entry(place.name, CREATE_FLAGS))  # reserves the name, or fails
        os.replace(
            draft.folder.entry_path(place.name),
            parent.entry_path(place.name),
            src_dir_fd=draft.folder.descriptor,
            dst_dir_fd=parent.descriptor,
        )
        if durable and parent.descriptor is not None:
            os.fsync(parent.descriptor)


def write_text(path: Path, text: str, *, force: bool = False, durable: bool = False) -> None:
    """Write a text file atomically, with the arguments of `new_file`.

    Raises:
        ConfigError: as `new_file`, or the text contains a lone surrogate.
    """
    check_encodable(text, place=str(path))
    with new_file(path, force=force, durable=durable) as fresh:
        fresh.write_text(text, encoding="utf-8")


def open_to_add(path: Path) -> BinaryIO:
    """Open a file for unbuffered appending, and create it if missing.

    Raises:
        OSError: the file cannot be written, or is a link or a pipe without reader.
    """
    return open(path, "ab", buffering=0, opener=lambda name, _: os.open(name, APPEND_FLAGS, 0o666))


def _check_name(parent: HeldFolder, name: str, path: Path, *, force: bool) -> int | None:
    """Raise an error if a path's existing entry must not be replaced.

    Returns:
        Permissions of the existing file; None without one.

    Raises:
        ConfigError: the file must stay.
    """
    try:
        mode = parent.entry_status(name or ".").st_mode
    except FileNotFoundError:
        return None
    if stat.S_ISLNK(mode):
        raise ConfigError(f"{path} is a link, and links are never followed; name the file itself")
    if stat.S_ISDIR(mode):
        raise ConfigError(f"{path} is a folder; name a file in it")
    if not stat.S_ISREG(mode):
        raise ConfigError(f"{path} is not a regular file; name another")
    if not force:
        raise ConfigError(f"{path} exists already; --force replaces it, --out names another")
    is_writable = os.access(parent.entry_path(name), os.W_OK, dir_fd=parent.descriptor)
    if not mode & WRITE_BITS or not is_writable:  # root may write regardless of the mode
        raise ConfigError(f"{path} is read-only and is not replaced; chmod u+w it, or name another")
    return mode & PERMISSION_BITS


def _settle(folder: HeldFolder, name: str, mode: int | None, *, durable: bool) -> None:
    """Restore a replaced file's permissions, and flush it if `durable`."""
    if mode is None and not durable:
        return
    descriptor = folder.open_entry(name, SYNC_FLAGS)
    try:
        if mode is not None and sys.platform != "win32":  # Windows has no such permissions
            os.fchmod(descriptor, mode)
        if durable:
            os.fsync(descriptor)
    finally:
        os.close(descriptor)
