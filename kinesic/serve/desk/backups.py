"""Backups of unsaved documents, sent by clients while a person edits.

A backup is one of twenty files with fixed names. Its first line is a JSON object with key, document name, revision and
time; the text of the document follows unchanged. The key of a client is compared only, never used as a name.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from time import time as unix_time

import msgspec

from kinesic.body.config import ConfigError
from kinesic.files.held_file import read_held, replace_held
from kinesic.files.held_folder import HeldFolder
from kinesic.files.unicode_text import check_encodable
from kinesic.serve.desk.archive import hold_archive, remove_abandoned_files

MAX_BACKUPS = 20  # largest number of backups; a further one replaces the oldest
BACKUP_FILES = tuple(f"backup_{number:02d}.txt" for number in range(1, MAX_BACKUPS + 1))  # fixed names of the files
MAX_HEADER_SIZE = 1000  # [bytes] largest first line of a backup
MAX_TEXT_SIZE = 1_000_000  # [bytes] largest document in a backup


class Header(msgspec.Struct, frozen=True):
    """First line of a backup."""

    key: str  # key of the edited document, chosen by its client
    name: str  # name of the document
    revision: str  # revision of the saved file that was edited; empty without a saved file
    time: float  # [s] Unix time of the text, by the clock of the client if it has sent a time


@dataclass(frozen=True)
class Backup:
    """Backup of an unsaved document."""

    header: Header
    text: str


class BackupFolder:
    """Backups of unsaved documents in the archive of a document folder."""

    def __init__(self, folder: Path | None) -> None:
        """Create the backup store of a document folder.

        With None, all requests are refused.
        """
        self._folder = folder

    def keep(self, key: str, name: str, revision: str, text: str, *, time: float | None = None) -> None:
        """Store an unsaved document durably, and replace its earlier backup.

        A new key replaces the oldest of `MAX_BACKUPS` backups.

        Args:
            key: key of the edited document, chosen by its client.
            name: name of the document.
            revision: revision of the saved file that was edited.
            text: text of the document.
            time: Unix time [s] of the text, by the client's clock; None for the present time.

        Raises:
            ConfigError: the backup is not stored.
        """
        for shown, value in (("the key", key), ("the name", name), ("the revision", revision), ("the text", text)):
            check_encodable(value, place=f"{shown} of the backup")
        content = text.encode("utf-8")
        if len(content) > MAX_TEXT_SIZE:
            raise ConfigError(f"{name}: more than {MAX_TEXT_SIZE} bytes, the limit for backups; save it elsewhere")
        header = msgspec.json.encode(Header(key, name, revision, unix_time() if time is None else time))
        with hold_archive(self._folder) as archive:
            replace_held(archive, _choose_file(dict(_headers(archive)), key), header + b"\n" + content)

    def discard(self, key: str) -> None:
        """Remove the backup with a key, if it exists."""
        with hold_archive(self._folder) as archive:
            for file, header in _headers(archive):
                if header.key == key:
                    archive.remove_entry(file)

    def list(self) -> tuple[Header, ...]:
        """Return the headers of all backups, the newest first."""
        with hold_archive(self._folder) as archive:
            remove_abandoned_files(archive)
            return tuple(sorted((header for _, header in _headers(archive)), key=lambda header: -header.time))

    def read(self, key: str) -> Backup:
        """Return the backup with a key.

        Raises:
            ConfigError: there is no such backup.
        """
        with hold_archive(self._folder) as archive:
            for file, header in _headers(archive):
                content = read_held(archive, file, limit=MAX_HEADER_SIZE + MAX_TEXT_SIZE)
                if header.key == key and content is not None:
                    text = content.partition(b"\n")[2].decode("utf-8")
                    return Backup(header, text)
        raise ConfigError(f"there is no backup {key!r}; it may have been saved or discarded by another page")


def _choose_file(headers: dict[str, Header], key: str) -> str:
    """Return the file for a key's backup: present, unused or oldest file."""
    for file, header in headers.items():
        if header.key == key:
            return file
    unused = next((file for file in BACKUP_FILES if file not in headers), None)
    return unused or min(headers, key=lambda file: headers[file].time)


def _headers(archive: HeldFolder) -> Iterator[tuple[str, Header]]:
    """Yield file name and header of each valid backup."""
    for file in BACKUP_FILES:
        beginning = read_held(archive, file, limit=MAX_HEADER_SIZE)
        if beginning is None:
            continue
        try:
            yield file, msgspec.json.decode(beginning.partition(b"\n")[0], type=Header)
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
            continue
