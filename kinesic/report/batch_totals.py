"""Totals of outcomes, behaviours and checks over many documents."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from kinesic.report.batch import DocumentVerdict
from kinesic.report.checks import SEVERITY_RANKS, Check, CheckStatus, grade
from kinesic.report.report import Json

DOCUMENT_OUTCOMES = ("performed", "refused", "crashed")  # possible results of a document
BEHAVIOUR_OUTCOMES = ("realised", "partly", "substituted", "dropped")  # possible results of a behaviour


@dataclass(frozen=True)
class Tally:
    """Results of one check over many documents."""

    name: str
    counts: Mapping[CheckStatus, int]  # documents by status
    worst: Check
    file: str  # document with the worst value


def tallies(verdicts: Iterable[DocumentVerdict]) -> list[Tally]:
    """Count the results of every check over many documents."""
    checks_by_name: dict[str, list[tuple[Check, str]]] = {}
    for verdict in verdicts:
        for check in verdict.checks:
            checks_by_name.setdefault(check.name, []).append((check, verdict.file))
    return [_tally(name, results) for name, results in checks_by_name.items()]


def _tally(name: str, results: list[tuple[Check, str]]) -> Tally:
    counts_by_status = {
        status: sum(check.status == status for check, _ in results) for status in reversed(SEVERITY_RANKS)
    }
    worst, file = max(results, key=lambda entry: -entry[0].value if entry[0].at_least else entry[0].value)
    return Tally(name, counts_by_status, worst, file)


def totals(verdicts: list[DocumentVerdict]) -> dict[str, Json]:
    """Count documents and behaviours by folder, and check results overall."""
    folders: dict[str, Json] = {}
    for folder in sorted({str(Path(verdict.file).parent) for verdict in verdicts}):
        here = [verdict for verdict in verdicts if str(Path(verdict.file).parent) == folder]
        types = sorted({kind for verdict in here for kind, _ in verdict.behaviours})
        folders[folder] = {
            **counts(here),
            "types": {kind: _shares([o for v in here for k, o in v.behaviours if k == kind]) for kind in types},
        }
    return {**counts(verdicts), "folders": folders, "checks": worst_checks(verdicts)}


def worst_checks(verdicts: Iterable[DocumentVerdict]) -> dict[str, Json]:
    """Return counts and worst value of every check, by its name."""
    return {tally.name: _json(tally) for tally in tallies(verdicts)}


def counts(verdicts: list[DocumentVerdict]) -> dict[str, Json]:
    """Count documents and behaviours by outcome.

    Documents that are `failed` or `poor` are also counted as performed.
    """
    return {
        "documents": len(verdicts),
        **{outcome: sum(verdict.outcome == outcome for verdict in verdicts) for outcome in DOCUMENT_OUTCOMES},
        "failed": sum(verdict.outcome == "performed" and verdict.exit > 0 for verdict in verdicts),
        "poor": sum(grade(verdict.checks) == "poor" for verdict in verdicts),
        **_shares([outcome for verdict in verdicts for _, outcome in verdict.behaviours]),
    }


def _shares(outcomes: list[str]) -> dict[str, Json]:
    return {name: outcomes.count(name) for name in BEHAVIOUR_OUTCOMES}


def _json(tally: Tally) -> dict[str, Json]:
    return {
        **dict[str, Json](tally.counts.items()),
        "worst": tally.worst.value,
        "limit": tally.worst.limit,
        "unit": tally.worst.unit,
        "where": tally.worst.where,
        "file": tally.file,
    }
