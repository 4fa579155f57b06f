"""Reading and replacing of files in a folder that is held open.

Neither the folder nor the file is reached through a link.
"""

import os
import stat

from kinesic.files.held_folder import HeldFolder, name_beside
from kinesic.host import NO_LINK_FLAG, NO_WAIT_FLAG

READ_FLAGS = os.O_RDONLY | NO_LINK_FLAG | NO_WAIT_FLAG  # flags for reading, without following links or waiting
CREATE_FLAGS = os.O_WRONLY | os.O_CREAT | os.O_EXCL | NO_LINK_FLAG  # flags that create a file unless the name exists


def read_held(folder: HeldFolder, name: str, *, limit: int) -> bytes | None:
    """Return a regular file's first `limit` bytes, or None.

    None if the file is missing, unreadable, a link or not regular.
    """
    try:
        descriptor = folder.open_entry(name, READ_FLAGS)
    except OSError:
        return None
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        return None
    with os.fdopen(descriptor, "rb") as file:
        return file.read(limit)


def replace_held(folder: HeldFolder, name: str, content: bytes) -> None:
    """Replace a file atomically, after flushing the new content to disk.

    Raises:
        OSError: the file is not written.
    """
    fresh = name_beside(name)
    with os.fdopen(folder.open_entry(fresh, CREATE_FLAGS), "wb") as file:
        try:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        except OSError:
            folder.remove_entry(fresh)
            raise
    os.replace(
        folder.entry_path(fresh), folder.entry_path(name), src_dir_fd=folder.descriptor, dst_dir_fd=folder.descriptor
    )
    if folder.descriptor is not None:
        os.fsync(folder.descriptor)
