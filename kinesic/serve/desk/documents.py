"""Keeps documents of clients in one folder: by plain names, never through a link, nothing outside it."""

import os
import re
import stat
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from kinesic.body.config import ConfigError
from kinesic.files.output_file import write_text
from kinesic.files.plain_name import is_device_name

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}\.(bml|toml)")
GESTURE_SUFFIX = ".toml"  # of a file of gestures
MOST_BYTES = 1_000_000  # of a document that is read
MOST_NAMES = 1000  # that are listed
MOST_LOOKED_AT = 5000  # entries of a folder of which documents are listed
MOST_SUGGESTED = 20  # names in an error
ORDINARY = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK  # a pipe without a writer keeps nobody waiting


def is_document_name(name: str) -> bool:
    """Return whether this is a valid document name on every operating system."""
    return NAME.fullmatch(name) is not None and not is_device_name(name)


@dataclass(frozen=True)
class Listing:
    """Names of documents in order."""

    names: tuple[str, ...]
    is_whole: bool  # whether these are all


class DocumentFolder:
    """The documents (.bml, .toml) of a folder."""

    def __init__(self, folder: Path | None) -> None:
        """Takes a folder that is there; None: there is none, and everything is refused."""
        self._folder = folder

    def list(self) -> Listing:
        """Lists the documents, as far as a folder of usual size goes."""
        if self._folder is None:
            return Listing((), is_whole=True)
        with os.scandir(self._folder) as entries:
            seen = tuple(islice(entries, MOST_LOOKED_AT + 1))
        found = sorted(entry.name for entry in seen if is_document_name(entry.name) and _is_ordinary(entry))
        return Listing(tuple(found[:MOST_NAMES]), is_whole=len(found) <= MOST_NAMES and len(seen) <= MOST_LOOKED_AT)

    def read(self, name: str) -> str:
        """Reads a document.

        Raises:
            ConfigError: there is no such document, or it is too large.
        """
        raw = _read_ordinary(self._path(name))
        if raw is None:
            there = self.list().names
            shown = ", ".join(there[:MOST_SUGGESTED]) or "none"
            more = f" and {len(there) - MOST_SUGGESTED} more" if len(there) > MOST_SUGGESTED else ""
            raise ConfigError(f"{name}: there is no such document; there are: {shown}{more}")
        if len(raw) > MOST_BYTES:
            raise ConfigError(f"{name}: more than {MOST_BYTES} bytes, which no document has here; open it elsewhere")
        return raw.decode("utf-8", "replace")

    def read_present(self, name: str) -> str | None:
        """Reads the beginning of what a name would replace, whatever it is; None: nothing is there."""
        path = self._path(name)
        raw = _read_ordinary(path)
        if raw is None:
            return "" if os.path.lexists(path) else None
        return raw.decode("utf-8", "replace")

    def save(self, name: str, text: str) -> None:
        """Write a document durably, byte for byte, replacing an earlier one.

        Raises:
            ConfigError: it is no name of a document, or it cannot be written.
        """
        write_text(self._path(name), text, force=True, durable=True)

    def _path(self, name: str) -> Path:
        if self._folder is None:
            raise ConfigError("this server keeps no documents: start it with --folder FOLDER")
        if not is_document_name(name):
            device = " (Windows reserves this one for a device)" if is_device_name(name) else ""
            raise ConfigError(
                f"{name!r} is no name of a document: letters, digits, - and _, then .bml or .toml{device}"
            )
        return self._folder / name


def _is_ordinary(entry: "os.DirEntry[str]") -> bool:
    try:
        return entry.is_file(follow_symlinks=False)
    except OSError:
        return False


def _read_ordinary(path: Path) -> bytes | None:
    """Reads an ordinary file, one byte more than any document has at most; None where there is none."""
    try:
        file = os.open(path, ORDINARY)
    except OSError:
        return None
    if not stat.S_ISREG(os.fstat(file).st_mode):
        os.close(file)
        return None
    with os.fdopen(file, "rb") as opened:
        return opened.read(MOST_BYTES + 1)
