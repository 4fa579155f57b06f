"""Storage of client documents in one folder.

Only plain file names are accepted, and links are never followed, so that nothing outside the folder is accessed.
"""

import hashlib
import os
import re
import stat
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from kinesic.body.config import ConfigError
from kinesic.files.output_file import write_text
from kinesic.files.plain_name import is_device_name
from kinesic.files.unicode_text import check_encodable
from kinesic.host import NO_LINK_FLAG, NO_WAIT_FLAG
from kinesic.serve.desk.versions import Version, VersionFolder

NAME_PATTERN = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}\.(bml|toml)")  # pattern of valid document names
GESTURE_SUFFIX = ".toml"  # file suffix of gesture files
MAX_DOCUMENT_SIZE = 1_000_000  # [bytes] largest document that is read
MAX_LISTED_NAMES = 1000  # largest number of document names in a listing
MAX_SCANNED_ENTRIES = 5000  # largest number of folder entries examined for a listing
MAX_SUGGESTIONS = 20  # largest number of document names in an error message
REVISION_LENGTH = 16  # [hexadecimal digits] length of a revision, the beginning of a SHA-256 digest
OPEN_FLAGS = os.O_RDONLY | NO_LINK_FLAG | NO_WAIT_FLAG  # flags against following links and blocking on pipes


def is_document_name(name: str) -> bool:
    """Return whether this is a valid document name on every operating system."""
    return NAME_PATTERN.fullmatch(name) is not None and not is_device_name(name)


class RevisionError(ConfigError):
    """Refusal to overwrite a file whose revision is not the expected one."""


@dataclass(frozen=True)
class Document:
    """Text of a document, and the revision of its file."""

    text: str
    revision: str  # digest of the file's content


@dataclass(frozen=True)
class Listing:
    """Sorted document names, and whether the list is complete."""

    names: tuple[str, ...]
    is_whole: bool  # whether the listing is complete


class DocumentFolder:
    """Folder with documents (.bml, .toml) of clients."""

    def __init__(self, folder: Path | None) -> None:
        """Open an existing folder for documents.

        With None, all requests are refused.
        """
        self._folder = folder
        self._versions = VersionFolder(folder, max_size=MAX_DOCUMENT_SIZE)

    def list(self) -> Listing:
        """Return the sorted document names and whether the list is complete.

        At most `MAX_SCANNED_ENTRIES` folder entries are examined, and at most `MAX_LISTED_NAMES` names are returned.
        """
        if self._folder is None:
            return Listing((), is_whole=True)
        with os.scandir(self._folder) as entries:
            scanned = tuple(islice(entries, MAX_SCANNED_ENTRIES + 1))
        names = sorted(entry.name for entry in scanned if is_document_name(entry.name) and _is_regular(entry))
        return Listing(
            tuple(names[:MAX_LISTED_NAMES]),
            is_whole=len(names) <= MAX_LISTED_NAMES and len(scanned) <= MAX_SCANNED_ENTRIES,
        )

    def read(self, name: str) -> Document:
        """Return text and revision of a document in the folder.

        Raises:
            ConfigError: the name is invalid, or the document does not exist or is too large.
        """
        raw = _read_regular(self._path(name))
        if raw is None:
            names = self.list().names
            shown = ", ".join(names[:MAX_SUGGESTIONS]) or "none"
            more = f" and {len(names) - MAX_SUGGESTIONS} more" if len(names) > MAX_SUGGESTIONS else ""
            raise ConfigError(f"{name}: there is no such document; there are: {shown}{more}")
        if len(raw) > MAX_DOCUMENT_SIZE:
            raise ConfigError(
                f"{name}: more than {MAX_DOCUMENT_SIZE} bytes, the limit for documents; open it elsewhere"
            )
        return Document(raw.decode("utf-8", "replace"), _revision(raw))

    def read_present(self, name: str) -> str | None:
        """Read the existing file that saving under a name would replace.

        Returns:
            The beginning of the file, "" if it is not a regular file, or None if there is no such file.
        """
        path = self._path(name)
        raw = _read_regular(path)
        if raw is None:
            return "" if os.path.lexists(path) else None
        return raw.decode("utf-8", "replace")

    def check_revision(self, name: str, revision: str | None) -> None:
        """Raise an error if a file's revision is not the expected one.

        Raises:
            RevisionError: such a file exists.
        """
        self._check(name, _read_regular(self._path(name)), revision)

    def save(self, name: str, text: str, revision: str | None = None) -> str:
        """Write a document durably, and keep a replaced one as a version.

        Args:
            name: name of the document.
            text: content of its file.
            revision: revision of the file that may be replaced; "": no file; None: any file.

        Returns:
            The revision of the new file.

        Raises:
            RevisionError: a file of another revision exists.
            ConfigError: the name is invalid, or the document or the version cannot be written.
        """
        path = self._path(name)
        check_encodable(text, place=name)
        content = text.encode("utf-8")
        present = _read_regular(path)
        self._check(name, present, revision)
        if present is not None and present != content:
            if len(present) > MAX_DOCUMENT_SIZE:
                raise ConfigError(
                    f"{name} has more than {MAX_DOCUMENT_SIZE} bytes and is not replaced; choose another name"
                )
            self._versions.keep(name, present)
        write_text(path, text, force=True, durable=True)
        return _revision(content)

    def list_versions(self, name: str) -> tuple[Version, ...]:
        """Return the earlier versions of a document, the newest first.

        Raises:
            ConfigError: the name is invalid.
        """
        self._path(name)
        return self._versions.list(name)

    def read_version(self, name: str, number: int) -> str:
        """Return the text of an earlier version of a document.

        Raises:
            ConfigError: the name is invalid, or there is no such version.
        """
        self._path(name)
        return self._versions.read(name, number)

    def _check(self, name: str, present: bytes | None, revision: str | None) -> None:
        if revision is None or present is None or _revision(present) == revision:
            return
        reason = "was changed by another program" if revision else "exists already"
        raise RevisionError(f"{name} {reason}; save it again without a revision to replace it")

    def _path(self, name: str) -> Path:
        if self._folder is None:
            raise ConfigError("this server keeps no documents: start it with --folder FOLDER")
        if not is_document_name(name):
            device = " (Windows reserves this one for a device)" if is_device_name(name) else ""
            raise ConfigError(
                f"{name!r} is not a document name: use letters, digits, - and _, then .bml or .toml{device}"
            )
        return self._folder / name


def _revision(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:REVISION_LENGTH]


def _is_regular(entry: "os.DirEntry[str]") -> bool:
    try:
        return entry.is_file(follow_symlinks=False)
    except OSError:
        return False


def _read_regular(path: Path) -> bytes | None:
    """Read a regular file, up to one byte beyond the size limit.

    Return None if it is missing, unreadable or not a regular file.
    """
    try:
        file = os.open(path, OPEN_FLAGS)
    except OSError:
        return None
    if not stat.S_ISREG(os.fstat(file).st_mode):
        os.close(file)
        return None
    with os.fdopen(file, "rb") as opened:
        return opened.read(MAX_DOCUMENT_SIZE + 1)
