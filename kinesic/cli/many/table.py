"""Tables that summarise many verdicts: failures, folders and checks."""

from os.path import commonpath
from pathlib import Path

from kinesic.cli.plain_words import printable
from kinesic.cli.screen.console import Console
from kinesic.cli.screen.table import Table
from kinesic.cli.screen.text import Text
from kinesic.cli.summary import STATUS_COLOURS
from kinesic.cli.terminal import quote_text
from kinesic.report.batch import DocumentVerdict
from kinesic.report.batch_totals import BEHAVIOUR_OUTCOMES, DOCUMENT_OUTCOMES, counts, tallies
from kinesic.report.checks import SEVERITY_RANKS

FAILURE_LABELS = {"fail": "failed", "poor": "poor"}  # check status -> word at the beginning of its line
COLUMN_GAP = 2  # [characters] space between the columns of a table
TEXT_COLUMNS = 3  # number of text columns at the end of the table of checks: unit, place and file
MIN_TEXT_WIDTH = 8  # [characters] smallest width of the place column and of the file column
MAX_FOLDER_ROWS = 16  # largest number of rows; more folders are grouped by their parents


def print_batch_summary(verdicts: list[DocumentVerdict], screen: Console) -> None:
    """Print failures, then a table of folders and a table of checks."""
    if not verdicts:
        screen.print("no documents")
        return
    _print_failures(verdicts, screen)
    screen.print(_tabulate_folders(verdicts))
    screen.print(_tabulate_checks(verdicts, screen.width))


def _print_failures(verdicts: list[DocumentVerdict], screen: Console) -> None:
    """Print refused and crashed documents, and failed and poor checks."""
    lines = [f"{verdict.outcome:8} {verdict.error}" for verdict in verdicts if verdict.error]
    lines += [
        f"{FAILURE_LABELS[check.status]:8} {verdict.file}: {check.name} {check.value:.4g} {check.unit} "
        f"(limit {check.limit:.4g}) {check.where}"
        for verdict in verdicts
        for check in verdict.checks
        if check.status in FAILURE_LABELS
    ]
    for line in lines:
        screen.print(printable(line))
    if lines:
        screen.print()


def _tabulate_folders(verdicts: list[DocumentVerdict]) -> Table:
    columns = ("documents", *DOCUMENT_OUTCOMES, "failed", "poor", *BEHAVIOUR_OUTCOMES)
    shown_columns = [column for column in columns if column != "crashed" or counts(verdicts)[column]]
    table = Table("folder")
    for column in shown_columns:
        table.add_column(column, justify="right")
    groups: dict[str, list[DocumentVerdict]] = {}
    for verdict, name in zip(
        verdicts, _group_folders([Path(verdict.file).parent for verdict in verdicts]), strict=True
    ):
        groups.setdefault(name, []).append(verdict)
    rows = [*groups.items(), ("all", verdicts)] if len(groups) > 1 else [*groups.items()]
    for name, folder_verdicts in rows:
        folder_counts = counts(folder_verdicts)
        table.add_row(
            quote_text(name),
            *(str(folder_counts[column]) for column in shown_columns),
            style="bold" if folder_verdicts is verdicts else "",
        )
    return table


def _group_folders(folders: list[Path]) -> list[str]:
    """Return a group name per folder, a parent folder if too many.

    Names are relative to the common parent folder.
    """
    root = Path(commonpath([str(folder.absolute()) for folder in folders]))
    parts = [folder.absolute().relative_to(root).parts for folder in folders]
    deepest = max(len(part) for part in parts)
    groupings = [[Path(*part[:depth]) for part in parts] for depth in range(deepest, 0, -1)]
    group_paths = next(
        (grouping for grouping in groupings if len(set(grouping)) <= MAX_FOLDER_ROWS),
        groupings[-1] if groupings else [Path()] * len(parts),
    )
    return [root.name if grouping == Path() else str(grouping) for grouping in group_paths]


def _tabulate_checks(verdicts: list[DocumentVerdict], width: int) -> Table:
    """Tabulate status counts and the worst value of each check.

    Names and numbers stay whole; places and files share the remaining width [characters].
    """
    headings = ("check", *reversed(SEVERITY_RANKS), "worst", "limit", "unit", "worst where", "in")
    rows = [
        (
            tally.name,
            *(str(number) for number in tally.counts.values()),
            f"{tally.worst.value:.3g}",
            f"{tally.worst.limit:.3g}",
            tally.worst.unit,
            printable(tally.worst.where),
            printable(Path(tally.file).name if tally.worst.where else ""),
        )
        for tally in tallies(verdicts)
    ]
    widths = [max(map(len, column)) for column in zip(headings, *rows, strict=True)]
    left = width - sum(widths[:-2]) - COLUMN_GAP * len(widths)
    has_places = left >= 2 * MIN_TEXT_WIDTH  # a narrow window shows only the file
    place_width = min(widths[-2], left // 2) if has_places else -COLUMN_GAP
    widths[-2:] = place_width, min(widths[-1], left - place_width)
    shown = [k for k in range(len(headings)) if has_places or headings[k] != "worst where"]
    table = Table()
    for k in shown:
        is_text = k == 0 or k >= len(headings) - TEXT_COLUMNS
        table.add_column(
            headings[k],
            justify="left" if is_text else "right",
            no_wrap=True,
            width=max(widths[k], 1),
        )
    for row in rows:
        colours = ["", *(STATUS_COLOURS[status] for status in reversed(SEVERITY_RANKS)), *("" for _ in row)]
        table.add_row(*(Text(row[k], colours[k] if row[k] != "0" else "") for k in shown))
    return table
