"""Archive folder with earlier versions and backups of documents."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import time

from kinesic.body.config import ConfigError
from kinesic.files.draft import DRAFT_NAME
from kinesic.files.held_folder import HeldFolder, hold_folder

ARCHIVE_NAME = ".kinesic-studio"  # name of the folder with versions and backups
PRIVATE_MODE = 0o700  # permissions of a new archive
MIN_ABANDONED_AGE = 3600.0  # [s] age from which an incomplete file counts as abandoned by a killed process
LINK_ERRORS = frozenset({errno.ENOTDIR, errno.ELOOP})  # error codes of opening a file or a link as a folder


@contextmanager
def hold_archive(folder: Path | None) -> Iterator[HeldFolder]:
    """Open a document folder's archive within the context, creating it if missing.

    Raises:
        ConfigError: the archive cannot be made, is a link or is not a folder.
    """
    if folder is None:
        raise ConfigError("this server keeps no documents: start it with --folder FOLDER")
    try:
        with hold_folder(folder.resolve()) as parent:
            with suppress(FileExistsError):
                os.mkdir(parent.entry_path(ARCHIVE_NAME), PRIVATE_MODE, dir_fd=parent.descriptor)
            with hold_folder(ARCHIVE_NAME, inside=parent) as archive:
                yield archive
    except OSError as error:
        place = folder / ARCHIVE_NAME
        remedy = f"; remove it, or choose another --folder than {folder}" if error.errno in LINK_ERRORS else ""
        raise ConfigError(f"{place}: {error.strerror or error}{remedy}") from None


def remove_abandoned_files(archive: HeldFolder) -> None:
    """Remove incomplete files older than an hour, left by killed processes."""
    for name in filter(DRAFT_NAME.fullmatch, archive.names()):
        with suppress(OSError):
            if time() - archive.entry_status(name).st_mtime > MIN_ABANDONED_AGE:
                archive.remove_entry(name)
