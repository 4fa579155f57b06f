"""Notes what of a long run is done, one line of JSON each: it goes on where it stopped, and does nothing twice."""

from collections.abc import Callable, Generator, Iterator, Mapping
from pathlib import Path
from typing import Generic, TypeVar

import msgspec

from kinesic.files.output_file import new_file, open_to_add
from kinesic.tasks.engine import Engine
from kinesic.tasks.processes import WorkerCrash

Task = TypeVar("Task")
Result = TypeVar("Result")
Entry = TypeVar("Entry")


class JournalLine(msgspec.Struct, Generic[Entry], frozen=True):
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
        self._decoder = msgspec.json.Decoder(JournalLine[kind])  # type: ignore[valid-type]  # a type that is known at run time

    def read(self) -> dict[str, Entry]:
        """Reads every whole line: key -> entry."""
        return dict(self._entries())

    def rewrite(self, entries: Mapping[str, Entry]) -> None:
        """Replaces the file by these entries, at once."""
        with new_file(self._path, force=True) as fresh:
            fresh.write_bytes(b"".join(_line(key, entry) for key, entry in entries.items()))

    def append(self, key: str, entry: Entry) -> None:
        """Adds one finished piece of work."""
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
    prepare: Callable[[], Callable[[Task], Result]],
    engine: Engine,
    journal: Journal[Entry] | None,
    *,
    keep: Callable[[Task, Result], Entry],
    holds: Callable[[Entry], bool] = lambda entry: True,
    forgets: bool = True,
    preload: str = "",
) -> Generator[tuple[Task, Entry | WorkerCrash], None, None]:
    """Yields each task with its result once: those of earlier runs first, from the journal, then what is left.

    A result is noted as soon as it is known, and a crash is not: the next run tries it again.

    Args:
        tasks: each with its key, which says everything that its result depends on.
        prepare: called once in each worker, gives the function that does a task; picklable.
        engine: does them.
        journal: of the run; None: nothing is remembered.
        keep: makes of a result what is noted, and writes here what shall be in a file before it counts as done.
        holds: whether a result that is noted still counts.
        forgets: whether the journal loses what is of no task; a run of several rounds keeps that.
        preload: module that workers begin with.
    """
    noted = journal.read() if journal else {}
    known = {key: entry for key, entry in noted.items() if holds(entry)}
    known = {key: known[key] for key in tasks.values() if key in known}
    if journal and forgets:
        journal.rewrite(known)
    yield from ((task, known[key]) for task, key in tasks.items() if key in known)
    left = [task for task, key in tasks.items() if key not in known]
    for task, result in engine.run(left, prepare, preload=preload):
        if isinstance(result, WorkerCrash):
            yield task, result
            continue
        entry = keep(task, result)
        if journal:
            journal.append(tasks[task], entry)
        yield task, entry
