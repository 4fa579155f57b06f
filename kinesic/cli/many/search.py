"""`kinesic robots search`: variants of a robot perform documents, and those that are not beaten are printed."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from shutil import copyfile

import click
import numpy as np
from rich.table import Table
from rich.text import Text

from kinesic.body.config import ConfigError, locate, names_of
from kinesic.body.robot_extension import read_robot
from kinesic.body.robot_schema import RobotFile
from kinesic.cli.many.workers import Workers
from kinesic.cli.options import Output, Planning
from kinesic.cli.plain_words import printable
from kinesic.cli.progress import show_stages
from kinesic.cli.terminal import console, quote_text
from kinesic.cli.validate import fingerprint_inputs
from kinesic.files.output_file import new_file, write_text
from kinesic.files.output_folder import check_folder, is_made, new_folder
from kinesic.files.plain_name import plain_stem
from kinesic.report.batch import documents
from kinesic.report.report import Json
from kinesic.studies.designs.pareto import GOALS, unbeaten, values_of
from kinesic.studies.designs.search import AS_IT_IS, SearchResult, search
from kinesic.studies.designs.trial import Trial
from kinesic.studies.designs.variant import Variable, draw_designs, without_defaults, write_design
from kinesic.tasks.journal import Journal
from kinesic.tasks.store import DESIGNS

JOURNAL = "tried.jsonl"  # of designs that have performed some documents


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
    """Searches designs, prints those that are not beaten, and writes them as robots' files."""
    planning = Planning(robot, style, {})
    planning.set_up()  # a wrong option is one line here, not one in each process
    variables = [Variable.parse(text) for text in varied]
    path = locate("robot", robot)
    file = read_robot(path, RobotFile)
    drawn = [without_defaults(file, design, path) for design in draw_designs(variables, designs, seed=seed)]
    contents = [(str(each), each.read_bytes()) for each in documents(paths)]
    if not contents:
        raise ConfigError(f"{', '.join(map(str, paths))}: no documents; name BML files, or a folder that holds some")
    folder = _begin(output)
    with workers.engine() as engine, show_stages() as stage:
        found = search(
            robot,
            drawn,
            contents,
            engine=engine,
            style=style,
            settings=fingerprint_inputs(planning),
            journal=Journal(folder / JOURNAL, Trial) if folder else None,
            seed=seed,
            stage=stage,
        )
    best = unbeaten(found.finished)
    files = _write(found, best, robot, path, file, folder) if folder else []
    if output.as_json:
        click.echo(json.dumps(_data(found, best), indent=1))
    else:
        _print(found, best)
    for each in files:
        click.echo(f"{each.suffix[1:]}: {each}", err=output.as_json)
    return 0


def _begin(output: Output) -> Path | None:
    """Makes the folder, unless it holds a search that did not finish and goes on."""
    if output.out is None:
        return None
    if not output.force and is_made(output.out) and (output.out / JOURNAL).exists():
        if (output.out / DESIGNS).exists():
            raise ConfigError(f"{output.out} holds a finished search; --force begins anew, --out names another folder")
        return output.out
    check_folder(output.out, force=output.force)
    with new_folder(output.out, force=output.force):
        pass
    return output.out


def _write(
    found: SearchResult, best: Sequence[Trial], robot: str, path: Path, file: RobotFile, folder: Path
) -> list[Path]:
    """Writes what is not beaten as robots that extend the one that was varied, and all figures."""
    is_own = robot in names_of("robot")
    extends = robot if is_own else path.name
    if not is_own:
        with new_file(folder / path.name, force=True) as fresh:
            copyfile(path, fresh)
    written: list[Path] = []
    for number, trial in enumerate((trial for trial in best if trial.design != AS_IT_IS), 1):
        name = f"{file.robot.name}_{number}"
        heading = [f"{file.robot.name} but for {_words(trial)}, found by `kinesic robots search`."]
        text = write_design(file, trial.design, name=name, extends=extends, heading=heading)
        written.append(folder / f"{plain_stem(file.robot.name, fallback='design')}_{number}.toml")
        write_text(written[-1], text, force=True)
    write_text(
        folder / DESIGNS, json.dumps(_data(found, best), indent=1), force=True
    )  # whose search is there is finished
    return [*written, folder / DESIGNS]


def _words(trial: Trial) -> str:
    return ", ".join(f"{name} = {value}" for name, value in trial.design) or "as it is"


def _data(found: SearchResult, best: Sequence[Trial]) -> dict[str, Json]:
    states = (("finished", found.finished), ("left", found.left), ("out", found.out))
    rows: list[Json] = [
        {
            "design": _words(trial),
            "changes": dict(trial.design),
            "state": state,
            "why": trial.out,
            "unbeaten": trial in best,
            "documents": len(trial.documents),
            "worst_stroke_ms": 1000 * trial.worst,
            **{name: _figure(goal.value(trial), more=goal.more) for name, goal in GOALS.items() if trial.body},
            "performed": [{**asdict(one), "violations": list(one.violations)} for one in trial.documents],
        }
        for state, trials in states
        for trial in trials
    ]
    rounds: list[Json] = [{"documents": each.documents, "designs": each.designs} for each in found.rounds]
    return {"rounds": rounds, "designs": rows}


def _figure(value: float, *, more: bool) -> float | None:
    return (-value if more else value) if isfinite(value) else None


def _print(found: SearchResult, best: Sequence[Trial]) -> None:
    screen = console()
    for number, each in enumerate(found.rounds, 1):
        screen.print(f"round {number}: {each.designs} designs, {each.documents} documents")
    base = next(trial for trial in found.finished if trial.design == AS_IT_IS)
    table = Table("design", box=None, title="designs that no other one beats", title_justify="left")
    for goal in GOALS.values():
        table.add_column(f"{goal.head}\n{goal.unit}", justify="right")
    table.add_column("worst\nms", justify="right")
    table.add_column("than as it is")
    shown = [base, *(trial for trial in best if trial is not base)]
    values = values_of(shown)
    for trial, row in zip(shown, values, strict=True):
        cells = [_cell(goal.value(trial), goal.step, more=goal.more) for goal in GOALS.values()]
        compared = "" if trial is base else _compare(row - values[0])
        lines = [printable(f"{name} {value}") for name, value in trial.design] or ["as it is"]
        name = "\n".join(lines) + ("" if trial in best else " (beaten)")
        table.add_row(Text(name), *cells, f"{1000 * trial.worst:.0f}", compared)
    screen.print(table)
    for trial in found.out:
        screen.print(f"out: {quote_text(_words(trial))}: {quote_text(trial.out)}")
    click.echo(f"left behind: {len(found.left)} of {found.rounds[0].designs + len(found.out)} designs")


def _cell(value: float, step: float, *, more: bool) -> str:
    digits = max(0, -int(np.floor(np.log10(step))))
    return f"{-value if more else value:.{digits}f}" if isfinite(value) else "?"


def _compare(steps: np.ndarray) -> str:
    """Says in what a design is better and worse."""
    better = [goal.head for goal, step in zip(GOALS.values(), steps, strict=True) if step < 0]
    worse = [goal.head for goal, step in zip(GOALS.values(), steps, strict=True) if step > 0]
    if not worse:
        return f"better in {', '.join(better)}; worse in nothing" if better else "alike"
    return f"better in {', '.join(better) or 'nothing'}; worse in {', '.join(worse)}"
