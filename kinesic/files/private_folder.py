"""Folders in shared places, writable for their owner only."""

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from kinesic.files.held_folder import HeldFolder, hold_folder
from kinesic.host import user_id

OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH  # Write permissions of group and others


@contextmanager
def hold_private_folder(path: Path, *, make: bool = False) -> Iterator[HeldFolder]:
    """Hold a folder open, or raise an error if others may write.

    Args:
        path: path of the folder; its last component must not be a link.
        make: whether a missing folder is created in an existing one.

    Raises:
        OSError: the folder is missing, a link, another user's, or writable by others.
    """
    if make:
        with suppress(FileExistsError):
            os.mkdir(path, 0o700)
    with hold_folder(path) as folder:
        status = folder.status()
        if status.st_uid != user_id():
            raise PermissionError(errno.EPERM, f"it belongs to another user (uid {status.st_uid})", str(path))
        if status.st_mode & OTHERS_WRITE:
            raise PermissionError(errno.EPERM, "other users may write it", str(path))
        yield folder
