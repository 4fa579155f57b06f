"""`kinesic bench`: measures a part and prints each figure beside its goal."""

import json
from dataclasses import asdict
from importlib import import_module
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory

import click
from rich.table import Table

from kinesic.bench import PARTS
from kinesic.bench.figure import Figure
from kinesic.body.config import names_of
from kinesic.cli.many.workers import Workers
from kinesic.cli.progress import Stage, show_stages, untold
from kinesic.cli.terminal import console
from kinesic.files.held_folder import name_failures
from kinesic.files.output_file import new_file
from kinesic.files.output_folder import check_folder, new_folder
from kinesic.tasks.store import FIGURES

PROGRESS_RATE = 1.0  # [Hz] of pictures of the progress bar, which must not be measured along


def measure(part: str, stage: Stage = untold) -> list[Figure]:
    """Measures a part, and names what it is at; only its own modules are imported."""
    figures: list[Figure] = []
    for module in PARTS[part]:
        stage(f"measuring {module}")
        figures += import_module(f"kinesic.bench.{module}").bench()
    return figures


def print_figures(
    part: str,
    matrix: bool,
    styles: tuple[str, ...],
    capture: Path | None,
    as_json: bool,
    plots: Path | None,
    out: Path | None,
    force: bool,
    workers: Workers,
) -> int:
    """Measures a part, or all, and prints or draws the figures; workers measure gestures of the lexicon."""
    if matrix:
        return _print_matrix(as_json=as_json)
    if (styles or capture) and part != "naturalness":
        raise click.UsageError("--style and --capture are of naturalness alone")
    if out is not None:
        check_folder(out, force=force)
    if plots is not None:
        with name_failures(plots):
            plots.mkdir(parents=True, exist_ok=True)
    names = list(PARTS) if part == "all" else [part]
    with workers.engine(), show_stages(rate=PROGRESS_RATE) as stage:
        if styles or capture:
            stage("measuring naturalness")
            figures = _measure_naturalness(styles, capture)
        else:
            figures = [figure for name in names for figure in measure(name, stage)]
        if plots is not None:
            stage("drawing")
            _draw(figures, names, plots, styles=styles or (() if capture else names_of("style")), force=force)
    text = json.dumps([asdict(figure) | {"ok": figure.ok} for figure in figures], indent=1)
    if out is not None:
        with new_folder(out, force=force) as fresh:
            (fresh / FIGURES).write_text(text, encoding="utf-8")
        click.echo(f"json: {out / FIGURES}", err=as_json)
    if as_json:
        click.echo(text)
        return 0
    table = Table("name", "value", "unit", "goal", "", "", box=None)
    marks = {True: "[green]met[/]", False: "[red]missed[/]", None: ""}
    for figure in figures:
        value = figure.why if figure.value is None else f"{figure.value:.4g}"
        note = "" if figure.value is None else figure.why
        sign = ">=" if figure.better == "higher" else "<="
        goal = "" if figure.goal is None else f"{sign} {figure.goal:g}"
        table.add_row(figure.name, value, figure.unit, goal, marks[figure.ok], note)
    console().print(table)
    return 0


def _measure_naturalness(styles: tuple[str, ...], capture: Path | None) -> list[Figure]:
    """Measures the lexicon in some styles, clips of a folder, or both."""
    from kinesic.bench import naturalness  # noqa: PLC0415 - no other part has styles or clips

    figures = naturalness.bench_styles(styles) if styles else []
    return figures if capture is None else [*figures, *naturalness.bench_clips(capture)]


def _print_matrix(*, as_json: bool) -> int:
    from kinesic.bench.bus import faults  # noqa: PLC0415 - no other part needs the drivers of others

    if as_json:
        with show_stages(rate=PROGRESS_RATE) as stage:
            stage("comparing drivers")
            rows = [fared.record() for fared in faults.compare_drivers()]
        click.echo(json.dumps(rows, indent=1))
        return 0
    for fared in faults.compare_drivers():
        click.echo(fared)
    return 0


def _draw(figures: list[Figure], names: list[str], plots: Path, *, styles: tuple[str, ...], force: bool) -> None:
    """Draws into a folder that may hold other things; no picture is replaced unless forced."""
    from kinesic.bench import expressivity, growth, ik, naturalness  # noqa: PLC0415 - only drawings need all of them

    with TemporaryDirectory() as place:
        pictures = ik.draw(figures, Path(place))
        if "expressivity" in names:
            pictures += expressivity.draw(Path(place))
        if "growth" in names:
            pictures += growth.draw(Path(place))
        if "naturalness" in names and styles:
            pictures += naturalness.draw(styles, Path(place))
        for picture in pictures:
            with new_file(plots / picture.name, force=force) as fresh:
                copyfile(picture, fresh)
