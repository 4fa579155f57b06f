"""Verb `kinesic perform`: perform in the twin, report, then use servos."""

import json
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

import click

from kinesic.body.config import ConfigError
from kinesic.cli.ending_signals import INTERRUPTED_EXIT_CODE
from kinesic.cli.option_values import SpokenInput
from kinesic.cli.options import FAULT_EXIT_CODE, Output, Performers, Planning, TwinOptions, read_input
from kinesic.cli.perform_options import PerformOptions
from kinesic.cli.plain_words import printable
from kinesic.cli.plan import divide_input, document_name, plan_input, print_written
from kinesic.cli.playback import follow_servos, perform_on_servos, play_whole, preview_window, write_servo_run
from kinesic.cli.progress import Stage, show_stages, stage_progress
from kinesic.cli.servos.memory import ServoMemory
from kinesic.cli.servos.ports import read_all_ports
from kinesic.cli.servos.summary import print_learned_factors
from kinesic.cli.summary import MAX_PRINTED_WARNINGS, print_checks, print_notices, print_tracking_errors
from kinesic.cli.terminal import console
from kinesic.cli.text_parts import perform_parts
from kinesic.controller.dry_run import dry_runs
from kinesic.controller.learned_gains import Identification, identify_servos
from kinesic.files.film_file import explain_missing_encoder, find_encoder
from kinesic.files.film_settings import FilmSettings
from kinesic.files.output_file import check_file
from kinesic.files.output_folder import check_folder
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.host import LIVE_SERVER, SERVO_DRIVER
from kinesic.intent.manuscript.pieces import SpokenText
from kinesic.metrics.dry_run import DryRun
from kinesic.metrics.servo_run import ServoRun
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.report.checks import checks
from kinesic.report.films import film_processes
from kinesic.report.gltf.scene import is_scene, save_performed, save_voice
from kinesic.report.output import WrittenPaths, add_films, default_folder, write_report
from kinesic.report.report import Json, report
from kinesic.report.servo_estimate import add_identification
from kinesic.report.servo_report import live_checks, live_log
from kinesic.report.verdict import verdict
from kinesic.session.documents import divide_long, write_text
from kinesic.session.plan import plan_plain_text, plan_recording
from kinesic.session.recorded import SpokenRecording, write_recording
from kinesic.sim.log import make_log


@dataclass(frozen=True)
class _Content:
    """Document, plain text or recording to perform."""

    file: str  # path of the document, or name of the text or recording
    text: str | None
    recording: SpokenRecording | None

    def plan(self, setup: Setup) -> Plan:
        """Plan the recording, the text or the file, in this priority."""
        if self.recording is not None:
            return plan_recording(self.text, self.recording, setup, source=self.file)
        if self.text is not None:
            return plan_plain_text(self.text, setup, source=self.file)
        return plan_input(self.file, setup)

    def divide(self, planning: Planning) -> tuple[SpokenText, ...]:
        """Divide a text that is too long for one plan.

        Return no parts for a shorter text.
        """
        if self.recording is not None:
            return ()
        return divide_input(self.file, planning) if self.text is None else divide_long(self.text, planning.options)


def perform_file(
    file: str, options: PerformOptions, *, text: str | None = None, recording: SpokenRecording | None = None
) -> int:
    """Perform a document in the twin, report, then perform on servos.

    Servos move only if no check of the twin failed. If the output path ends in .glb, the performance is written as a
    glTF scene with its voice beside it, and no report folder. A plain text or a recording, if given, is performed, and
    `file` is its name. A text too long for one plan is performed part by part.
    """
    performers, output, film = options.performers, options.output, options.film
    if "servos" in performers.sinks:
        SERVO_DRIVER.require()
    source, content = document_name(file), _Content(file, text, recording)
    if parts := content.divide(options.planning):
        return perform_parts(parts, options, source=source)
    memory = ServoMemory.of(options.twin)
    if is_scene(output.out):
        return _perform_scene(content, options)
    folder = output.out or default_folder(source)
    check_folder(folder, force=output.force)
    if film is not None and film.format == "mp4" and find_encoder() is None:
        raise ConfigError(explain_missing_encoder())
    with film_processes() if film is not None else nullcontext() as processes, show_stages() as stage:
        stage("reading the robot")
        setup = options.planning.set_up()
        paths = read_all_ports(performers.ports, Manifest.of(setup.robot).bauds) if "servos" in performers.sinks else {}
        performance, *other_runs = _perform_in_twins(content, setup, options.twin, memory, stage)
        identification = None
        if memory.path is not None and not paths:
            stage("learning from the twin")
            identification = identify_servos(make_log(performance.measured), setup.robot, memory.estimate)
        stage("writing the report")
        data = report(performance, source=source, seed=setup.idling.seed, other_runs=other_runs)
        data = add_identification(data, identification)
        written = write_report(performance, data, folder, film=film is not None, force=output.force)
        try:
            progress = stage_progress(stage, printable(f"drawing films; the report page is ready: {written.page}"))
            if processes is not None and film is not None:
                written = add_films(written, performance, data, processes, settings=film, progress=progress)
        except KeyboardInterrupt:
            click.echo(f"kinesic: stopped before its films were drawn; page: {written.page}", err=True)
            return INTERRUPTED_EXIT_CODE
    servo_run, servo_log, plan = None, None, performance.plan
    twin_film = written.film if film is not None and film.format == "webp" and "twin" in performers.sinks else None
    with preview_window(setup.robot, requested="face" in performers.sinks, body_film=twin_film) as preview:
        if paths and data["ok"]:
            servo_run = perform_on_servos(
                performance, paths, folder, quiet=output.as_json, listener=follow_servos(plan, preview)
            )
            identification = _identify_run(servo_run, memory)
            data, servo_log = write_servo_run(servo_run, data, written, identification)
        elif preview is not None:
            play_whole(plan, preview)
    if output.as_json:
        click.echo(json.dumps(data, indent=1))
    else:
        _print_report((performance, *other_runs), servo_run, data)
    if paths and servo_run is None:
        click.echo("the servos did not move: a check of the twin failed", err=True)
    _print_paths(written, servo_log, to_stderr=output.as_json)
    if identification is not None:
        print_learned_factors(identification, memory.keep(identification, folder), to_stderr=output.as_json)
    if servo_run is not None and servo_run.ending == "failed":
        return FAULT_EXIT_CODE
    return 0 if data["ok"] else 1


def _perform_scene(content: _Content, options: PerformOptions) -> int:
    """Perform in the twin and write a glTF scene, without report files."""
    output = options.output
    if options.performers.sinks != {"twin"}:
        raise ConfigError(f"{output.out}: a scene shows the twin alone: --out FOLDER for --on servos or face")
    assert output.out is not None  # The suffix is that of a scene.
    check_file(output.out, force=output.force)
    with show_stages() as stage:
        stage("reading the robot")
        setup = options.planning.set_up()
        memory = ServoMemory.of(options.twin)
        performance, *other_runs = _perform_in_twins(content, setup, options.twin, memory, stage)
        stage("writing the scene")
        voice = save_voice(performance.plan, output.out, force=output.force)
        save_performed(performance, output.out, force=output.force)
        data = report(performance, source=document_name(content.file), seed=setup.idling.seed, other_runs=other_runs)
    if output.as_json:
        click.echo(json.dumps(data, indent=1))
    else:
        _print_report((performance, *other_runs), None, data)
    if voice is not None:
        click.echo(f"voice: {voice}", err=output.as_json)
    click.echo(f"scene: {output.out}", err=output.as_json)
    return 0 if data["ok"] else 1


def say_text(
    spoken: SpokenInput,
    planning: Planning,
    performers: Performers,
    twin_options: TwinOptions,
    output: Output,
    film: FilmSettings | None,
) -> int:
    """Write BML for a text or recording, then perform or print it.

    The text `-` stands for standard input, which is spoken as it arrives.
    """
    options = PerformOptions(planning, performers, twin_options, output, film)
    text, words, to = spoken.text, spoken.words, spoken.to
    if spoken.audio is not None:
        recording = SpokenRecording(spoken.audio, words)
        if text == "-":
            raise ConfigError("say -: standard input has no recording; give the text of --audio on the command line")
        if to == "bml":
            print_written(lambda setup: write_recording(text, recording, setup), planning.set_up)
            return 0
        return perform_file("said", options, text=text, recording=recording)
    if words is not None:
        raise ConfigError("--words: the times of words need a recording: --audio speech.wav")
    if text is None:
        raise ConfigError('say: give a TEXT or a recording: kinesic say "Hello.", kinesic say --audio speech.wav')
    if text == "-" and to == "bml":
        content = read_input(text)
        print_written(lambda setup: write_text(content, setup), planning.set_up)
        return 0
    if text == "-":
        LIVE_SERVER.require()
        from kinesic.cli.live.say import speak_standard_input  # noqa: PLC0415 - the server's modules are slow to import

        return speak_standard_input(planning, performers, output)
    if to == "bml":
        print_written(lambda setup: write_text(text, setup), planning.set_up)
        return 0
    return perform_file("said", options, text=text)


def _print_report(performances: tuple[DryRun, ...], servo_run: ServoRun | None, data: dict[str, Json]) -> None:
    screen = console()
    print_checks((*checks(performances[0]), *(live_checks(servo_run) if servo_run is not None else ())), screen)
    if len(performances) > 1:
        print_tracking_errors(performances, screen)
    print_notices(performances[0].plan, screen, max_lines=MAX_PRINTED_WARNINGS)
    screen.print(printable(verdict(data)))


def _identify_run(servo_run: ServoRun, memory: ServoMemory) -> Identification | None:
    """Return servo parameters identified from a servo run, or None.

    None if learning is off, or if the run has fewer than two samples.
    """
    if not memory.learns or len(servo_run.times) < 2:
        return None
    with show_stages() as stage:
        stage("learning from the servos")
        return identify_servos(live_log(servo_run), servo_run.performance.plan.setup.robot, memory.estimate)


def _perform_in_twins(
    content: _Content, setup: Setup, options: TwinOptions, memory: ServoMemory, stage: Stage
) -> tuple[DryRun, ...]:
    """Plan a document, text or recording and perform it in the twins."""
    stage("planning")
    plan = content.plan(setup)
    return dry_runs(
        plan,
        memory.twins,
        feedforward=options.feedforward,
        correction=options.correction,
        believed=memory.estimate,
        progress=stage_progress(stage, "performing in the twin"),
    )


def _print_paths(written: WrittenPaths, servo_log: Path | None, *, to_stderr: bool) -> None:
    films = (("film", written.film, written.why_no_film), ("face", written.face, written.why_no_face))
    for name, path, reason in films:
        click.echo(f"{name}: none ({reason})" if path is None else f"{name}: {path}", err=to_stderr)
    if written.voice is not None:
        click.echo(f"voice: {written.voice}", err=to_stderr)
    click.echo(f"measured: {written.measured}", err=to_stderr)
    if servo_log is not None:
        click.echo(f"servos: {servo_log}", err=to_stderr)
    click.echo(f"report: {written.report}", err=to_stderr)
    click.echo(f"page: {written.page}", err=to_stderr)
