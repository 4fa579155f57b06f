"""`kinesic perform`: one document, in the twin, with a report."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import get_args

import click
from rich.table import Table

from kinesic.cli.options import FAULT, TWIN_HELP, PlanningOptions, SinkNames, planning, read_input, read_twins
from kinesic.cli.playback import follow_servos as following_face
from kinesic.cli.playback import play_whole, preview_window
from kinesic.cli.servo_run import perform_on_servos, write_live
from kinesic.cli.servos.ports import PORT_HELP, all_ports
from kinesic.cli.terminal import console
from kinesic.controller.feedforward import Terms
from kinesic.controller.perform import dry_runs, performances
from kinesic.controller.performance import Performance
from kinesic.controller.servo_performance import ServoRun
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.planning.bap import SUFFIX, read_bap
from kinesic.planning.imported_motion import plan_imported
from kinesic.planning.setup import Setup
from kinesic.report.checks import Check, checks
from kinesic.report.checks.twin import measure_tracking
from kinesic.report.output import Written, free_folder, write_report
from kinesic.report.page import verdict
from kinesic.report.report import Json, report
from kinesic.report.servo_report import live_checks
from kinesic.sim.servo_factors import Factors

TERMS_HELP = "What of the servos is inverted: everything, what speed needs, or nothing."
ON_HELP = (
    "Who performs, with commas between: twin (always first), servos, face (in a window where there is a display). "
    "Space stops the servos, Ctrl-C folds them to rest."
)
COLOURS = {"pass": "green", "warn": "yellow", "fail": "red"}


@click.command()
@click.argument("file")
@planning
@click.option("--on", "sinks", type=SinkNames(), default="twin", show_default=True, help=ON_HELP)
@click.option("--port", "ports", multiple=True, metavar="NAME=PATH", help=PORT_HELP)
@click.option("--twin", default="nominal", show_default=True, help=TWIN_HELP)
@click.option("--feedforward", type=click.Choice(get_args(Terms)), default="full", show_default=True, help=TERMS_HELP)
@click.option("--correction/--no-correction", default=True, help="Goals corrected by what the twin measures.")
@click.option("--out", type=click.Path(path_type=Path), help="Folder of the report (default: out/NAME-TIME).")
@click.option("--force", is_flag=True, help="Replaces an existing folder.")
@click.option("--film/--no-film", default=True, help="Films of the twin and of the face, where OpenGL works.")
@click.option("--json", "as_json", is_flag=True, help="Prints the report as JSON.")
def perform(
    file: str,
    settings: PlanningOptions,
    sinks: frozenset[str],
    ports: tuple[str, ...],
    twin: str,
    feedforward: Terms,
    correction: bool,
    out: Path | None,
    force: bool,
    film: bool,
    as_json: bool,
) -> int:
    """Performs FILE (BML, a .bap motion, or - for BML from standard input) and writes a report.

    On servos it is performed after the twin has performed it without a failed check.
    """
    source = "stdin" if file == "-" else file
    folder = free_folder(out, source, force=force)
    known = settings.setup()
    paths = all_ports(ports, Manifest.of(known.robot).bauds) if "servos" in sinks else {}
    performance, *beside = _performed(file, known, read_twins(twin), feedforward, correction)
    data = report(performance, source=source, seed=settings.idling.seed, beside=beside)
    written = write_report(performance, data, folder, film=film)
    live, log, planned = None, None, performance.plan
    with preview_window(
        known.robot, asked="face" in sinks, beside=written.film if "twin" in sinks else None
    ) as preview:
        if paths and data["ok"]:
            live = perform_on_servos(performance, paths, folder, quiet=as_json, told=following_face(planned, preview))
            data, log = write_live(live, data, written)
        elif preview is not None:
            play_whole(planned, preview)
    if as_json:
        click.echo(json.dumps(data, indent=1))
    else:
        _print_report((performance, *beside), live, data)
    if paths and live is None:
        click.echo("the servos did not move: a check of the twin failed", err=True)
    _print_paths(written, log, on_error=as_json)
    if live is not None and live.ending == "failed":
        return FAULT
    return 0 if data["ok"] else 1


def _print_report(performances: tuple[Performance, ...], live: ServoRun | None, data: dict[str, Json]) -> None:
    screen = console()
    screen.print(_table((*checks(performances[0]), *(live_checks(live) if live is not None else ()))))
    if len(performances) > 1:
        screen.print(_side_by_side(performances))
    screen.print(verdict(data), highlight=False, markup=False, soft_wrap=True)


def _performed(
    file: str, known: Setup, twins: Sequence[Factors], feedforward: Terms, correction: bool
) -> tuple[Performance, ...]:
    """A document, or a motion that others made, in all twins."""
    if file.endswith(SUFFIX):
        planned = plan_imported(read_bap(Path(file), known.robot), known, source=file)
        return dry_runs(planned, twins, feedforward=feedforward, correction=correction)
    source = "stdin" if file == "-" else file
    text = read_input(file)
    return performances(text, twins, known, source=source, feedforward=feedforward, correction=correction)


def _table(verdicts: tuple[Check, ...]) -> Table:
    table = Table("check", "status", "value", "limit", "unit", "where", box=None, header_style="bold")
    for check in verdicts:
        status = f"[{COLOURS[check.status]}]{check.status}[/]"
        table.add_row(check.name, status, f"{check.value:.4g}", f"{check.limit:.4g}", check.unit, check.where)
    return table


def _side_by_side(performances: tuple[Performance, ...]) -> Table:
    """Errors of every twin."""
    table = Table("error", *(each.twin_name for each in performances), box=None, header_style="bold")
    found = [asdict(measure_tracking(each)) for each in performances]
    for figure in found[0]:
        table.add_row(figure, *("-" if row[figure] is None else f"{row[figure]:.4g}" for row in found))
    return table


def _print_paths(written: Written, log: Path | None, *, on_error: bool) -> None:
    films = (("film", written.film, written.why_no_film), ("face", written.face, written.why_no_face))
    for name, path, why in films:
        click.echo(f"{name}: none ({why})" if path is None else f"{name}: {path}", err=on_error)
    if written.voice is not None:
        click.echo(f"voice: {written.voice}", err=on_error)
    click.echo(f"measured: {written.measured}", err=on_error)
    if log is not None:
        click.echo(f"servos: {log}", err=on_error)
    click.echo(f"report: {written.report}", err=on_error)
    click.echo(f"page: {written.page}", err=on_error)
