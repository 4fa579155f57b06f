"""Performance of a long text in parts, each with a report."""

import json
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path

import click

from kinesic.body.config import ConfigError
from kinesic.cli.ending_signals import INTERRUPTED_EXIT_CODE
from kinesic.cli.many.table import print_batch_summary
from kinesic.cli.perform_options import PerformOptions
from kinesic.cli.plain_words import printable
from kinesic.cli.progress import Stage, show_stages, stage_progress
from kinesic.cli.servos.memory import NO_LEARNING, ServoMemory
from kinesic.cli.terminal import console
from kinesic.controller.dry_run import dry_runs
from kinesic.files.output_folder import check_folder, new_folder
from kinesic.intent.manuscript.pieces import SpokenText
from kinesic.planning.plan import Plan
from kinesic.report.films import FilmProcesses, film_processes
from kinesic.report.gltf.scene import is_scene
from kinesic.report.output import add_films, default_folder, write_report
from kinesic.report.report import report
from kinesic.report.text_parts import PARTS_FILE, PerformedPart, write_parts
from kinesic.session.plan import plan_parts


def perform_parts(parts: Sequence[SpokenText], options: PerformOptions, *, source: str) -> int:
    """Perform a long text in the twin, part by part.

    Only one part is in memory. Each has a report folder of its own, and a summary names all.

    Args:
        parts: of the text.
        options: of the performance.
        source: name of the text.
    """
    output = options.output
    _check_options(options, len(parts), source)
    folder = output.out or default_folder(source)
    check_folder(folder, force=output.force)
    done: list[PerformedPart] = []
    with film_processes() if options.film is not None else nullcontext() as processes, show_stages() as stage:
        stage("reading the robot")
        setup = options.planning.set_up()
        with new_folder(folder, force=output.force):
            pass
        data = write_parts(folder, done, setup, source=source, count=len(parts))
        try:
            stage(f"planning part 1 of {len(parts)}")
            for plan in plan_parts(parts, setup, source=source):
                done.append(_perform_part(plan, options, folder / _name_part(len(done), len(parts)), processes, stage))
                data = write_parts(folder, done, setup, source=source, count=len(parts))
                if not output.as_json:
                    click.echo(_describe_part(done, folder, len(parts)))
                stage(f"planning part {len(done) + 1} of {len(parts)}")
        except KeyboardInterrupt:
            click.echo(f"kinesic: stopped after {len(done)} of {len(parts)} parts", err=True)
    if output.as_json:
        click.echo(json.dumps(data, indent=1))
    elif done:
        print_batch_summary([part.verdict for part in done], console())
    click.echo(f"summary: {folder / PARTS_FILE}", err=output.as_json)
    if not data["complete"]:
        return INTERRUPTED_EXIT_CODE
    return 0 if data["ok"] else 1


def _check_options(options: PerformOptions, count: int, source: str) -> None:
    """Refuse options that a text of several parts does not have."""
    if options.performers.sinks != {"twin"}:
        sinks = ",".join(sorted(options.performers.sinks))
        raise ConfigError(
            f"{source}: {count} parts are performed only in the twin: `kinesic say - --on {sinks} < FILE` streams them"
        )
    if options.twin.learn not in (None, NO_LEARNING):
        raise ConfigError(f"--learn {options.twin.learn}: servo factors are learned from one plan, not {count} parts")
    if is_scene(options.output.out):
        raise ConfigError(f"{options.output.out}: a scene holds one part of a text, not {count}: give --out FOLDER")


def _perform_part(
    plan: Plan, options: PerformOptions, folder: Path, processes: FilmProcesses | None, stage: Stage
) -> PerformedPart:
    """Perform one part in the twins, and write its report and films."""
    memory, source, film = ServoMemory.of(options.twin), plan.timeline.block.source, options.film
    stage(f"performing {folder.name}")
    performance, *others = dry_runs(
        plan,
        memory.twins,
        feedforward=options.twin.feedforward,
        correction=options.twin.correction,
        believed=memory.estimate,
        progress=stage_progress(stage, f"performing {folder.name} in the twin"),
    )
    data = report(performance, source=source, seed=plan.setup.idling.seed, other_runs=others)
    written = write_report(performance, data, folder, film=film is not None)
    if processes is not None and film is not None:
        progress = stage_progress(stage, printable(f"drawing films of {folder.name}"))
        add_films(written, performance, data, processes, settings=film, progress=progress)
    return PerformedPart.of(folder.name, performance)


def _name_part(index: int, count: int) -> str:
    """Return a folder name that sorts in the order of the parts."""
    return f"part-{index + 1:0{len(str(count))}d}"


def _describe_part(done: Sequence[PerformedPart], folder: Path, count: int) -> str:
    """Return a line about the last performed part."""
    part = done[-1]
    minutes, seconds = divmod(round(part.duration), 60)
    page = folder / part.verdict.file / "report.html"
    return f"part {len(done)} of {count}: {part.words} words, {minutes}:{seconds:02} min, {page}"
