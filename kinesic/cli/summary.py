"""What a performance comes to, on one screen: what failed, what is not performed as asked, and the rest in a line."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict

from rich.console import Console
from rich.table import Table
from rich.text import Text

from kinesic.bml.block import Notice
from kinesic.cli.plain_words import printable
from kinesic.cli.terminal import quote_text
from kinesic.controller.performance import Performance
from kinesic.expressivity.keyframes import Outcome
from kinesic.planning.plan import Plan
from kinesic.report.checks import GRAVITY, Check
from kinesic.report.checks.twin import measure_tracking
from kinesic.report.labels import label_with_id

COLOURS = {"pass": "green", "warn": "yellow", "poor": "magenta", "fail": "red"}
MEANINGS = {"dropped": "red", "partly": "yellow", "substituted": "yellow", "warning": "yellow"}  # the gravest first
MOST_WARNINGS = 40  # lines of warnings on a screen


def print_checks(verdicts: Sequence[Check], screen: Console) -> None:
    """Prints a row for each check that does not pass, failures first, and one line for all that do."""
    bad = sorted((check for check in verdicts if check.status != "pass"), key=lambda check: GRAVITY[check.status])
    if bad:
        screen.print(_table(bad))
    passed = len(verdicts) - len(bad)
    screen.print(f"{passed} of {len(verdicts)} checks pass" if bad else f"all {passed} checks pass", highlight=False)


def print_notices(plan: Plan, screen: Console, *, most: int | None = None) -> None:
    """Prints a line for each warning of a plan, dropped behaviours first.

    Args:
        plan: whose warnings are printed.
        screen: where.
        most: lines that are printed; None: all.
    """
    found, block = rank_notices(plan), plan.timeline.block
    for meaning, notice in found[:most]:
        id = notice.id.removeprefix(f"{block.id}:")
        name = notice.id if id == notice.id else label_with_id(id, block)
        text = f"{name}: {notice.text.removeprefix(f'{meaning}: ')}"
        line = Text.assemble((f"{meaning:11}", MEANINGS[meaning]), f" {printable(text)}")
        screen.print(line, soft_wrap=True)
    if most is not None and len(found) > most:
        screen.print(f"and {len(found) - most} more warnings: report.json lists all", highlight=False)


def rank_notices(plan: Plan) -> list[tuple[str, Notice]]:
    """Pairs each warning with what it means for its behaviour (a key of `MEANINGS`), the gravest first."""
    outcomes, block, order = plan.keyframes.outcomes, plan.timeline.block.id, list(MEANINGS)
    found = [(_meaning(notice, outcomes.get(notice.id.removeprefix(f"{block}:"))), notice) for notice in plan.notices]
    return sorted(found, key=lambda pair: order.index(pair[0]))


def _meaning(notice: Notice, outcome: Outcome | None) -> str:
    """A warning that gives the reason of its behaviour's outcome is called as that; any other is a warning."""
    if outcome is None or not outcome.why or outcome.kind not in MEANINGS:
        return "warning"
    text = notice.text.removeprefix(f"{outcome.kind}: ")
    return outcome.kind if text in outcome.why or outcome.why in text else "warning"


def print_side_by_side(performances: Sequence[Performance], screen: Console) -> None:
    """Prints how well the twins of several performances followed one plan."""
    table = Table("error", *(each.twin_name for each in performances), box=None, header_style="bold")
    found = [asdict(measure_tracking(each)) for each in performances]
    for figure in found[0]:
        table.add_row(figure, *("-" if row[figure] is None else f"{row[figure]:.4g}" for row in found))
    screen.print(table)


def _table(verdicts: Iterable[Check]) -> Table:
    table = Table("check", "status", "value", "limit", "unit", "where", box=None, header_style="bold")
    for check in verdicts:
        status = f"[{COLOURS[check.status]}]{check.status}[/]"
        table.add_row(
            check.name, status, f"{check.value:.4g}", f"{check.limit:.4g}", check.unit, quote_text(check.where)
        )
    return table
