"""Access to folders through open descriptors, safe against renaming.

Operations on the descriptor stay in the same folder, even if its name leads elsewhere meanwhile.
"""

import errno
import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from kinesic.body.config import ConfigError
from kinesic.files.plain_name import cut_name
from kinesic.host import FOLDER_FLAG, HAS_FOLDER_DESCRIPTORS, NO_LINK_FLAG

FOLDER_FLAGS = os.O_RDONLY | FOLDER_FLAG | NO_LINK_FLAG  # flags that open a folder, but refuse a link to one


@dataclass(frozen=True, eq=False)
class HeldFolder:
    """Folder held by an open descriptor, so that renaming does no harm.

    Windows cannot hold folders: there the descriptor is None, and entries are reached by their whole path.
    """

    path: Path
    descriptor: int | None

    def entry_path(self, name: str) -> str:
        """Return an entry's path for system calls relative to this folder's descriptor.

        It is the whole path if there is no descriptor.
        """
        return name if self.descriptor is not None else str(self.path / name)

    def renamed(self, name: str) -> "HeldFolder":
        """Return this held folder with another name, without renaming on disk."""
        return HeldFolder(self.path.with_name(name), self.descriptor)

    def names(self) -> list[str]:
        """Return the names of all entries of the folder."""
        return os.listdir(self.path if self.descriptor is None else self.descriptor)

    def status(self) -> os.stat_result:
        """Return the folder's `stat` result, such as owner and permissions."""
        return os.stat(self.path if self.descriptor is None else self.descriptor)

    def entry_status(self, name: str) -> os.stat_result:
        """Return the `stat` result of a folder entry, without following a link.

        Raises:
            FileNotFoundError: there is no such entry.
        """
        return os.stat(self.entry_path(name), dir_fd=self.descriptor, follow_symlinks=False)

    def open_entry(self, name: str, flags: int, mode: int = 0o666) -> int:
        """Open a folder entry and return its descriptor."""
        return os.open(self.entry_path(name), flags, mode, dir_fd=self.descriptor)

    def remove_entry(self, name: str) -> None:
        """Remove a file or link from the folder."""
        os.unlink(self.entry_path(name), dir_fd=self.descriptor)

    def rename_entry(self, name: str, new_name: str) -> None:
        """Rename a folder entry, replacing an empty folder of the new name."""
        if self.descriptor is None and os.path.isdir(self.entry_path(new_name)):  # Windows replaces no folder
            os.rmdir(self.entry_path(new_name))
        os.rename(
            self.entry_path(name), self.entry_path(new_name), src_dir_fd=self.descriptor, dst_dir_fd=self.descriptor
        )


@contextmanager
def hold_folder(path: Path | str, *, inside: HeldFolder | None = None) -> Iterator[HeldFolder]:
    """Keep a folder open during a `with` block.

    Args:
        path: path of the folder; its last component must not be a link.
        inside: folder in which the path starts.

    Raises:
        OSError: the folder is missing, no folder or a link.
    """
    whole_path = Path(path) if inside is None else inside.path / path
    if not HAS_FOLDER_DESCRIPTORS:
        if not stat.S_ISDIR(os.lstat(whole_path).st_mode):
            raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(whole_path))
        yield HeldFolder(whole_path, None)
        return
    descriptor = os.open(path, FOLDER_FLAGS, dir_fd=None if inside is None else inside.descriptor)
    try:
        yield HeldFolder(whole_path, descriptor)
    finally:
        os.close(descriptor)


def find_place(path: Path) -> Path:
    """Resolve the symbolic links in all but the last path component.

    Raises:
        ConfigError: the links are cyclic.
    """
    try:
        if path.name in ("", ".."):  # the last component is no name that could be kept
            return path.resolve()
        return path.parent.resolve() / path.name
    except (OSError, RuntimeError) as error:
        raise ConfigError(f"{path}: {error}") from None


def check_above(place: Path, path: Path) -> None:
    """Raise an error unless a path's nearest existing parent is writable.

    Raises:
        ConfigError: the path is refused; the message has the given path.
    """
    existing = next((folder for folder in place.parents if os.path.lexists(folder)), place)
    if not existing.is_dir():
        raise ConfigError(f"{path}: {existing} is no folder")
    if not os.access(existing, os.W_OK | os.X_OK):
        raise ConfigError(f"{path}: {existing} may not be written; name another place")


def name_beside(name: str) -> str:
    """Make a unique hidden name from a file name, with its suffix."""
    stem, ending = os.path.splitext(name)
    return f".{cut_name(stem, limit=100)}-{secrets.token_hex(6)}{cut_name(ending, limit=100)}"


@contextmanager
def name_failures(path: Path) -> Iterator[None]:
    """Convert file system errors to a one-line error with a path.

    Raises:
        ConfigError: an operation failed.
    """
    try:
        yield
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror or error}") from None
