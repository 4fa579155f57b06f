"""`kinesic study make`: a perception study of the face, from its stimuli to its tables (thesis 4.4)."""

import json
from math import isnan
from pathlib import Path
from statistics import median

import click
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from kinesic.body.config import ConfigError
from kinesic.cli.terminal import console
from kinesic.face.display import DisplayError
from kinesic.face.render.presets import PRESETS
from kinesic.files.output_folder import check_folder, new_folder
from kinesic.report.output import default_folder
from kinesic.report.report import Json
from kinesic.studies.perception.answers import (
    ALL,
    LABELS,
    MEASURES,
    ComparedMeans,
    Comparison,
    FirstChoices,
    People,
    compare_sides,
    first_choices,
    participants,
    read_answers,
)
from kinesic.studies.perception.design import stimuli
from kinesic.studies.perception.page import draw_stimuli, write_study_page
from kinesic.studies.questionnaire.page import find_origin

EFFECTS = {
    "intensity": ("strength", ("high", "low")),
    "presentation": ("presentation", ("animation", "image")),
    "wrinkles": ("wrinkles", ("with", "without")),
}
LEAST_P = 0.001  # that is told as a number


def make_study(out: Path | None, force: bool, size: int, preset: str, post_to: str) -> int:
    """Draws all faces of the study, and the page that shows them and asks."""
    folder = out or default_folder("study")
    check_folder(folder, force=force)
    find_origin(post_to)
    selected = stimuli()
    try:
        with (
            new_folder(folder, force=force) as fresh,
            Progress(console=Console(stderr=True), transient=True) as progress,
        ):
            task = progress.add_task("faces", total=len(selected))
            for _ in draw_stimuli(selected, fresh / "stimuli", size=size, preset=PRESETS[preset]):
                progress.advance(task)
            write_study_page(fresh / "index.html", post_to=post_to)
    except DisplayError as error:
        raise ConfigError(str(error)) from None
    click.echo(f"page: {folder / 'index.html'}")
    return 0


def analyse_faces(files: tuple[Path, ...], as_json: bool) -> int:
    """Prints how the conditions compare in the answers of all participants."""
    answers = read_answers(files)
    effects = {name: compare_sides(answers, *sides) for name, sides in EFFECTS.items()}
    choices, people = first_choices(answers), participants(answers)
    if as_json:
        tables: dict[str, Json] = {name: _rows(effect) for name, effect in effects.items()}
        shares: list[Json] = [
            {"action": action, "wrinkles": side, "share": _number(share), "answers": choices.counts[action, side]}
            for (action, side), share in choices.shares.items()
        ]
        who: dict[str, Json] = {"answers": len(answers), "participants": people.count, "ages": list(people.ages)}
        click.echo(json.dumps({**who, **tables, "first_choice": shares}, indent=1))
        return 0
    screen = console()
    screen.print(f"{len(answers)} answers of {_people(people)}; bold: different, p < 0.05 (Mann-Whitney)")
    for name, effect in effects.items():
        screen.print(_table(name, effect))
    screen.print(_choices(choices))
    return 0


def _people(people: People) -> str:
    """Says how many participants there were, and how old they are."""
    number = f"{people.count} participant{'' if people.count == 1 else 's'}"
    if not people.ages:
        return number
    told = "" if len(people.ages) == people.count else f", told by {len(people.ages)}"
    span = f"{people.ages[0]}" if people.ages[0] == people.ages[-1] else f"{people.ages[0]}-{people.ages[-1]}"
    return f"{number} (age {span}, median {median(people.ages):g}{told})"


def _table(name: str, effect: Comparison) -> Table:
    """Means of both sides, as in Tables 4.3 and 4.4, and what the test says."""
    heads = [f"{side}\n{measure}" for side in effect.sides for measure in MEASURES]
    table = Table("AU", title=f"effect of {name}", title_justify="left", box=None)
    for head in (*heads, *(f"p\n{measure}" for measure in MEASURES)):
        table.add_column(head, justify="right")
    for action in (*LABELS, ALL):
        cells = [effect.cells[action, measure] for measure in MEASURES]
        table.add_row(action, *(_mean(cell, side) for side in (0, 1) for cell in cells), *(_p(cell) for cell in cells))
    return table


def _mean(cell: ComparedMeans, side: int) -> str:
    text = "-" if isnan(cell.means[side]) else f"{cell.means[side]:.2f}"
    return f"[bold]{text}[/]" if cell.significant else text


def _p(cell: ComparedMeans) -> str:
    if isnan(cell.p):
        return "-"
    return f"{cell.p:.3f}" if cell.p >= LEAST_P else f"< {LEAST_P:g}"


def _choices(choices: FirstChoices) -> Table:
    table = Table("wrinkles", *LABELS, title="first choice", title_justify="left", box=None)
    for side in ("with", "without"):
        shares = [choices.shares[action, side] for action in LABELS]
        table.add_row(side, *("-" if isnan(share) else f"{share:.2f}" for share in shares))
    return table


def _rows(effect: Comparison) -> list[Json]:
    return [
        {
            "action": action,
            "measure": measure,
            **{side: _number(mean) for side, mean in zip(effect.sides, cell.means, strict=True)},
            "answers": list(cell.counts),
            "p": _number(cell.p),
        }
        for (action, measure), cell in effect.cells.items()
    ]


def _number(value: float) -> float | None:
    return None if isnan(value) else value
