"""`kinesic plan` and `kinesic perform`: one document as a motion, and in the twin with a report."""

import json
from dataclasses import asdict
from pathlib import Path

import click
from rich.table import Table

from kinesic.cli.options import FAULT, Output, Performers, Planning, TwinOptions, read_input
from kinesic.cli.plain_words import printable
from kinesic.cli.playback import follow_servos, perform_on_servos, play_whole, preview_window, write_live
from kinesic.cli.servos.ports import all_ports
from kinesic.cli.terminal import console, quote_text
from kinesic.controller.perform import dry_runs, performances, plan
from kinesic.controller.performance import Performance
from kinesic.controller.servo_performance import ServoRun
from kinesic.files.output_file import check_file
from kinesic.files.output_folder import check_folder
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.planning.bap import SUFFIX, read_bap
from kinesic.planning.imported_motion import plan_imported
from kinesic.planning.motion_files import check_motion_file, save_motion
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.report.checks import Check, checks
from kinesic.report.checks.twin import measure_tracking
from kinesic.report.output import Written, default_folder, write_report
from kinesic.report.page import verdict
from kinesic.report.report import Json, report
from kinesic.report.servo_report import live_checks
from kinesic.sim.servo_factors import read_twins

COLOURS = {"pass": "green", "warn": "yellow", "fail": "red"}


def perform_file(
    file: str, planning: Planning, performers: Performers, way: TwinOptions, output: Output, film: bool
) -> int:
    """Performs a document or a motion in the twin, reports, and then performs on the servos where no check failed."""
    source = _name(file)
    folder = output.out or default_folder(source)
    check_folder(folder, force=output.force)
    known = planning.set_up()
    paths = all_ports(performers.ports, Manifest.of(known.robot).bauds) if "servos" in performers.sinks else {}
    performance, *beside = _performed(file, known, way)
    data = report(performance, source=source, seed=known.idling.seed, beside=beside)
    written = write_report(performance, data, folder, film=film, force=output.force)
    live, log, planned = None, None, performance.plan
    film_beside = written.film if "twin" in performers.sinks else None
    with preview_window(known.robot, requested="face" in performers.sinks, beside=film_beside) as preview:
        if paths and data["ok"]:
            live = perform_on_servos(
                performance, paths, folder, quiet=output.as_json, listener=follow_servos(planned, preview)
            )
            data, log = write_live(live, data, written)
        elif preview is not None:
            play_whole(planned, preview)
    if output.as_json:
        click.echo(json.dumps(data, indent=1))
    else:
        _print_report((performance, *beside), live, data)
    if paths and live is None:
        click.echo("the servos did not move: a check of the twin failed", err=True)
    _print_paths(written, log, on_error=output.as_json)
    if live is not None and live.ending == "failed":
        return FAULT
    return 0 if data["ok"] else 1


def _print_report(performances: tuple[Performance, ...], live: ServoRun | None, data: dict[str, Json]) -> None:
    screen = console()
    screen.print(_table((*checks(performances[0]), *(live_checks(live) if live is not None else ()))))
    if len(performances) > 1:
        screen.print(_side_by_side(performances))
    screen.print(printable(verdict(data)), highlight=False, markup=False, soft_wrap=True)


def _performed(file: str, known: Setup, way: TwinOptions) -> tuple[Performance, ...]:
    twins, terms, correction = read_twins(way.twin), way.feedforward, way.correction
    if file.endswith(SUFFIX):
        return dry_runs(_imported(file, known), twins, feedforward=terms, correction=correction)
    text, source = read_input(file), _name(file)
    return performances(text, twins, known, source=source, feedforward=terms, correction=correction)


def plan_file(file: str, planning: Planning, out: Path, force: bool) -> int:
    """Plans a document or a motion, and writes the motion to a file; nothing moves."""
    check_motion_file(out)
    check_file(out, force=force)
    known = planning.set_up()
    planned = _imported(file, known) if file.endswith(SUFFIX) else plan(read_input(file), known, source=_name(file))
    save_motion(planned.trajectory, known.robot, out, force=force)
    for notice in planned.notices:
        click.echo(printable(f"{notice.type.value} {notice.id}: {notice.text}"), err=True)
    click.echo(f"{planned.trajectory.duration:.2f} s, {len(planned.postures.postures)} keys")
    click.echo(f"motion: {out}")
    return 0


def _imported(file: str, known: Setup) -> Plan:
    return plan_imported(read_bap(Path(file), known.robot), known, source=file)


def _name(file: str) -> str:
    """Names a document as messages and reports have it."""
    return "stdin" if file == "-" else file


def _table(verdicts: tuple[Check, ...]) -> Table:
    table = Table("check", "status", "value", "limit", "unit", "where", box=None, header_style="bold")
    for check in verdicts:
        status = f"[{COLOURS[check.status]}]{check.status}[/]"
        table.add_row(
            check.name, status, f"{check.value:.4g}", f"{check.limit:.4g}", check.unit, quote_text(check.where)
        )
    return table


def _side_by_side(performances: tuple[Performance, ...]) -> Table:
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
