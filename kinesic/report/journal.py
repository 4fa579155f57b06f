"""What is done of a long run, one line of JSON each, so that an interrupted run can go on."""

from collections.abc import Iterator
from pathlib import Path
from typing import Generic, TypeVar

import msgspec

Entry = TypeVar("Entry")


class Line(msgspec.Struct, Generic[Entry], frozen=True):
    """One finished piece of work."""

    key: str  # everything that its result depends on
    entry: Entry


class Journal(Generic[Entry]):
    """A file of finished work. A line counts when it is whole; what a killed process began to write does not."""

    def __init__(self, path: Path, kind: type[Entry]) -> None:
        """Names the file; nothing is read or written yet.

        Args:
            path: of the file; it need not exist.
            kind: of the entries, any type that msgspec can read.
        """
        self._path = path
        self._decoder = msgspec.json.Decoder(Line[kind])  # type: ignore[valid-type]  # a type that is known at run time

    def read(self) -> dict[str, Entry]:
        """Key -> entry of every whole line."""
        return dict(self._entries())

    def rewrite(self, entries: dict[str, Entry]) -> None:
        """Replaces the file by these entries, at once."""
        fresh = self._path.with_suffix(".new")
        fresh.write_bytes(b"".join(_line(key, entry) for key, entry in entries.items()))
        fresh.replace(self._path)

    def append(self, key: str, entry: Entry) -> None:
        """Adds one finished piece of work."""
        with self._path.open("ab") as file:
            file.write(_line(key, entry))

    def _entries(self) -> Iterator[tuple[str, Entry]]:
        if not self._path.exists():
            return
        for text in self._path.read_bytes().splitlines(keepends=True):
            if not text.endswith(b"\n"):
                return
            try:
                line = self._decoder.decode(text)
            except msgspec.DecodeError:
                continue
            yield line.key, line.entry


def _line(key: str, entry: object) -> bytes:
    return msgspec.json.encode(Line(key, entry)) + b"\n"
