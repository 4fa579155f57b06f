"""Folders that no other user may write, in shared places."""

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from kinesic.files.held_folder import hold_folder

OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


@contextmanager
def hold_private_folder(path: Path, *, make: bool = False) -> Iterator[int]:
    """Yield the descriptor of a folder that no other user may write.

    Args:
        path: of the folder; its last name must be no link.
        make: whether a missing folder is made, in a folder that is there.

    Raises:
        OSError: it is missing, no folder, a link, another user's, or open to others.
    """
    if make:
        with suppress(FileExistsError):
            os.mkdir(path, 0o700)
    with hold_folder(path) as folder:
        found = os.fstat(folder)
        if found.st_uid != os.geteuid():
            raise PermissionError(errno.EPERM, f"it belongs to another user (uid {found.st_uid})", str(path))
        if found.st_mode & OTHERS_WRITE:
            raise PermissionError(errno.EPERM, "other users may write it", str(path))
        yield folder
