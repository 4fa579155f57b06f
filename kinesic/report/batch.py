"""Dry-runs many documents in processes of their own, and goes on where an interrupted run stopped.

What is done of a long run is noted in a journal, one line of JSON each.
"""

import hashlib
import json
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Generic, Literal, TypeVar

import msgspec

from kinesic.bml.block import BmlError
from kinesic.bml.reading.document import begins_as_bml
from kinesic.controller.perform import performances
from kinesic.controller.performance import Performance
from kinesic.files.output_file import new_file, open_to_add, write_text
from kinesic.planning.setup import Setup
from kinesic.report.checks import Check, checks
from kinesic.report.report import Json, report
from kinesic.report.worker_pool import WorkerCrash, run_pool
from kinesic.sim.servo_factors import NOMINAL, Factors

Outcome = Literal["performed", "refused", "crashed"]

Entry = TypeVar("Entry")
SUFFIXES = (".xml", ".bml")
HEAD = 4096  # [bytes] of a file of another ending that tell what it is
JOURNAL = "finished.jsonl"


class BatchLine(msgspec.Struct, Generic[Entry], frozen=True):
    """One finished piece of work."""

    key: str  # everything that its result depends on
    entry: Entry


class BatchJournal(Generic[Entry]):
    """A file of finished work. A line counts when it is whole; what a killed process began to write does not."""

    def __init__(self, path: Path, kind: type[Entry]) -> None:
        """Names the file; nothing is read or written yet.

        Args:
            path: of the file; it need not exist.
            kind: of the entries, any type that msgspec can read.
        """
        self._path = path
        self._decoder = msgspec.json.Decoder(BatchLine[kind])  # type: ignore[valid-type]  # a type that is known at run time

    def read(self) -> dict[str, Entry]:
        """Reads every whole line: key -> entry."""
        return dict(self._entries())

    def rewrite(self, entries: dict[str, Entry]) -> None:
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
    return msgspec.json.encode(BatchLine(key, entry)) + b"\n"


@dataclass(frozen=True)
class DocumentVerdict:
    """What became of one document."""

    file: str
    outcome: Outcome
    exit: int  # as `perform` would end; 0 for a well-founded refusal
    behaviours: tuple[tuple[str, str], ...] = ()  # (type, outcome)
    checks: tuple[Check, ...] = ()
    error: str = ""
    report: str | None = None  # path of its report

    def count(self, outcome: str) -> int:
        """How many behaviours had this outcome."""
        return sum(found == outcome for _, found in self.behaviours)


def documents(paths: tuple[Path, ...]) -> list[Path]:
    """Finds the BML and XML files below folders in order of their names, beside files that are named; each once.

    A file with another ending is one of them where its content begins as BML.

    Raises:
        BmlError: a path does not exist.
    """
    found: list[Path] = []
    for path in paths:
        if path.is_dir():
            found += sorted(file for file in path.rglob("*") if _is_document(file))
        elif path.exists():
            found.append(path)
        else:
            raise BmlError(f"{path}: no such file or folder")
    return list(dict.fromkeys(found))


def _is_document(path: Path) -> bool:
    if path.suffix.lower() in SUFFIXES:
        return True
    if not path.is_file():  # whoever opens a pipe may wait for ever
        return False
    try:
        with path.open("rb") as file:
            return begins_as_bml(file.read(HEAD))
    except OSError:
        return False


def validate_documents(
    files: Iterable[Path],
    make_setup: Callable[[], Setup],
    *,
    jobs: int,
    twins: tuple[Factors, ...] = (NOMINAL,),
    folder: Path | None = None,
    settings: str = "",
) -> Generator[DocumentVerdict, None, None]:
    """Dry-runs documents; verdicts come in the order in which they are ready, those of an earlier run first.

    With a folder, each report is written there, and each verdict is noted as soon as it is known: a run with the same
    folder takes over what is noted of documents that did not change, under the same settings. A document that kills
    its process is named, and the others go on.

    Args:
        files: to be performed in the twin.
        make_setup: called once in each process; picklable.
        jobs: number of processes.
        twins: who performs; the checks are of the first.
        folder: of the reports.
        settings: everything beside a document that its verdict depends on; another text makes a fresh start.
    """
    tasks = {file: _key(file, settings) for file in files}
    journal = BatchJournal(folder / JOURNAL, DocumentVerdict) if folder else None
    known = _resumed(journal, tasks) if journal else {}
    yield from known.values()
    left = [file for file in tasks if file not in known]
    prepare = partial(_prepare, make_setup, twins, folder, tasks)
    for file, result in run_pool(left, prepare, jobs=jobs, preload=__name__):
        verdict = _crashed(file, result, folder, tasks[file]) if isinstance(result, WorkerCrash) else result
        if journal:
            journal.append(tasks[file], verdict)
        yield verdict


def _key(file: Path, settings: str) -> str:
    try:
        content = file.read_bytes()
    except OSError:
        content = b""
    return hashlib.sha256(b"\0".join([settings.encode(), str(file).encode(), content])).hexdigest()


def _resumed(journal: BatchJournal[DocumentVerdict], tasks: dict[Path, str]) -> dict[Path, DocumentVerdict]:
    """Verdicts that still hold; a crash is tried again."""
    noted = journal.read()
    known = {
        file: noted[key]
        for file, key in tasks.items()
        if key in noted
        and noted[key].outcome != "crashed"
        and ((path := noted[key].report) is None or Path(path).exists())
    }
    journal.rewrite({tasks[file]: verdict for file, verdict in known.items()})
    return known


def _crashed(file: Path, crash: WorkerCrash, folder: Path | None, key: str) -> DocumentVerdict:
    if folder:
        write_text(folder / f"{_name(file, key)}.crash.txt", crash.trace, force=True)
    return DocumentVerdict(str(file), "crashed", 1, error=f"{file}: {crash.reason}")


def _prepare(
    make_setup: Callable[[], Setup], twins: tuple[Factors, ...], folder: Path | None, tasks: dict[Path, str]
) -> Callable[[Path], DocumentVerdict]:
    known = make_setup()

    def do(file: Path) -> DocumentVerdict:
        verdict, data = judge(file, known, twins=twins)
        if not folder or not data:
            return verdict
        path = folder / f"{_name(file, tasks[file])}.json"
        write_text(path, json.dumps(data, indent=1), force=True)
        return replace(verdict, report=str(path))

    return do


def _name(file: Path, key: str) -> str:
    """Of a report: two documents of one name in two folders have two."""
    return f"{file.stem}-{key[:8]}"


def judge(
    file: Path, known: Setup, *, twins: tuple[Factors, ...] = (NOMINAL,)
) -> tuple[DocumentVerdict, dict[str, Json]]:
    """Performs one document in the twin.

    Returns:
        The verdict, and the report; empty for a document that is refused before anything is planned.
    """
    try:
        performance, *beside = performances(file.read_bytes(), twins, known, source=str(file))
    except BmlError as error:
        return DocumentVerdict(str(file), "refused", 0, error=str(error)), {}
    except OSError as error:
        return DocumentVerdict(str(file), "refused", 2, error=f"{file}: {error.strerror}"), {}
    data = report(performance, source=str(file), beside=beside)
    outcomes = performance.plan.keyframes.outcomes
    behaviours = tuple((b.type, outcomes[b.id].kind) for b in performance.plan.timeline.block.behaviours)
    if behaviours and all(outcome == "dropped" for _, outcome in behaviours):
        return DocumentVerdict(str(file), "refused", 0, behaviours, error=_nothing_left(file, performance)), data
    return DocumentVerdict(str(file), "performed", 0 if data["ok"] else 1, behaviours, checks(performance)), data


def _nothing_left(file: Path, performance: Performance) -> str:
    plan = performance.plan
    first = plan.timeline.block.behaviours[0]
    reasons = "; ".join(
        f"{behaviour.id}: {plan.keyframes.outcomes[behaviour.id].why}" for behaviour in plan.timeline.block.behaviours
    )
    robot = plan.setup.robot.name
    return f"{file}:{first.place.line}:{first.place.column}: {robot} can perform none of its behaviours ({reasons})"
