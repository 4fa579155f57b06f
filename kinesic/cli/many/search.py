"""Verb `kinesic robots search`: find Pareto-optimal variants of a robot."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from shutil import copyfile

import click
import numpy as np

from kinesic.body.config import ConfigError, locate_config, names_of
from kinesic.body.robot_extension import read_robot
from kinesic.body.robot_schema import RobotFile
from kinesic.cli.many.workers import Workers
from kinesic.cli.options import Output, Planning
from kinesic.cli.plain_words import printable
from kinesic.cli.progress import show_stages
from kinesic.cli.screen.table import Table
from kinesic.cli.screen.text import Text
from kinesic.cli.terminal import console, quote_text
from kinesic.cli.validate import fingerprint_inputs
from kinesic.files.output_file import new_file, write_text
from kinesic.files.output_folder import is_made, new_folder
from kinesic.files.plain_name import plain_stem
from kinesic.report.batch import documents
from kinesic.report.report import Json
from kinesic.studies.designs.pareto import DESIGN_CRITERIA, unbeaten, values_of
from kinesic.studies.designs.search import BASE_DESIGN, SearchResult, search
from kinesic.studies.designs.trial import Trial
from kinesic.studies.designs.variant import Variable, draw_designs, without_defaults, write_design
from kinesic.tasks.journal import Journal
from kinesic.tasks.store import DESIGNS_FILE

SEARCH_JOURNAL_FILE = "tried.jsonl"  # file with the result of each document performed by each design


def search_designs(
    robot: str,
    paths: tuple[Path, ...],
    varied: tuple[str, ...],
    designs: int,
    seed: int,
    style: str,
    workers: Workers,
    output: Output,
) -> int:
    """Evaluate robot variants, then print and write the Pareto-optimal ones."""
    planning = Planning(robot, style, {})
    planning.set_up()  # Report an invalid option once here, not in each process.
    variables = [Variable.parse(text) for text in varied]
    path = locate_config("robot", robot)
    file = read_robot(path, RobotFile)
    drawn_designs = [without_defaults(file, design, path) for design in draw_designs(variables, designs, seed=seed)]
    document_contents = [(str(document), document.read_bytes()) for document in documents(paths)]
    if not document_contents:
        raise ConfigError(f"{', '.join(map(str, paths))}: no documents; name BML files, or a folder that contains some")
    folder = _prepare_folder(output)
    with workers.engine() as engine, show_stages() as stage:
        result = search(
            robot,
            drawn_designs,
            document_contents,
            engine=engine,
            style=style,
            settings=fingerprint_inputs(planning),
            journal=Journal(folder / SEARCH_JOURNAL_FILE, Trial) if folder else None,
            seed=seed,
            stage=stage,
        )
    pareto_designs = unbeaten(result.finished)
    files = _write_designs(result, pareto_designs, robot, path, file, folder) if folder else []
    if output.as_json:
        click.echo(json.dumps(_to_json(result, pareto_designs), indent=1))
    else:
        _print_result(result, pareto_designs)
    for document in files:
        click.echo(f"{document.suffix[1:]}: {document}", err=output.as_json)
    return 0


def _prepare_folder(output: Output) -> Path | None:
    """Create the output folder, or reuse an interrupted search's folder.

    The result is None if no output folder is requested.

    Raises:
        ConfigError: the folder holds a finished search, or other files.
    """
    if output.out is None:
        return None
    if not output.force and is_made(output.out) and (output.out / SEARCH_JOURNAL_FILE).exists():
        if (output.out / DESIGNS_FILE).exists():
            raise ConfigError(
                f"{output.out} contains a finished search; --force starts again, --out names another folder"
            )
        return output.out
    with new_folder(output.out, force=output.force):
        pass
    return output.out


def _write_designs(
    result: SearchResult, pareto_designs: Sequence[Trial], robot: str, path: Path, file: RobotFile, folder: Path
) -> list[Path]:
    """Write one robot file per Pareto-optimal design, and all designs' metrics.

    Each file extends the robot that was varied; a copy of that robot is written if it is not one of kinesic's.
    """
    is_builtin = robot in names_of("robot")
    extends = robot if is_builtin else path.name
    if not is_builtin:
        with new_file(folder / path.name, force=True) as temporary:
            copyfile(path, temporary)
    written: list[Path] = []
    for number, trial in enumerate((trial for trial in pareto_designs if trial.design != BASE_DESIGN), 1):
        name = f"{file.robot.name}_{number}"
        heading = [f"{file.robot.name} with {_describe_design(trial)}, found by `kinesic robots search`."]
        text = write_design(file, trial.design, name=name, extends=extends, heading=heading)
        written.append(folder / f"{plain_stem(file.robot.name, fallback='design')}_{number}.toml")
        write_text(written[-1], text, force=True)
    write_text(
        folder / DESIGNS_FILE, json.dumps(_to_json(result, pareto_designs), indent=1), force=True
    )  # marks the search as finished
    return [*written, folder / DESIGNS_FILE]


def _describe_design(trial: Trial) -> str:
    return ", ".join(f"{name} = {value}" for name, value in trial.design) or "as it is"


def _to_json(result: SearchResult, pareto_designs: Sequence[Trial]) -> dict[str, Json]:
    states = (("finished", result.finished), ("left", result.left), ("out", result.out))
    rows: list[Json] = [
        {
            "design": _describe_design(trial),
            "changes": dict(trial.design),
            "state": state,
            "why": trial.out,
            "unbeaten": trial in pareto_designs,
            "documents": len(trial.documents),
            "worst_stroke_ms": 1000 * trial.worst,
            **{
                name: _to_number(goal.value(trial), more=goal.more)
                for name, goal in DESIGN_CRITERIA.items()
                if trial.body
            },
            "performed": [{**asdict(one), "violations": list(one.violations)} for one in trial.documents],
        }
        for state, trials in states
        for trial in trials
    ]
    rounds: list[Json] = [
        {"documents": search_round.documents, "designs": search_round.designs} for search_round in result.rounds
    ]
    return {"rounds": rounds, "designs": rows}


def _to_number(value: float, *, more: bool) -> float | None:
    return (-value if more else value) if isfinite(value) else None


def _print_result(result: SearchResult, pareto_designs: Sequence[Trial]) -> None:
    screen = console()
    for number, search_round in enumerate(result.rounds, 1):
        screen.print(f"round {number}: {search_round.designs} designs, {search_round.documents} documents")
    base = next(trial for trial in result.finished if trial.design == BASE_DESIGN)
    table = Table("design", title="Pareto-optimal designs")
    for goal in DESIGN_CRITERIA.values():
        table.add_column(f"{goal.head}\n{goal.unit}", justify="right")
    table.add_column("worst\nms", justify="right")
    table.add_column("compared")
    listed_trials = [base, *(trial for trial in pareto_designs if trial is not base)]
    values = values_of(listed_trials)
    for trial, row in zip(listed_trials, values, strict=True):
        cells = [_format_cell(goal.value(trial), goal.step, more=goal.more) for goal in DESIGN_CRITERIA.values()]
        compared = "" if trial is base else _compare(row - values[0])
        lines = [printable(f"{name} {value}") for name, value in trial.design] or ["as it is"]
        name = "\n".join(lines) + ("" if trial in pareto_designs else " (dominated)")
        table.add_row(Text(name), *cells, f"{1000 * trial.worst:.0f}", compared)
    screen.print(table)
    for trial in result.out:
        screen.print(f"rejected: {quote_text(_describe_design(trial))}: {quote_text(trial.out)}")
    click.echo(f"eliminated: {len(result.left)} of {result.rounds[0].designs + len(result.out)} designs")


def _format_cell(value: float, step: float, *, more: bool) -> str:
    digits = max(0, -int(np.floor(np.log10(step))))
    return f"{-value if more else value:.{digits}f}" if isfinite(value) else "?"


def _compare(steps: np.ndarray) -> str:
    """Name the criteria in which a design is better or worse.

    Args:
        steps: differences from the base design for each criterion; negative is better.
    """
    better = [goal.head for goal, step in zip(DESIGN_CRITERIA.values(), steps, strict=True) if step < 0]
    worse = [goal.head for goal, step in zip(DESIGN_CRITERIA.values(), steps, strict=True) if step > 0]
    if not worse:
        return f"better in {', '.join(better)}; worse in nothing" if better else "equal"
    return f"better in {', '.join(better) or 'nothing'}; worse in {', '.join(worse)}"
