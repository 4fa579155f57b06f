"""Earlier versions of saved documents, the last ten of each.

The versions of `tea.bml` are `tea.0001.bml`, `tea.0002.bml` and so on.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from kinesic.body.config import ConfigError
from kinesic.files.held_file import read_held, replace_held
from kinesic.files.held_folder import HeldFolder
from kinesic.serve.desk.archive import hold_archive

MAX_VERSIONS = 10  # largest number of versions of one document
VERSION_PATTERN = re.compile(r"([A-Za-z0-9_-]+)\.([0-9]{4,9})(\.[a-z]+)")  # stem, number and suffix of a version


@dataclass(frozen=True)
class Version:
    """Earlier version of a document."""

    number: int
    time: float  # [s] Unix time at which a newer text replaced this version


class VersionFolder:
    """Earlier versions of the documents of a folder."""

    def __init__(self, folder: Path | None, *, max_size: int) -> None:
        """Create the version store of a document folder.

        Args:
            folder: document folder; None refuses all requests.
            max_size: largest document that is read [bytes].
        """
        self._folder, self._max_size = folder, max_size

    def keep(self, name: str, content: bytes) -> None:
        """Store replaced content as a new version, and keep the last ten.

        Content equal to the newest version is not stored again.

        Args:
            name: valid name of the document.
            content: content of its file.

        Raises:
            ConfigError: the version is not stored.
        """
        with hold_archive(self._folder) as archive:
            numbers = sorted(_numbers(archive, name))
            last = numbers[-1] if numbers else 0
            if numbers and read_held(archive, _version_name(name, last), limit=self._max_size + 1) == content:
                return
            replace_held(archive, _version_name(name, last + 1), content)
            for number in numbers[: max(0, len(numbers) + 1 - MAX_VERSIONS)]:
                archive.remove_entry(_version_name(name, number))

    def list(self, name: str) -> tuple[Version, ...]:
        """Return the versions of a document, the newest first."""
        with hold_archive(self._folder) as archive:
            numbers = sorted(_numbers(archive, name), reverse=True)
            return tuple(
                Version(number, archive.entry_status(_version_name(name, number)).st_mtime) for number in numbers
            )

    def read(self, name: str, number: int) -> str:
        """Return the text of a version.

        Raises:
            ConfigError: there is no such version.
        """
        with hold_archive(self._folder) as archive:
            content = None
            if number in _numbers(archive, name):
                content = read_held(archive, _version_name(name, number), limit=self._max_size)
        if content is None:
            numbers = ", ".join(str(version.number) for version in self.list(name)) or "none"
            raise ConfigError(f"{name}: there is no version {number}; there are: {numbers}")
        return content.decode("utf-8", "replace")


def _version_name(name: str, number: int) -> str:
    stem, _, suffix = name.rpartition(".")
    return f"{stem}.{number:04d}.{suffix}"


def _numbers(archive: HeldFolder, name: str) -> Iterator[int]:
    """Yield the numbers of a document's versions in any order."""
    for entry in archive.names():
        match = VERSION_PATTERN.fullmatch(entry)
        if match is not None and f"{match[1]}{match[3]}" == name:
            yield int(match[2])
