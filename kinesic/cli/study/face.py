"""Verb `kinesic study make`: perception study of the face (thesis 4.4)."""

import json
from math import isnan
from pathlib import Path
from statistics import median

import click

from kinesic.body.config import ConfigError
from kinesic.cli.progress import show_steps
from kinesic.cli.screen.table import Table
from kinesic.cli.screen.text import Text
from kinesic.cli.terminal import console, quote_text
from kinesic.face.display import DisplayError
from kinesic.face.render.presets import QUALITY_PRESETS
from kinesic.files.output_folder import check_folder, new_folder
from kinesic.report.output import default_folder
from kinesic.report.report import Json
from kinesic.studies.perception.answers import (
    ACTION_NAMES,
    ALL_ACTIONS,
    RATING_MEASURES,
    ComparedMeans,
    Comparison,
    FirstChoices,
    People,
    compare_sides,
    count_first_choices,
    count_participants,
    read_answers,
)
from kinesic.studies.perception.design import list_stimuli
from kinesic.studies.perception.page import draw_stimuli, write_study_page
from kinesic.studies.questionnaire.page import find_origin

COMPARED_CONDITIONS = {
    "intensity": ("strength", ("high", "low")),
    "presentation": ("presentation", ("animation", "image")),
    "wrinkles": ("wrinkles", ("with", "without")),
}
MIN_PRINTED_P_VALUE = 0.001  # p values below this are printed as < 0.001


def make_study(out: Path | None, force: bool, size: int, preset: str, post_to: str) -> int:
    """Render all faces of the study and write its questionnaire page."""
    folder = out or default_folder("study")
    check_folder(folder, force=force)
    find_origin(post_to)
    stimuli = list_stimuli()
    try:
        with (
            new_folder(folder, force=force) as temporary,
            show_steps("faces", len(stimuli)) as step,
        ):
            for _ in draw_stimuli(stimuli, temporary / "stimuli", size=size, preset=QUALITY_PRESETS[preset]):
                step()
            write_study_page(temporary / "index.html", post_to=post_to)
    except DisplayError as error:
        raise ConfigError(str(error)) from None
    click.echo(f"page: {folder / 'index.html'}")
    return 0


def analyse_faces(files: tuple[Path, ...], as_json: bool) -> int:
    """Print the comparison of conditions over all participants' answers."""
    answers = read_answers(files)
    effects = {name: compare_sides(answers, *sides) for name, sides in COMPARED_CONDITIONS.items()}
    choices, participant_counts = count_first_choices(answers), count_participants(answers)
    if as_json:
        tables: dict[str, Json] = {name: _to_rows(effect) for name, effect in effects.items()}
        fractions: list[Json] = [
            {"action": action, "wrinkles": side, "share": _to_number(share), "answers": choices.counts[action, side]}
            for (action, side), share in choices.shares.items()
        ]
        participants: dict[str, Json] = {
            "answers": len(answers),
            "participants": participant_counts.count,
            "ages": list(participant_counts.ages),
        }
        click.echo(json.dumps({**participants, **tables, "first_choice": fractions}, indent=1))
        return 0
    screen = console()
    screen.print(
        f"{len(answers)} answers of {_describe_participants(participant_counts)}; "
        "bold: significant difference, p < 0.05 (Mann-Whitney, corrected by Holm)"
    )
    for name, effect in effects.items():
        screen.print(_tabulate(name, effect))
        screen.print(_tabulate_sizes(name, effect))
    screen.print(_tabulate_choices(choices))
    return 0


def _describe_participants(people: People) -> str:
    """Describe the number and ages of the participants."""
    number = f"{people.count} participant{'' if people.count == 1 else 's'}"
    if not people.ages:
        return number
    answer_count = "" if len(people.ages) == people.count else f", given by {len(people.ages)}"
    span = f"{people.ages[0]}" if people.ages[0] == people.ages[-1] else f"{people.ages[0]}-{people.ages[-1]}"
    return f"{number} (age {span}, median {median(people.ages):g}{answer_count})"


def _tabulate(name: str, effect: Comparison) -> Table:
    """Tabulate means and p values of both conditions (thesis Tables 4.3, 4.4)."""
    heads = [f"{side}\n{measure}" for side in effect.sides for measure in RATING_MEASURES]
    table = Table("AU", title=f"effect of {name}")
    for head in (*heads, *(f"p\n{measure}" for measure in RATING_MEASURES)):
        table.add_column(head, justify="right")
    for action in (*ACTION_NAMES, ALL_ACTIONS):
        cells = [effect.cells[action, measure] for measure in RATING_MEASURES]
        table.add_row(
            action,
            *(_format_mean(cell, side) for side in (0, 1) for cell in cells),
            *(_format_p(cell.corrected_p) for cell in cells),
        )
    return table


def _tabulate_sizes(name: str, effect: Comparison) -> Table:
    """Tabulate effect sizes between answers and within participants.

    The p values within participants are of the Wilcoxon test, corrected by Holm.
    """
    table = Table("AU", title=f"size of the effect of {name}, and within participants")
    for head in ("people", *(f"{value}\n{measure}" for measure in RATING_MEASURES for value in ("delta", "r", "p"))):
        table.add_column(head, justify="right")
    for action in (*ACTION_NAMES, ALL_ACTIONS):
        cells = [effect.cells[action, measure] for measure in RATING_MEASURES]
        people = f"{cells[0].paired.participants}"  # all measures have the same
        table.add_row(action, people, *(text for cell in cells for text in _format_sizes(cell)))
    return table


def _format_sizes(cell: ComparedMeans) -> tuple[str, str, str]:
    delta, correlation = ("-" if isnan(size) else f"{size:+.2f}" for size in (cell.delta, cell.paired.correlation))
    return delta, correlation, _format_p(cell.corrected_paired_p)


def _format_mean(cell: ComparedMeans, side: int) -> Text:
    text = "-" if isnan(cell.means[side]) else f"{cell.means[side]:.2f}"
    return quote_text(text, style="bold" if cell.significant else "")


def _format_p(p: float) -> str:
    if isnan(p):
        return "-"
    return f"{p:.3f}" if p >= MIN_PRINTED_P_VALUE else f"< {MIN_PRINTED_P_VALUE:g}"


def _tabulate_choices(choices: FirstChoices) -> Table:
    table = Table("wrinkles", *ACTION_NAMES, title="first choice")
    for side in ("with", "without"):
        fractions = [choices.shares[action, side] for action in ACTION_NAMES]
        table.add_row(side, *("-" if isnan(fraction) else f"{fraction:.2f}" for fraction in fractions))
    return table


def _to_rows(effect: Comparison) -> list[Json]:
    return [
        {
            "action": action,
            "measure": measure,
            **{side: _to_number(mean) for side, mean in zip(effect.sides, cell.means, strict=True)},
            "answers": list(cell.counts),
            "p": _to_number(cell.p),
            "p_holm": _to_number(cell.corrected_p),
            "delta": _to_number(cell.delta),
            "within": {
                "participants": cell.paired.participants,
                "difference": _to_number(cell.paired.difference),
                "r": _to_number(cell.paired.correlation),
                "p": _to_number(cell.paired.p),
                "p_holm": _to_number(cell.corrected_paired_p),
            },
        }
        for (action, measure), cell in effect.cells.items()
    ]


def _to_number(value: float) -> float | None:
    return None if isnan(value) else value
