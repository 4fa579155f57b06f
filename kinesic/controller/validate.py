"""Dry-runs many documents in parallel processes."""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from kinesic.bml.block import BmlError
from kinesic.controller.facts import Facts
from kinesic.controller.perform import perform
from kinesic.controller.performance import Performance
from kinesic.controller.report import Json, report

SUFFIXES = (".xml", ".bml")


@dataclass(frozen=True)
class Verdict:
    """What became of one document."""

    file: str
    outcome: Literal["performed", "refused"]
    exit: int  # as `perform` would end; 0 for a well-founded refusal
    behaviours: tuple[tuple[str, str], ...] = ()  # (type, outcome)
    report: dict[str, Json] = field(default_factory=dict)
    error: str = ""

    def count(self, outcome: str) -> int:
        """How many behaviours had this outcome."""
        return sum(found == outcome for _, found in self.behaviours)


def documents(paths: tuple[Path, ...]) -> list[Path]:
    """Files, and the BML and XML files below folders, in order of their names.

    Raises:
        BmlError: a path does not exist.
    """
    found: list[Path] = []
    for path in paths:
        if path.is_dir():
            found += sorted(file for file in path.rglob("*") if file.suffix.lower() in SUFFIXES)
        elif path.exists():
            found.append(path)
        else:
            raise BmlError(f"{path}: no such file or folder")
    return found


def validate(files: list[Path], make_facts: Callable[[], Facts], *, jobs: int | None = None) -> Iterator[Verdict]:
    """Dry-runs documents; verdicts come in the order in which they are ready.

    Args:
        files: to be performed in the twin.
        make_facts: called once in each process.
        jobs: number of processes; as many as there are cores if not given.
    """
    workers = min(jobs or os.cpu_count() or 1, max(1, len(files)))
    if workers == 1:
        known = make_facts()
        yield from (judge(file, known) for file in files)
        return
    with ProcessPoolExecutor(workers, initializer=_prepare, initargs=(make_facts,)) as pool:
        for future in as_completed([pool.submit(_judge, file) for file in files]):
            yield future.result()


_known: list[Facts] = []  # of this worker process


def _prepare(make_facts: Callable[[], Facts]) -> None:
    _known.append(make_facts())


def _judge(file: Path) -> Verdict:
    return judge(file, _known[0])


def judge(file: Path, known: Facts) -> Verdict:
    """Performs one document in the twin."""
    try:
        performance = perform(file.read_bytes(), known, source=str(file))
    except BmlError as error:
        return Verdict(str(file), "refused", 0, error=str(error))
    except OSError as error:
        return Verdict(str(file), "refused", 2, error=f"{file}: {error.strerror}")
    data = report(performance, source=str(file))
    outcomes = performance.plan.keyframes.outcomes
    behaviours = tuple((b.type, outcomes[b.id].kind) for b in performance.plan.timeline.block.behaviours)
    if behaviours and all(outcome == "dropped" for _, outcome in behaviours):
        return Verdict(str(file), "refused", 0, behaviours, data, _nothing_left(file, performance))
    return Verdict(str(file), "performed", 0 if data["ok"] else 1, behaviours, data)


def _nothing_left(file: Path, performance: Performance) -> str:
    """Why a document of which everything was dropped does not count as performed."""
    plan = performance.plan
    first = plan.timeline.block.behaviours[0]
    reasons = "; ".join(
        f"{behaviour.id}: {plan.keyframes.outcomes[behaviour.id].why}" for behaviour in plan.timeline.block.behaviours
    )
    robot = plan.facts.robot.name
    return f"{file}:{first.place.line}:{first.place.column}: {robot} can perform none of its behaviours ({reasons})"


def totals(verdicts: list[Verdict]) -> dict[str, Json]:
    """Counts over documents and behaviours, in all and per folder and type of behaviour."""
    folders: dict[str, Json] = {}
    for folder in sorted({str(Path(verdict.file).parent) for verdict in verdicts}):
        here = [verdict for verdict in verdicts if str(Path(verdict.file).parent) == folder]
        types = sorted({kind for verdict in here for kind, _ in verdict.behaviours})
        folders[folder] = {
            **_counts(here),
            "types": {kind: _shares([o for v in here for k, o in v.behaviours if k == kind]) for kind in types},
        }
    return {**_counts(verdicts), "folders": folders}


def _counts(verdicts: list[Verdict]) -> dict[str, Json]:
    return {
        "documents": len(verdicts),
        "performed": sum(verdict.outcome == "performed" for verdict in verdicts),
        "refused": sum(verdict.outcome == "refused" for verdict in verdicts),
        **_shares([outcome for verdict in verdicts for _, outcome in verdict.behaviours]),
    }


def _shares(outcomes: list[str]) -> dict[str, Json]:
    return {name: outcomes.count(name) for name in ("realised", "substituted", "dropped")}
