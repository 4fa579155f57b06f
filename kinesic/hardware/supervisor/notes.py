"""Events of a supervisor, and their rows in the shared memory.

A row has space for `TEXT_SIZE` bytes of text. A longer text continues in the next rows, which have no kind.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

TEXT_SIZE = 400  # [bytes] space for text in one row


@dataclass(frozen=True)
class Note:
    """Supervisor event for planner and log: time, servo, kind and text."""

    clock: float  # [s] of the machine's monotonic clock
    servo: int  # id; -1: no single servo
    kind: str
    text: str


def split_note(note: Note) -> list[tuple[bytes, bytes]]:
    """Return kind and text of each row of an event."""
    text = note.text.encode()
    return [
        (b"" if start else note.kind.encode(), text[start : start + TEXT_SIZE])
        for start in range(0, max(len(text), 1), TEXT_SIZE)
    ]


def join_notes(rows: Iterable[np.void]) -> tuple[Note, ...]:
    """Join consecutive rows of text to supervisor events.

    Continuations without their first row are skipped.
    """
    notes: list[Note] = []
    texts: list[bytes] = []
    for row in rows:
        kind = bytes(row["kind"]).decode(errors="replace")
        if kind:
            notes.append(Note(float(row["clock"]), int(row["servo"]), kind, ""))
            texts.append(bytes(row["text"]))
        elif texts:
            texts[-1] += bytes(row["text"])
    return tuple(replace(note, text=text.decode(errors="replace")) for note, text in zip(notes, texts, strict=True))
