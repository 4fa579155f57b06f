"""Many verdicts on one screen: what was refused or failed, then documents by folder, then the checks."""

from os.path import commonpath
from pathlib import Path

from rich.console import Console
from rich.table import Table

from kinesic.cli.plain_words import printable
from kinesic.cli.summary import COLOURS
from kinesic.cli.terminal import quote_text
from kinesic.report.batch import DocumentVerdict
from kinesic.report.batch_totals import OUTCOMES, SHARES, counts, tallies
from kinesic.report.checks import GRAVITY

BEYOND = {"fail": "failed", "poor": "poor"}
MOST_ROWS = 16  # of folders; with more, folders are counted together


def summarise(verdicts: list[DocumentVerdict], screen: Console) -> None:
    """Prints refusals and failures, then documents by folder, then all checks."""
    if not verdicts:
        screen.print("no documents")
        return
    _print_trouble(verdicts, screen)
    screen.print(_folders(verdicts))
    screen.print(_checks(verdicts))


def _print_trouble(verdicts: list[DocumentVerdict], screen: Console) -> None:
    """Prints a line for each document that is refused or crashed, and each check that failed or is poor."""
    lines = [f"{verdict.outcome:8} {verdict.error}" for verdict in verdicts if verdict.error]
    lines += [
        f"{BEYOND[check.status]:8} {verdict.file}: {check.name} {check.value:.4g} {check.unit} "
        f"(limit {check.limit:.4g}) {check.where}"
        for verdict in verdicts
        for check in verdict.checks
        if check.status in BEYOND
    ]
    for line in lines:
        screen.print(printable(line), highlight=False, markup=False, soft_wrap=True)
    if lines:
        screen.print()


def _folders(verdicts: list[DocumentVerdict]) -> Table:
    columns = ("documents", *OUTCOMES, "failed", "poor", *SHARES)
    shown = [column for column in columns if column != "crashed" or counts(verdicts)[column]]
    table = Table("folder", box=None, header_style="bold")
    for column in shown:
        table.add_column(column, justify="right")
    groups: dict[str, list[DocumentVerdict]] = {}
    for verdict, name in zip(verdicts, _groups([Path(verdict.file).parent for verdict in verdicts]), strict=True):
        groups.setdefault(name, []).append(verdict)
    rows = [*groups.items(), ("all", verdicts)] if len(groups) > 1 else [*groups.items()]
    for name, here in rows:
        found = counts(here)
        table.add_row(
            quote_text(name), *(str(found[column]) for column in shown), style="bold" if here is verdicts else ""
        )
    return table


def _groups(folders: list[Path]) -> list[str]:
    """Finds the part of each folder's name that differs from the others, cut so that there are few."""
    root = Path(commonpath([str(folder.absolute()) for folder in folders]))
    parts = [folder.absolute().relative_to(root).parts for folder in folders]
    deepest = max(len(part) for part in parts)
    cuts = [[Path(*part[:depth]) for part in parts] for depth in range(deepest, 0, -1)]
    few = next((cut for cut in cuts if len(set(cut)) <= MOST_ROWS), cuts[-1] if cuts else [Path()] * len(parts))
    return [root.name if cut == Path() else str(cut) for cut in few]


def _checks(verdicts: list[DocumentVerdict]) -> Table:
    """Tabulates every check over all documents, with its worst value."""
    table = Table("check", box=None, header_style="bold")
    for column in (*reversed(GRAVITY), "worst", "limit"):
        table.add_column(column, justify="right")
    for column in ("unit", "worst where", "in"):
        table.add_column(column, overflow="ellipsis", no_wrap=True)
    for tally in tallies(verdicts):
        counted = (f"[{COLOURS[status]}]{number}[/]" if number else "0" for status, number in tally.counts.items())
        table.add_row(
            tally.name,
            *counted,
            f"{tally.worst.value:.3g}",
            f"{tally.worst.limit:.3g}",
            tally.worst.unit,
            quote_text(tally.worst.where),
            quote_text(Path(tally.file).name if tally.worst.where else ""),
        )
    return table
