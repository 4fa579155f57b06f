"""Dry runs of many documents, resumable and in parallel."""

import hashlib
import json
from collections.abc import Callable, Generator, Iterable
from dataclasses import dataclass, replace
from functools import partial
from os import fsencode
from pathlib import Path
from typing import Literal

from kinesic.bml.block import BmlError
from kinesic.bml.reading.document import is_bml_start
from kinesic.controller.dry_run import dry_runs
from kinesic.files.output_file import write_text
from kinesic.files.plain_name import cut_name
from kinesic.files.unicode_text import escape_surrogates
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.setup import Setup
from kinesic.report.checks import Check, checks, grade
from kinesic.report.report import Json, report
from kinesic.session.builtin_documents import locate_document, suggest_document
from kinesic.session.plan import plan
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors
from kinesic.tasks.engine import Engine
from kinesic.tasks.journal import Journal, run_once
from kinesic.tasks.processes import WorkerCrash
from kinesic.tasks.store import JOURNAL_FILE

DocumentOutcome = Literal["performed", "refused", "crashed"]

DOCUMENT_SUFFIXES = (".xml", ".bml")  # file suffixes of documents
SNIFFED_BYTES = 4096  # [bytes] read from a file's start to recognise BML under other suffixes


@dataclass(frozen=True)
class DocumentVerdict:
    """Outcome, behaviours and checks of one document."""

    file: str
    outcome: DocumentOutcome
    exit: int  # exit code of `perform`; 0 for a document refused because of its content
    behaviours: tuple[tuple[str, str], ...] = ()  # (type, outcome)
    checks: tuple[Check, ...] = ()
    error: str = ""
    report: str | None = None  # path of the document's report

    def count(self, outcome: str) -> int:
        """Return the number of behaviours with an outcome, such as `dropped`."""
        return sum(behaviour_outcome == outcome for _, behaviour_outcome in self.behaviours)


def documents(paths: tuple[Path, ...]) -> list[Path]:
    """Return documents given as files or contained in folders, without duplicates.

    Files in folders are sorted; those with other suffixes than .xml and .bml count if their content begins as BML.

    Raises:
        BmlError: a path does not exist.
    """
    files: list[Path] = []
    for path in paths:
        document = locate_document(path)
        if path.is_dir():
            files += sorted(file for file in path.rglob("*") if _is_document(file))
        elif document.exists():
            files.append(document)
        else:
            raise BmlError(f"{path}: no such file or folder{suggest_document(path)}")
    return list(dict.fromkeys(files))


def _is_document(path: Path) -> bool:
    if path.suffix.lower() in DOCUMENT_SUFFIXES:
        return True
    if not path.is_file():  # reading a pipe may block forever
        return False
    try:
        with path.open("rb") as file:
            return is_bml_start(file.read(SNIFFED_BYTES))
    except OSError:
        return False


def validate_documents(
    files: Iterable[Path],
    make_setup: Callable[[], Setup],
    *,
    engine: Engine,
    twins: tuple[Factors, ...] = (NOMINAL_FACTORS,),
    folder: Path | None = None,
    settings: str = "",
) -> Generator[DocumentVerdict, None, None]:
    """Dry-run documents and yield each verdict when it is ready.

    With a folder, each report is written there, and each verdict is recorded at once. A later run with the same folder
    and settings first yields recorded verdicts of unchanged documents. A document that crashes its process is named,
    and the others continue.

    Args:
        files: documents to perform in the twin.
        make_setup: called once in each process; picklable.
        engine: task engine that runs the documents.
        twins: twins that perform; the checks are of the first.
        folder: folder of the reports.
        settings: all other inputs of a verdict as text; a different text discards recorded verdicts.
    """
    tasks = [DocumentTask.of(file, settings) for file in dict.fromkeys(files)]
    journal = Journal(folder / JOURNAL_FILE, DocumentVerdict) if folder else None
    prepare = partial(_prepare, make_setup, twins, reports=folder is not None)
    verdicts = run_once(
        {task: task.key for task in tasks},
        lambda left: engine.run(left, prepare, preload=__name__),
        journal,
        keep=partial(_keep, folder),
        holds=lambda verdict: verdict.report is None or Path(verdict.report).exists(),
    )
    for task, verdict in verdicts:
        yield _crashed(task, verdict, folder) if isinstance(verdict, WorkerCrash) else verdict


@dataclass(frozen=True)
class DocumentTask:
    """A document to dry-run, with its content for remote workers."""

    file: str
    content: bytes | None  # None: not readable here; the worker reports the error
    key: str  # key of the document and the settings

    @classmethod
    def of(cls, file: Path, settings: str) -> "DocumentTask":
        """Read a document file as a task, without content if unreadable."""
        try:
            content = file.read_bytes()
        except OSError:
            content = None
        parts = [settings.encode(), fsencode(file), content or b""]
        return cls(str(file), content, hashlib.sha256(b"\0".join(parts)).hexdigest())

    @property
    def name(self) -> str:
        """File stem of the report, unique among documents with equal names."""
        return f"{cut_name(Path(self.file).stem, limit=200)}-{self.key[:8]}"


def _crashed(task: DocumentTask, crash: WorkerCrash, folder: Path | None) -> DocumentVerdict:
    if folder:
        write_text(folder / f"{task.name}.crash.txt", crash.trace, force=True)
    name = escape_surrogates(task.file)
    return DocumentVerdict(name, "crashed", 1, error=f"{name}: {crash.reason}")


def _keep(folder: Path | None, task: DocumentTask, verdict_and_text: tuple[DocumentVerdict, str]) -> DocumentVerdict:
    verdict, text = verdict_and_text
    if not folder or not text:
        return verdict
    path = folder / f"{task.name}.json"
    write_text(path, text, force=True)
    return replace(verdict, report=escape_surrogates(str(path)))


def _prepare(
    make_setup: Callable[[], Setup], twins: tuple[Factors, ...], *, reports: bool
) -> Callable[[DocumentTask], tuple[DocumentVerdict, str]]:
    setup = make_setup()

    def do(task: DocumentTask) -> tuple[DocumentVerdict, str]:
        verdict, data = judge_document(Path(task.file), setup, twins=twins, content=task.content)
        return verdict, json.dumps(data, indent=1) if reports and data else ""

    return do


def judge_document(
    file: Path, setup: Setup, *, twins: tuple[Factors, ...] = (NOMINAL_FACTORS,), content: bytes | None = None
) -> tuple[DocumentVerdict, dict[str, Json]]:
    """Dry-run one document in the twin and return verdict and report.

    Args:
        file: path of the document.
        setup: setup of the performance.
        twins: twins that perform; the checks are of the first.
        content: content of the file; None reads it.

    Returns:
        The verdict, and the report; empty for a document that is refused before planning.
    """
    name = escape_surrogates(str(file))
    try:
        document = file.read_bytes() if content is None else content
        performance, *other_runs = dry_runs(plan(document, setup, source=name), twins)
    except BmlError as error:
        return DocumentVerdict(name, "refused", 0, error=str(error)), {}
    except OSError as error:
        return DocumentVerdict(name, "refused", 2, error=f"{name}: {error.strerror}"), {}
    data = report(performance, source=name, other_runs=other_runs)
    verdict = judge_performance(name, performance)
    if verdict.behaviours and all(outcome == "dropped" for _, outcome in verdict.behaviours):
        problem = _nothing_left(name, performance)
        return DocumentVerdict(name, "refused", 0, verdict.behaviours, error=problem), data
    return verdict, data


def judge_performance(name: str, performance: DryRun) -> DocumentVerdict:
    """Return behaviours and checks of a performance as a verdict.

    Args:
        name: of the document or of its part.
        performance: in the twin.
    """
    outcomes, results = performance.plan.keyframes.outcomes, checks(performance)
    behaviours = tuple((each.type, outcomes[each.id].kind) for each in performance.plan.timeline.block.behaviours)
    return DocumentVerdict(name, "performed", int(grade(results) == "fail"), behaviours, results)


def _nothing_left(name: str, performance: DryRun) -> str:
    plan = performance.plan
    first = plan.timeline.block.behaviours[0]
    reasons = "; ".join(
        f"{behaviour.id}: {plan.keyframes.outcomes[behaviour.id].why}" for behaviour in plan.timeline.block.behaviours
    )
    robot = plan.setup.robot.name
    return f"{name}:{first.place.line}:{first.place.column}: {robot} can perform none of its behaviours ({reasons})"
