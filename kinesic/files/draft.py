"""Hidden draft folders for output that is being written.

A draft contains a file that its process locks. The lock ends with the process, so that a later process can distinguish
the drafts of killed processes from those in use.
"""

import errno
import os
import re
import shutil
import stat
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass

from kinesic.files.held_folder import HeldFolder, hold_folder, name_beside
from kinesic.host import NO_LINK_FLAG, NO_WAIT_FLAG, user_id

DRAFT_FILE = ".kinesic-draft"  # name of the file that marks a draft folder
# content of a draft folder's marker file
DRAFT_TEXT = b"kinesic writes this folder, or was killed as it did; then the next run removes the folder.\n"
DRAFT_NAME = re.compile(r"\..*-[0-9a-f]{12}(\..*)?", re.DOTALL)  # pattern of the hidden names made by `name_beside`
PRIVATE_MODE = 0o700  # permissions of a hidden folder that holds an unfinished output file
PUBLIC_MODE = 0o777  # permissions, before the umask, of a hidden folder that becomes an output folder
LOCK_FLAGS = os.O_RDWR | NO_LINK_FLAG | NO_WAIT_FLAG  # flags that open a draft's marker file for a lock

_swept_folders: set[tuple[int, int]] = set()  # (device, inode) of folders already cleared of abandoned drafts


@dataclass(frozen=True)
class Draft:
    """Hidden folder with output that is not complete yet."""

    name: str
    folder: HeldFolder
    parent: HeldFolder  # folder that contains the draft

    def finish(self) -> None:
        """Delete the draft marker, so that later processes keep the folder."""
        with suppress(FileNotFoundError):
            self.folder.remove_entry(DRAFT_FILE)


@contextmanager
def hold_draft(name: str, *, parent: HeldFolder, mode: int = PRIVATE_MODE) -> Iterator[Draft]:
    """Create a draft folder, and remove it at the end unless renamed.

    Args:
        name: name of the final file or folder.
        parent: descriptor of the folder that contains both.
        mode: permissions of the draft, before the umask.
    """
    held = parent.status()
    if (held.st_dev, held.st_ino) not in _swept_folders:
        _swept_folders.add((held.st_dev, held.st_ino))
        remove_abandoned(parent)
    hidden = name_beside(name)
    os.mkdir(parent.entry_path(hidden), mode, dir_fd=parent.descriptor)
    with hold_folder(hidden, inside=parent) as folder, ExitStack() as ending:
        ending.callback(remove_folder, hidden, folder, parent=parent)
        if sys.platform != "win32":  # Windows renames no folder with an open file; a killed draft stays there
            lock = folder.open_entry(DRAFT_FILE, LOCK_FLAGS | os.O_CREAT | os.O_EXCL, 0o600)
            ending.callback(os.close, lock)
            _lock(lock, folder)
        yield Draft(hidden, folder, parent)


def mark_as_abandoned(folder: HeldFolder) -> None:
    """Mark an open folder so that a later process removes it."""
    with suppress(OSError):  # a full disk must not affect finished results
        descriptor = folder.open_entry(DRAFT_FILE, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with open(descriptor, "wb") as file:
            file.write(DRAFT_TEXT)


def remove_abandoned(parent: HeldFolder) -> None:
    """Remove the drafts of killed processes from an open folder.

    Only folders of this user with a draft's name and an unlocked draft file are removed.
    """
    with suppress(OSError):
        for name in filter(DRAFT_NAME.fullmatch, parent.names()):
            with suppress(OSError), hold_folder(name, inside=parent) as folder:
                _remove_if_abandoned(name, folder, parent=parent)


def remove_folder(name: str, held: HeldFolder, *, parent: HeldFolder) -> None:
    """Remove an open folder with its contents, without following links.

    Nothing is removed if the name refers to another folder by now.
    """
    if not is_same(name, held, parent=parent):
        return
    with suppress(OSError):  # undeletable files stay under the hidden name
        for entry in sorted(held.names(), key=lambda entry: entry == DRAFT_FILE):  # the draft's file last
            if stat.S_ISDIR(held.entry_status(entry).st_mode):
                shutil.rmtree(held.entry_path(entry), dir_fd=held.descriptor)
            else:
                held.remove_entry(entry)
        os.rmdir(parent.entry_path(name), dir_fd=parent.descriptor)


def is_same(name: str, held: HeldFolder, *, parent: HeldFolder) -> bool:
    """Return whether a name in a folder refers to an open folder."""
    try:
        return os.path.samestat(held.status(), parent.entry_status(name))
    except FileNotFoundError:
        return False


def _lock(lock: int, folder: HeldFolder) -> None:
    """Lock a draft folder's marker file, or remove the file on failure."""
    try:
        _lock_file(lock)
    except OSError:
        folder.remove_entry(DRAFT_FILE)
        return
    os.write(lock, DRAFT_TEXT)  # after the lock: a file without the text counts as locked


def _remove_if_abandoned(name: str, folder: HeldFolder, *, parent: HeldFolder) -> None:
    """Remove a draft folder whose process was killed.

    Raises:
        OSError: the folder is not a draft, or a process locks it.
    """
    with open(folder.open_entry(DRAFT_FILE, LOCK_FLAGS), "r+b", buffering=0) as file:
        status, user = os.fstat(file.fileno()), user_id()
        is_ours = stat.S_ISREG(status.st_mode) and status.st_uid == folder.status().st_uid == user
        if is_ours and file.read(len(DRAFT_TEXT) + 1) == DRAFT_TEXT:
            _lock_file(file.fileno())
            remove_folder(name, folder, parent=parent)


def _lock_file(descriptor: int) -> None:
    """Lock an open file until it is closed.

    Raises:
        OSError: another process locks it, or this system has no such locks.
    """
    if sys.platform != "win32":
        import fcntl  # noqa: PLC0415 - Windows has none

        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    else:
        raise OSError(errno.ENOTSUP, os.strerror(errno.ENOTSUP))
