"""Safe reading of regular files inside a folder, up to a size.

A check of a path and a later `open` may see different files. Here a file is opened first and examined afterwards.
"""

import os
import stat
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import BinaryIO

from kinesic.body.config import ConfigError
from kinesic.files.held_folder import hold_folder
from kinesic.host import HAS_FOLDER_DESCRIPTORS, NO_LINK_FLAG, NO_WAIT_FLAG

READ_FLAGS = os.O_RDONLY | NO_WAIT_FLAG | getattr(os, "O_BINARY", 0)  # Flags for reading without waiting for a pipe


@contextmanager
def open_regular(path: Path) -> Iterator[BinaryIO]:
    """Open a regular file without waiting for pipes or devices.

    Raises:
        ConfigError: the path leads to a folder, a pipe or a device.
        OSError: the file cannot be opened.
    """
    with os.fdopen(os.open(path, READ_FLAGS), "rb") as file:
        _check_regular(file, str(path))
        yield file


@contextmanager
def open_inside(folder: Path, path: Path) -> Iterator[BinaryIO]:
    """Open a regular file at any depth inside a folder.

    Links are followed once, and each component of the resolved path is opened as itself: a link that is exchanged
    meanwhile is refused.

    Raises:
        ConfigError: the file is outside the folder, or not regular.
        OSError: the file cannot be opened.
    """
    try:
        place, home = path.resolve(), folder.resolve()
    except RuntimeError as error:  # cyclic links
        raise ConfigError(f"{path.name}: {error}") from None
    if not place.is_relative_to(home):
        raise ConfigError(f"{path.name} is outside of the folder {home.name}; copy that file into it")
    with _open_beneath(home, place) as file:
        _check_regular(file, path.name)
        yield file


def read_inside(folder: Path, path: Path, *, max_size: int) -> bytes:
    """Read a regular file of limited size from inside a folder.

    Args:
        folder: folder of the file.
        path: path of the file.
        max_size: [bytes] largest size.

    Raises:
        ConfigError: the file is outside the folder, too large, or not regular.
        OSError: the file cannot be opened.
    """
    with open_inside(folder, path) as file:
        size = os.fstat(file.fileno()).st_size
        data = b"" if size > max_size else file.read(max_size + 1)
    if size > max_size or len(data) > max_size:
        raise ConfigError(f"{path.name} has {max(size, len(data))} bytes; at most {max_size} are read")
    return data


@contextmanager
def _open_beneath(home: Path, place: Path) -> Iterator[BinaryIO]:
    """Open a file below a folder without following links."""
    if not HAS_FOLDER_DESCRIPTORS:
        with place.open("rb") as file:
            yield file
        return
    *above, name = place.relative_to(home).parts or (".",)
    with ExitStack() as folders:
        inside = folders.enter_context(hold_folder(home))
        for part in above:
            inside = folders.enter_context(hold_folder(part, inside=inside))
        with os.fdopen(inside.open_entry(name, READ_FLAGS | NO_LINK_FLAG), "rb") as file:
            yield file


def _check_regular(file: BinaryIO, name: str) -> None:
    if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
        raise ConfigError(f"{name} is not a regular file, but a folder, a pipe or a device; name a file")
