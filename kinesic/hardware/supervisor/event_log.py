"""Every event with its time, one JSON object per line."""

import json
from contextlib import suppress
from pathlib import Path
from time import time as wall_time

from kinesic.hardware.supervisor.channel import Note


class EventLog:
    """A file of events; none if there is no path."""

    def __init__(self, path: Path | None) -> None:
        """Opens the file, to add to it.

        Raises:
            OSError: it cannot be written.
        """
        self._file = path.open("ab", buffering=0) if path is not None else None

    def write(self, note: Note) -> None:
        """One line; lost where the disk is full, which stops no robot."""
        if self._file is not None:
            line = {"time": round(note.clock, 6), "wall": round(wall_time(), 3), "kind": note.kind}
            servo = {"servo": note.servo} if note.servo >= 0 else {}
            with suppress(OSError):
                self._file.write(json.dumps({**line, **servo, "text": note.text}).encode() + b"\n")

    def close(self) -> None:
        """Ends the file."""
        if self._file is not None:
            self._file.close()
