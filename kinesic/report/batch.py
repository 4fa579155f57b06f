"""Dry-runs many documents by an engine of tasks, and goes on where an interrupted run stopped."""

import hashlib
import json
from collections.abc import Callable, Generator, Iterable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Literal

from kinesic.bml.block import BmlError
from kinesic.bml.reading.document import begins_as_bml
from kinesic.controller.perform import performances
from kinesic.controller.performance import Performance
from kinesic.files.output_file import write_text
from kinesic.files.plain_name import cut_name
from kinesic.planning.setup import Setup
from kinesic.report.checks import Check, checks
from kinesic.report.report import Json, report
from kinesic.sim.servo_factors import NOMINAL, Factors
from kinesic.tasks.engine import Engine
from kinesic.tasks.journal import Journal, run_once
from kinesic.tasks.processes import WorkerCrash
from kinesic.tasks.store import JOURNAL

DocumentOutcome = Literal["performed", "refused", "crashed"]

SUFFIXES = (".xml", ".bml")
HEADER = 4096  # [bytes] of a file of another ending that tell what it is


@dataclass(frozen=True)
class DocumentVerdict:
    """What became of one document."""

    file: str
    outcome: DocumentOutcome
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
            return begins_as_bml(file.read(HEADER))
    except OSError:
        return False


def validate_documents(
    files: Iterable[Path],
    make_setup: Callable[[], Setup],
    *,
    engine: Engine,
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
        engine: does it.
        twins: who performs; the checks are of the first.
        folder: of the reports.
        settings: everything beside a document that its verdict depends on; another text makes a fresh start.
    """
    tasks = [DocumentTask.of(file, settings) for file in dict.fromkeys(files)]
    journal = Journal(folder / JOURNAL, DocumentVerdict) if folder else None
    found = run_once(
        {task: task.key for task in tasks},
        partial(_prepare, make_setup, twins, reports=folder is not None),
        engine,
        journal,
        keep=partial(_keep, folder),
        holds=lambda verdict: verdict.report is None or Path(verdict.report).exists(),
        preload=__name__,
    )
    for task, verdict in found:
        yield _crashed(task, verdict, folder) if isinstance(verdict, WorkerCrash) else verdict


@dataclass(frozen=True)
class DocumentTask:
    """A document that is to be judged, as workers get it: they need not see the folder that it lies in."""

    file: str
    content: bytes | None  # None: it cannot be read here, and whoever tries says why
    key: str  # of the document and the settings

    @classmethod
    def of(cls, file: Path, settings: str) -> "DocumentTask":
        """Reads a document."""
        try:
            content = file.read_bytes()
        except OSError:
            content = None
        parts = [settings.encode(), str(file).encode(), content or b""]
        return cls(str(file), content, hashlib.sha256(b"\0".join(parts)).hexdigest())

    @property
    def name(self) -> str:
        """Of its report: two documents of one name in two folders have two."""
        return f"{cut_name(Path(self.file).stem, limit=200)}-{self.key[:8]}"


def _crashed(task: DocumentTask, crash: WorkerCrash, folder: Path | None) -> DocumentVerdict:
    if folder:
        write_text(folder / f"{task.name}.crash.txt", crash.trace, force=True)
    return DocumentVerdict(task.file, "crashed", 1, error=f"{task.file}: {crash.reason}")


def _keep(folder: Path | None, task: DocumentTask, found: tuple[DocumentVerdict, str]) -> DocumentVerdict:
    verdict, text = found
    if not folder or not text:
        return verdict
    path = folder / f"{task.name}.json"
    write_text(path, text, force=True)
    return replace(verdict, report=str(path))


def _prepare(
    make_setup: Callable[[], Setup], twins: tuple[Factors, ...], *, reports: bool
) -> Callable[[DocumentTask], tuple[DocumentVerdict, str]]:
    known = make_setup()

    def do(task: DocumentTask) -> tuple[DocumentVerdict, str]:
        verdict, data = judge(Path(task.file), known, twins=twins, content=task.content)
        return verdict, json.dumps(data, indent=1) if reports and data else ""

    return do


def judge(
    file: Path, known: Setup, *, twins: tuple[Factors, ...] = (NOMINAL,), content: bytes | None = None
) -> tuple[DocumentVerdict, dict[str, Json]]:
    """Performs one document in the twin.

    Args:
        file: its path.
        known: who performs it.
        twins: who performs; the checks are of the first.
        content: of the file; None: it is read.

    Returns:
        The verdict, and the report; empty for a document that is refused before anything is planned.
    """
    try:
        performance, *beside = performances(
            file.read_bytes() if content is None else content, twins, known, source=str(file)
        )
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
