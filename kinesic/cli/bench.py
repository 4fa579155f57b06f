"""`kinesic bench`: measures a part and prints each figure beside its goal."""

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path

import click
from rich.table import Table

from kinesic.bench import bml, bus, expressivity, face, ik, plan, twin
from kinesic.bench.bml import merging, server, speech
from kinesic.bench.bus import faults
from kinesic.bench.figure import Figure
from kinesic.bench.plan import first_command
from kinesic.cli.terminal import console

PARTS: Mapping[str, Callable[[], list[Figure]]] = {
    "ik": ik.bench,
    "expressivity": expressivity.bench,
    "plan": lambda: [*first_command.bench(), *plan.bench()],
    "twin": twin.bench,
    "bus": lambda: [*bus.bench(), *faults.bench()],
    "bml": lambda: [*bml.bench(), *speech.bench(), *merging.bench(), *server.bench()],
    "face": face.bench,
}


@click.command()
@click.argument("part", type=click.Choice([*PARTS, "all"]))
@click.option("--matrix", is_flag=True, help="Of bus: the whole fault matrix instead, for every driver.")
@click.option("--json", "as_json", is_flag=True, help="Prints a list of figures as JSON.")
@click.option("--plots", type=click.Path(file_okay=False, path_type=Path), help="Draws into this folder, too.")
def bench(part: str, matrix: bool, as_json: bool, plots: Path | None) -> int:
    """Measures PART; timings are medians in a warm process."""
    if matrix:
        if as_json:
            click.echo(json.dumps([fared.record() for fared in faults.compare_drivers()], indent=1))
            return 0
        for fared in faults.compare_drivers():
            click.echo(fared)
        return 0
    names = list(PARTS) if part == "all" else [part]
    figures = [figure for name in names for figure in PARTS[name]()]
    if plots is not None:
        plots.mkdir(parents=True, exist_ok=True)
        ik.draw(figures, plots)
        if "expressivity" in names:
            expressivity.draw(plots)
    if as_json:
        click.echo(json.dumps([asdict(figure) | {"ok": figure.ok} for figure in figures], indent=1))
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
