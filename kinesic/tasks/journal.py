"""Journal of a long run as JSON lines.

An interrupted run continues without repeating finished tasks.
"""

from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Generic, TypeVar

import msgspec

from kinesic.files.output_file import new_file, open_to_add
from kinesic.tasks.processes import WorkerCrash

Task = TypeVar("Task")
Result = TypeVar("Result")
Entry = TypeVar("Entry")


class JournalLine(msgspec.Struct, Generic[Entry], frozen=True):
    """One finished task in the journal."""

    key: str  # text of all inputs that determine the result
    entry: Entry


class Journal(Generic[Entry]):
    """Journal file of finished tasks as JSON lines.

    Incomplete lines of a killed process are ignored.
    """

    def __init__(self, path: Path, kind: type[Entry]) -> None:
        """Set the journal's path without reading or writing.

        Args:
            path: path of the file, which need not exist.
            kind: type of the entries, any type that msgspec can read.
        """
        self._path = path
        self._decoder = msgspec.json.Decoder(JournalLine[kind])  # type: ignore[valid-type]  # the type is known only at run time

    def read(self) -> dict[str, Entry]:
        """Read all complete journal lines as key -> entry."""
        return dict(self._entries())

    def rewrite(self, entries: Mapping[str, Entry]) -> None:
        """Replace the journal file atomically by new entries."""
        with new_file(self._path, force=True) as fresh:
            fresh.write_bytes(b"".join(_line(key, entry) for key, entry in entries.items()))

    def append(self, key: str, entry: Entry) -> None:
        """Append one finished task to the journal."""
        with open_to_add(self._path) as file:
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
    return msgspec.json.encode(JournalLine(key, entry)) + b"\n"


def run_once(
    tasks: Mapping[Task, str],
    run: Callable[[list[Task]], Iterable[tuple[Task, Result | WorkerCrash]]],
    journal: Journal[Entry] | None,
    *,
    keep: Callable[[Task, Result], Entry],
    holds: Callable[[Entry], bool] = lambda entry: True,
    forgets: bool = True,
) -> Generator[tuple[Task, Entry | WorkerCrash], None, None]:
    """Run each task once across interrupted runs, and yield the results.

    Results of earlier runs come first. A result is recorded as soon as it is available. A crash is not recorded, so
    that the next run repeats the task.

    Args:
        tasks: task -> key, which contains everything that its result depends on.
        run: runs the remaining tasks and yields each result as soon as it is available, like `Engine.run`.
        journal: journal of the run; None: nothing is recorded.
        keep: converts a result to its entry, and writes files that must exist before the task counts as done.
        holds: returns whether a recorded entry is still valid.
        forgets: whether invalid entries and those of other tasks are removed; a run of several rounds keeps them.
    """
    recorded = journal.read() if journal else {}
    valid = {key: entry for key, entry in recorded.items() if holds(entry)}
    valid = {key: valid[key] for key in tasks.values() if key in valid}
    if journal and forgets:
        journal.rewrite(valid)
    yield from ((task, valid[key]) for task, key in tasks.items() if key in valid)
    left = [task for task, key in tasks.items() if key not in valid]
    for task, result in run(left):
        if isinstance(result, WorkerCrash):
            yield task, result
            continue
        entry = keep(task, result)
        if journal:
            journal.append(tasks[task], entry)
        yield task, entry
