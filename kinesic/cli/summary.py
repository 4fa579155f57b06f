"""Summary of a performance on one screen: failed checks, warnings and verdict."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict

from kinesic.bml.block import Notice
from kinesic.cli.plain_words import printable
from kinesic.cli.screen.console import Console
from kinesic.cli.screen.table import Table
from kinesic.cli.screen.text import Text
from kinesic.cli.terminal import quote_text
from kinesic.expressivity.keyframes import Outcome
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.plan import Plan
from kinesic.report.checks import SEVERITY_RANKS, Check
from kinesic.report.checks.twin import measure_tracking
from kinesic.report.labels import label_with_id

STATUS_COLOURS = {"pass": "green", "warn": "yellow", "poor": "magenta", "fail": "red"}
CATEGORY_COLOURS = {
    "dropped": "red",
    "partly": "yellow",
    "substituted": "yellow",
    "warning": "yellow",
}  # warning category -> colour, the most severe first
MAX_PRINTED_WARNINGS = 40  # largest number of warnings printed after a performance


def print_checks(checks: Sequence[Check], screen: Console) -> None:
    """Print checks that do not pass, and count the passed checks.

    Failures come first.
    """
    not_passed = sorted(
        (check for check in checks if check.status != "pass"), key=lambda check: SEVERITY_RANKS[check.status]
    )
    if not_passed:
        screen.print(_tabulate(not_passed))
    passed = len(checks) - len(not_passed)
    screen.print(f"{passed} of {len(checks)} checks pass" if not_passed else f"all {passed} checks pass")


def print_notices(plan: Plan, screen: Console, *, max_lines: int | None = None) -> None:
    """Print a line for each warning of a plan, dropped behaviours first.

    Args:
        plan: plan whose warnings are printed.
        screen: console to print on.
        max_lines: maximum number of lines; None: no limit.
    """
    ranked, block = rank_notices(plan), plan.timeline.block
    for category, notice in ranked[:max_lines]:
        behaviour_id = notice.id.removeprefix(f"{block.id}:")
        name = notice.id if behaviour_id == notice.id else label_with_id(behaviour_id, block)
        text = f"{name}: {notice.text.removeprefix(f'{category}: ')}"
        line = Text(f"{category:11}", CATEGORY_COLOURS[category]) + f" {printable(text)}"
        screen.print(line)
    if max_lines is not None and len(ranked) > max_lines:
        screen.print(f"and {len(ranked) - max_lines} more warnings: report.json lists all")


def rank_notices(plan: Plan) -> list[tuple[str, Notice]]:
    """Pair each warning with its category, the most severe first.

    Categories are the keys of `CATEGORY_COLOURS`.
    """
    outcomes, block, order = plan.keyframes.outcomes, plan.timeline.block.id, list(CATEGORY_COLOURS)
    pairs = [
        (_categorise(notice, outcomes.get(notice.id.removeprefix(f"{block}:"))), notice) for notice in plan.notices
    ]
    return sorted(pairs, key=lambda pair: order.index(pair[0]))


def _categorise(notice: Notice, outcome: Outcome | None) -> str:
    """Return the behaviour's outcome if the warning explains it, or "warning"."""
    if outcome is None or not outcome.why or outcome.kind not in CATEGORY_COLOURS:
        return "warning"
    text = notice.text.removeprefix(f"{outcome.kind}: ")
    return outcome.kind if text in outcome.why or outcome.why in text else "warning"


def print_tracking_errors(performances: Sequence[DryRun], screen: Console) -> None:
    """Print the tracking errors of several twins that followed one plan."""
    table = Table("error", *(run.twin_name for run in performances))
    rows = [asdict(measure_tracking(run)) for run in performances]
    for metric in rows[0]:
        table.add_row(metric, *("-" if row[metric] is None else f"{row[metric]:.4g}" for row in rows))
    screen.print(table)


def _tabulate(checks: Iterable[Check]) -> Table:
    table = Table("check", "status", "value", "limit", "unit", "where")
    for check in checks:
        status = quote_text(check.status, style=STATUS_COLOURS[check.status])
        table.add_row(
            check.name, status, f"{check.value:.4g}", f"{check.limit:.4g}", check.unit, quote_text(check.where)
        )
    return table
