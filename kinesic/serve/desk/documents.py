"""Keeps documents of clients in one folder: by plain names, never through a link, nothing outside it."""

import re
from pathlib import Path

from kinesic.body.config import ConfigError
from kinesic.files.output_file import write_text

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}\.(bml|toml)")
MOST_BYTES = 1_000_000  # of a document that is read


class DocumentFolder:
    """The documents (.bml, .toml) of a folder."""

    def __init__(self, folder: Path | None) -> None:
        """Takes a folder that is there; None: there is none, and everything is refused."""
        self._folder = folder

    def names(self) -> tuple[str, ...]:
        """Lists the documents."""
        if self._folder is None:
            return ()
        return tuple(sorted(each.name for each in self._folder.iterdir() if self._is_document(each)))

    def read(self, name: str) -> str:
        """Reads a document.

        Raises:
            ConfigError: there is no such document.
        """
        path = self._path(name)
        if not self._is_document(path) or path.stat().st_size > MOST_BYTES:
            raise ConfigError(f"{name}: there is no such document; there are: {', '.join(self.names()) or 'none'}")
        return path.read_bytes().decode("utf-8", "replace")

    def save(self, name: str, text: str) -> None:
        """Writes a document, byte for byte; one of this name is replaced.

        Raises:
            ConfigError: it is no name of a document, or it cannot be written.
        """
        write_text(self._path(name), text, force=True)

    def _path(self, name: str) -> Path:
        if self._folder is None:
            raise ConfigError("this server keeps no documents: start it with --folder FOLDER")
        if NAME.fullmatch(name) is None:
            raise ConfigError(f"{name!r} is no name of a document: letters, digits, - and _, then .bml or .toml")
        return self._folder / name

    def _is_document(self, path: Path) -> bool:
        return NAME.fullmatch(path.name) is not None and path.is_file() and not path.is_symlink()
