"""`kinesic perform`: one document in the twin, with a report, and then on servos."""

import json
from contextlib import nullcontext
from pathlib import Path
from time import perf_counter

import click

from kinesic.bml.block import Block
from kinesic.body.config import ConfigError
from kinesic.cli.ending_signals import STOPPED
from kinesic.cli.live.say import speak_as_it_comes
from kinesic.cli.options import FAULT, Output, Performers, Planning, TwinOptions, read_input
from kinesic.cli.plain_words import printable, printable_xml
from kinesic.cli.plan import document_name, is_motion, parse_document, parse_text, plan_motion
from kinesic.cli.playback import follow_servos, perform_on_servos, play_whole, preview_window, write_live
from kinesic.cli.progress import Stage, share_of, show_stages
from kinesic.cli.servos.memory import ServoMemory
from kinesic.cli.servos.ports import all_ports
from kinesic.cli.servos.summary import print_lesson
from kinesic.cli.summary import MOST_WARNINGS, print_checks, print_notices, print_side_by_side
from kinesic.cli.terminal import console
from kinesic.controller.documents import write_bml
from kinesic.controller.learned_gains import Lesson, learn
from kinesic.controller.perform import dry_runs
from kinesic.controller.performance import Performance
from kinesic.controller.servo_performance import ServoRun
from kinesic.files.film_file import NO_ENCODER, find_encoder
from kinesic.files.film_settings import FilmSettings
from kinesic.files.output_file import check_file
from kinesic.files.output_folder import check_folder
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.planning.plan import plan_block
from kinesic.planning.setup import Setup
from kinesic.report.checks import checks
from kinesic.report.films import film_processes
from kinesic.report.gltf.scene import is_scene, save_performed
from kinesic.report.output import WrittenPaths, add_films, default_folder, write_report
from kinesic.report.report import Json, report
from kinesic.report.servo_belief import with_lesson
from kinesic.report.servo_report import live_checks, live_log
from kinesic.report.verdict import verdict
from kinesic.sim.log import log_of


def perform_file(
    file: str,
    planning: Planning,
    performers: Performers,
    way: TwinOptions,
    output: Output,
    film: FilmSettings | None,
    *,
    text: str | None = None,
) -> int:
    """Performs a document or a motion in the twin, reports, and then performs on the servos where no check failed.

    Into a path that ends in .glb goes the performance as a scene, instead of a report into a folder.
    With a plain text that text is performed, and `file` is its name.
    """
    source = document_name(file)
    memory = ServoMemory.of(way)
    if is_scene(output.out):
        return _perform_scene(file, planning, performers, way, output, text)
    folder = output.out or default_folder(source)
    check_folder(folder, force=output.force)
    if film is not None and film.format == "mp4" and find_encoder() is None:
        raise ConfigError(NO_ENCODER)
    with film_processes() if film is not None else nullcontext() as processes, show_stages() as stage:
        stage("reading the robot")
        known = planning.set_up()
        paths = all_ports(performers.ports, Manifest.of(known.robot).bauds) if "servos" in performers.sinks else {}
        performance, *beside = _performed(file, known, way, memory, stage, text)
        lesson = None
        if memory.path is not None and not paths:
            stage("learning from the twin")
            lesson = learn(log_of(performance.measured), known.robot, memory.believed)
        stage("writing the report")
        data = report(performance, source=source, seed=known.idling.seed, beside=beside)
        data = with_lesson(data, lesson)
        written = write_report(performance, data, folder, film=film is not None, force=output.force)
        try:
            drawing = share_of(stage, printable(f"drawing films; the page is there: {written.page}"))
            if processes is not None and film is not None:
                written = add_films(written, performance, data, processes, settings=film, progress=drawing)
        except KeyboardInterrupt:
            click.echo(f"kinesic: stopped before its films were drawn; page: {written.page}", err=True)
            return STOPPED
    live, log, planned = None, None, performance.plan
    film_beside = written.film if film is not None and film.format == "webp" and "twin" in performers.sinks else None
    with preview_window(known.robot, requested="face" in performers.sinks, beside=film_beside) as preview:
        if paths and data["ok"]:
            live = perform_on_servos(
                performance, paths, folder, quiet=output.as_json, listener=follow_servos(planned, preview)
            )
            lesson = _learned(live, memory)
            data, log = write_live(live, data, written, lesson)
        elif preview is not None:
            play_whole(planned, preview)
    if output.as_json:
        click.echo(json.dumps(data, indent=1))
    else:
        _print_report((performance, *beside), live, data)
    if paths and live is None:
        click.echo("the servos did not move: a check of the twin failed", err=True)
    _print_paths(written, log, on_error=output.as_json)
    if lesson is not None:
        print_lesson(lesson, memory.keep(lesson, folder), on_error=output.as_json)
    if live is not None and live.ending == "failed":
        return FAULT
    return 0 if data["ok"] else 1


def _perform_scene(
    file: str, planning: Planning, performers: Performers, way: TwinOptions, output: Output, text: str | None
) -> int:
    """Performs in the twin and writes that as glTF; the report is told, and not written."""
    if performers.sinks != {"twin"}:
        raise ConfigError(f"{output.out}: a scene shows the twin alone: --out FOLDER for --on servos or face")
    assert output.out is not None  # it has the ending of a scene
    check_file(output.out, force=output.force)
    with show_stages() as stage:
        stage("reading the robot")
        known = planning.set_up()
        performance, *beside = _performed(file, known, way, ServoMemory.of(way), stage, text)
        stage("writing the scene")
        save_performed(performance, output.out, force=output.force)
        data = report(performance, source=document_name(file), seed=known.idling.seed, beside=beside)
    if output.as_json:
        click.echo(json.dumps(data, indent=1))
    else:
        _print_report((performance, *beside), None, data)
    click.echo(f"scene: {output.out}", err=output.as_json)
    return 0 if data["ok"] else 1


def say_text(
    text: str,
    planning: Planning,
    performers: Performers,
    way: TwinOptions,
    output: Output,
    film: FilmSettings | None,
    to: str,
) -> int:
    """Writes BML for a text and performs it; only prints it, if that is wanted. `-` is standard input, as it comes."""
    if text == "-" and to == "bml":
        text = read_input(text).decode(errors="replace")
    elif text == "-":
        return speak_as_it_comes(planning, performers, output)
    if to == "bml":
        click.echo(printable_xml(write_bml(text, planning.set_up())), nl=False)
        return 0
    return perform_file("said", planning, performers, way, output, film, text=text)


def _print_report(performances: tuple[Performance, ...], live: ServoRun | None, data: dict[str, Json]) -> None:
    screen = console()
    print_checks((*checks(performances[0]), *(live_checks(live) if live is not None else ())), screen)
    if len(performances) > 1:
        print_side_by_side(performances, screen)
    print_notices(performances[0].plan, screen, most=MOST_WARNINGS)
    screen.print(printable(verdict(data)), highlight=False, markup=False, soft_wrap=True)


def _learned(live: ServoRun, memory: ServoMemory) -> Lesson | None:
    """What the servos of a run have told, where anybody wants to know."""
    if not memory.learns or len(live.times) < 2:
        return None
    with show_stages() as stage:
        stage("learning from the servos")
        return learn(live_log(live), live.performance.plan.setup.robot, memory.believed)


def _performed(
    file: str, known: Setup, way: TwinOptions, memory: ServoMemory, stage: Stage, text: str | None
) -> tuple[Performance, ...]:
    """Plans a document, or a plain text, and performs it in the twins."""
    stage("planning")
    begun = perf_counter()
    if text is not None:
        block: Block | None = parse_text(text, known, source=file)
    else:
        block = None if is_motion(file) else parse_document(file, known)
    parsed = perf_counter() - begun
    planned = plan_motion(file, known) if block is None else plan_block(block, known)
    return dry_runs(
        planned,
        memory.twins,
        feedforward=way.feedforward,
        correction=way.correction,
        believed=memory.believed,
        parse_seconds=parsed,
        progress=share_of(stage, "performing in the twin"),
    )


def _print_paths(written: WrittenPaths, log: Path | None, *, on_error: bool) -> None:
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
