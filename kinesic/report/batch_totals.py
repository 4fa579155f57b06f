"""Counts what became of many documents, of their behaviours, and of every check."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from kinesic.report.batch import DocumentVerdict
from kinesic.report.checks import GRAVITY, Check, CheckStatus, grade
from kinesic.report.report import Json

OUTCOMES = ("performed", "refused", "crashed")
SHARES = ("realised", "partly", "substituted", "dropped")


@dataclass(frozen=True)
class Tally:
    """One check over many documents."""

    name: str
    counts: Mapping[CheckStatus, int]  # documents by status
    worst: Check
    file: str  # where the worst value is


def tallies(verdicts: Iterable[DocumentVerdict]) -> list[Tally]:
    """Counts every check that was made, in the order of the report."""
    found: dict[str, list[tuple[Check, str]]] = {}
    for verdict in verdicts:
        for check in verdict.checks:
            found.setdefault(check.name, []).append((check, verdict.file))
    return [_tally(name, made) for name, made in found.items()]


def _tally(name: str, made: list[tuple[Check, str]]) -> Tally:
    found = {status: sum(check.status == status for check, _ in made) for status in reversed(GRAVITY)}
    worst, file = max(made, key=lambda entry: -entry[0].value if entry[0].at_least else entry[0].value)
    return Tally(name, found, worst, file)


def totals(verdicts: list[DocumentVerdict]) -> dict[str, Json]:
    """Counts documents and behaviours, in all and per folder and type of behaviour, and checks."""
    folders: dict[str, Json] = {}
    for folder in sorted({str(Path(verdict.file).parent) for verdict in verdicts}):
        here = [verdict for verdict in verdicts if str(Path(verdict.file).parent) == folder]
        types = sorted({kind for verdict in here for kind, _ in verdict.behaviours})
        folders[folder] = {
            **counts(here),
            "types": {kind: _shares([o for v in here for k, o in v.behaviours if k == kind]) for kind in types},
        }
    return {**counts(verdicts), "folders": folders, "checks": {tally.name: _json(tally) for tally in tallies(verdicts)}}


def counts(verdicts: list[DocumentVerdict]) -> dict[str, Json]:
    """Counts documents by what became of them, and their behaviours; `failed` and `poor` are among the performed."""
    return {
        "documents": len(verdicts),
        **{outcome: sum(verdict.outcome == outcome for verdict in verdicts) for outcome in OUTCOMES},
        "failed": sum(verdict.outcome == "performed" and verdict.exit > 0 for verdict in verdicts),
        "poor": sum(grade(verdict.checks) == "poor" for verdict in verdicts),
        **_shares([outcome for verdict in verdicts for _, outcome in verdict.behaviours]),
    }


def _shares(outcomes: list[str]) -> dict[str, Json]:
    return {name: outcomes.count(name) for name in SHARES}


def _json(tally: Tally) -> dict[str, Json]:
    return {
        **dict[str, Json](tally.counts.items()),
        "worst": tally.worst.value,
        "limit": tally.worst.limit,
        "unit": tally.worst.unit,
        "where": tally.worst.where,
        "file": tally.file,
    }
