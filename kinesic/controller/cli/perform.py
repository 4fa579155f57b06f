"""`kinesic perform`: one document, in the twin, with a report."""

import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import get_args

import click
from rich.table import Table

from kinesic.bml.block import BmlError
from kinesic.controller.checks import Check, checks
from kinesic.controller.cli.console import console
from kinesic.controller.cli.options import Settings, planning
from kinesic.controller.cli.twins import HELP as TWIN_HELP
from kinesic.controller.cli.twins import read_twins
from kinesic.controller.feedforward import Terms
from kinesic.controller.following import following
from kinesic.controller.output import Written, free_folder, write
from kinesic.controller.page import verdict
from kinesic.controller.perform import performances
from kinesic.controller.performance import Performance
from kinesic.controller.report import report

TERMS_HELP = "What of the servos is inverted: everything, what speed needs, or nothing."
COLOURS = {"pass": "green", "warn": "yellow", "fail": "red"}


@click.command()
@click.argument("file")
@planning
@click.option("--on", "sinks", type=click.Choice(["twin"]), default="twin", show_default=True, help="Who performs.")
@click.option("--twin", default="nominal", show_default=True, help=TWIN_HELP)
@click.option("--feedforward", type=click.Choice(get_args(Terms)), default="full", show_default=True, help=TERMS_HELP)
@click.option("--correction/--no-correction", default=True, help="Goals corrected by what the twin measures.")
@click.option("--seed", type=int, default=0, show_default=True, help="Of everything random.")
@click.option("--out", type=click.Path(path_type=Path), help="Folder of the report (default: out/NAME-TIME).")
@click.option("--force", is_flag=True, help="Replaces an existing folder.")
@click.option("--film/--no-film", default=True, help="A film of the twin, where OpenGL works.")
@click.option("--json", "as_json", is_flag=True, help="Prints the report as JSON.")
def perform(
    file: str,
    settings: Settings,
    sinks: str,
    twin: str,
    feedforward: Terms,
    correction: bool,
    seed: int,
    out: Path | None,
    force: bool,
    film: bool,
    as_json: bool,
) -> int:
    """Performs FILE (- for standard input) and writes a report."""
    text = read_document(file)
    source = "stdin" if file == "-" else file
    folder = free_folder(out, source, force=force)
    performance, *beside = performances(
        text, read_twins(twin), settings.facts(), source=source, feedforward=feedforward, correction=correction
    )
    data = report(performance, source=source, seed=seed, beside=beside)
    written = write(performance, data, folder, film=film)
    if as_json:
        click.echo(json.dumps(data, indent=1))
    else:
        screen = console()
        screen.print(_table(checks(performance)))
        if beside:
            screen.print(_side_by_side((performance, *beside)))
        screen.print(verdict(data), highlight=False, markup=False, soft_wrap=True)
    _print_paths(written, on_error=as_json)
    return 0 if data["ok"] else 1


def read_document(file: str) -> bytes:
    """The bytes of a file, or of standard input for `-`.

    Raises:
        BmlError: there is no such file, or it cannot be read.
    """
    if file == "-":
        return sys.stdin.buffer.read()
    try:
        return Path(file).read_bytes()
    except OSError as error:
        raise BmlError(f"{file}: {error.strerror}") from None


def _table(verdicts: tuple[Check, ...]) -> Table:
    table = Table("check", "status", "value", "limit", "unit", "where", box=None, header_style="bold")
    for check in verdicts:
        status = f"[{COLOURS[check.status]}]{check.status}[/]"
        table.add_row(check.name, status, f"{check.value:.4g}", f"{check.limit:.4g}", check.unit, check.where)
    return table


def _side_by_side(performances: tuple[Performance, ...]) -> Table:
    """Errors of every twin."""
    table = Table("error", *(each.twin_name for each in performances), box=None, header_style="bold")
    found = [asdict(following(each)) for each in performances]
    for figure in found[0]:
        table.add_row(figure, *("-" if row[figure] is None else f"{row[figure]:.4g}" for row in found))
    return table


def _print_paths(written: Written, *, on_error: bool) -> None:
    if written.film is None:
        click.echo(f"film: none ({written.why_no_film})", err=on_error)
    else:
        click.echo(f"film: {written.film}", err=on_error)
    click.echo(f"measured: {written.measured}", err=on_error)
    click.echo(f"report: {written.report}", err=on_error)
    click.echo(f"page: {written.page}", err=on_error)
