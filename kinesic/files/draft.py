"""Hidden folders in which output is written before it takes its place.

A draft holds a file that its process locks. The lock ends with the process, however that ends, so that a later
process can tell the drafts of killed processes from those that are being written.
"""

import fcntl
import os
import re
import shutil
import stat
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass

from kinesic.files.held_folder import hold_folder, name_beside

DRAFT_FILE = ".kinesic-draft"
DRAFT_TEXT = b"kinesic writes this folder, or was killed as it did; then the next run removes the folder.\n"
DRAFT_NAME = re.compile(r"\..*-[0-9a-f]{12}(\..*)?", re.DOTALL)  # as `name_beside` makes them
PRIVATE_MODE = 0o700
PUBLIC_MODE = 0o777  # before the umask
LOCK_FLAGS = os.O_RDWR | os.O_NOFOLLOW | os.O_NONBLOCK

_swept_folders: set[tuple[int, int]] = set()  # device and inode, once per process: listing large folders takes time


@dataclass(frozen=True)
class Draft:
    """A hidden folder that is being written."""

    name: str
    folder: int  # descriptor
    parent: int  # descriptor of the folder that holds it

    def finish(self) -> None:
        """Make the folder final, so that no later process removes it."""
        with suppress(FileNotFoundError):
            os.unlink(DRAFT_FILE, dir_fd=self.folder)


@contextmanager
def hold_draft(name: str, *, parent: int, mode: int = PRIVATE_MODE) -> Iterator[Draft]:
    """Make a draft folder, and remove it at the end unless renamed.

    Args:
        name: of the file or folder that the draft becomes.
        parent: descriptor of the folder that holds both.
        mode: permissions of the draft, before the umask.
    """
    held = os.fstat(parent)
    if (held.st_dev, held.st_ino) not in _swept_folders:
        _swept_folders.add((held.st_dev, held.st_ino))
        remove_abandoned(parent)
    hidden = name_beside(name)
    os.mkdir(hidden, mode, dir_fd=parent)
    with hold_folder(hidden, inside=parent) as folder, ExitStack() as ending:
        ending.callback(remove_folder, hidden, folder, parent=parent)
        lock = os.open(DRAFT_FILE, LOCK_FLAGS | os.O_CREAT | os.O_EXCL, 0o600, dir_fd=folder)
        ending.callback(os.close, lock)
        _lock(lock, folder)
        yield Draft(hidden, folder, parent)


def mark_as_abandoned(folder: int) -> None:
    """Mark an open folder so that a later process removes it."""
    with suppress(OSError):  # a full disk costs no result that is in its place already
        descriptor = os.open(DRAFT_FILE, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600, dir_fd=folder)
        with open(descriptor, "wb") as file:
            file.write(DRAFT_TEXT)


def remove_abandoned(parent: int) -> None:
    """Remove the drafts of killed processes from an open folder.

    Only folders of this user with a draft's name and a draft's file that no process locks are removed.
    """
    with suppress(OSError):
        for name in filter(DRAFT_NAME.fullmatch, os.listdir(parent)):
            with suppress(OSError), hold_folder(name, inside=parent) as folder:
                _remove_if_abandoned(name, folder, parent=parent)


def remove_folder(name: str, held: int, *, parent: int) -> None:
    """Remove an open folder with its contents, without following links."""
    if not is_same(name, held, parent=parent):
        return
    with suppress(OSError):  # what resists stays, under the hidden name
        for entry in sorted(os.listdir(held), key=lambda entry: entry == DRAFT_FILE):  # the draft's file last
            if stat.S_ISDIR(os.stat(entry, dir_fd=held, follow_symlinks=False).st_mode):
                shutil.rmtree(entry, dir_fd=held)
            else:
                os.unlink(entry, dir_fd=held)
        os.rmdir(name, dir_fd=parent)


def is_same(name: str, held: int, *, parent: int) -> bool:
    """Return whether a name in a folder refers to an open folder."""
    try:
        return os.path.samestat(os.fstat(held), os.stat(name, dir_fd=parent, follow_symlinks=False))
    except FileNotFoundError:
        return False


def _lock(lock: int, folder: int) -> None:
    """Lock the draft file, or delete it if locks are unsupported."""
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.unlink(DRAFT_FILE, dir_fd=folder)
        return
    os.write(lock, DRAFT_TEXT)  # after the lock: a file without the text counts as locked


def _remove_if_abandoned(name: str, folder: int, *, parent: int) -> None:
    """Remove an open folder if its process was killed.

    Raises:
        OSError: it is none, or a process locks it.
    """
    with open(os.open(DRAFT_FILE, LOCK_FLAGS, dir_fd=folder), "r+b", buffering=0) as file:
        found, user = os.fstat(file.fileno()), os.geteuid()
        is_ours = stat.S_ISREG(found.st_mode) and found.st_uid == os.fstat(folder).st_uid == user
        if is_ours and file.read(len(DRAFT_TEXT) + 1) == DRAFT_TEXT:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            remove_folder(name, folder, parent=parent)
