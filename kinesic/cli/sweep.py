"""`kinesic sweep`: what a parameter of expressivity changes in a gesture, measured in the twin."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

import click
from rich.table import Table

from kinesic.body.config import ConfigError
from kinesic.cli.many.workers import Workers
from kinesic.cli.options import Output, Planning
from kinesic.cli.progress import show_stages
from kinesic.cli.terminal import console
from kinesic.expressivity.style.style import RANGES
from kinesic.files.output_folder import check_folder, new_folder
from kinesic.report.output import default_folder
from kinesic.report.report import Json
from kinesic.studies.sweep.measures import SHOWN, Measures
from kinesic.studies.sweep.series import (
    LATE,
    MEASURE_OF,
    STROKE,
    Played,
    Series,
    draw_series,
    play_all,
    preset_tasks,
    tasks_of,
)
from kinesic.tasks.store import SWEEP

COLUMNS = ("stroke_error", "peak_speed", "path_length", "swept_volume", "jerk", "overshoot", "torso_travel")


def sweep_gesture(
    gesture: str,
    planning: Planning,
    parameter: str | None,
    values: str | None,
    every: bool,
    workers: Workers,
    output: Output,
) -> int:
    """Plays a gesture over the range of a parameter in the twin, measures and draws it."""
    if every == (parameter is not None):
        raise ConfigError("say --parameter NAME or --all; parameters are " + ", ".join(RANGES))
    folder = output.out or default_folder(f"sweep-{gesture}")
    check_folder(folder, force=output.force)
    known = planning.set_up()
    parameters = list(MEASURE_OF) if parameter is None else [parameter]
    tasks = {name: tasks_of(gesture, name, known, _numbers(values)) for name in parameters}
    named = preset_tasks(gesture, known) if every else {}
    with workers.engine(), show_stages() as stage:
        found = []
        for k, (name, asked) in enumerate(tasks.items()):
            stage(f"sweeping {name}", k / len(parameters) if every else None)
            found.append(Series(gesture, name, tuple(play_all(asked, planning.set_up))))
        stage("measuring the presets of style" if every else "drawing")
        styles = dict(zip(named, play_all(list(named.values()), planning.set_up), strict=True))
        data = _data(gesture, planning.style, found, styles)
        with new_folder(folder, force=output.force) as fresh:
            names = _write(found, fresh, data)
    if output.as_json:
        click.echo(json.dumps(data, indent=1))
    else:
        for series in found:
            console().print(_table(series))
        if styles:
            console().print(_presets(styles))
    for name in names:
        click.echo(f"{Path(name).suffix[1:]}: {folder / name}", err=output.as_json)
    in_time = all(series.in_time for series in found) and all(one.in_time for one in styles.values())
    return 0 if in_time and all(series.monotone for series in found) else 1


def _numbers(text: str | None) -> list[float]:
    if text is None:
        return []
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise ConfigError(f"--values is {text!r}; write numbers with commas between, such as -1,0,1") from None


def _write(found: Sequence[Series], folder: Path, data: Json) -> list[str]:
    """Writes the measures and a picture of each series; returns the names of the files."""
    (folder / SWEEP).write_text(json.dumps(data, indent=1), encoding="utf-8")
    return [SWEEP, *(draw_series(series, folder / f"{series.parameter}.png").name for series in found)]


def _data(gesture: str, style: str, found: Sequence[Series], styles: Mapping[str, Played]) -> dict[str, Json]:
    series: list[Json] = [
        {
            "parameter": each.parameter,
            "measure": MEASURE_OF[each.parameter].name,
            "sign": MEASURE_OF[each.parameter].sign,
            "monotone": each.monotone,
            "worst_stroke_s": each.worst_stroke,
            "played": [{"value": one.value, **asdict(one.measures)} for one in each.played],
        }
        for each in found
    ]
    named: dict[str, Json] = {name: asdict(one.measures) for name, one in styles.items()}
    return {"gesture": gesture, "style": style, "stroke_s": STROKE, "series": series, "presets": named}


def _table(series: Series) -> Table:
    """One row per value, the parameter's own measure first."""
    own = MEASURE_OF[series.parameter]
    names = (own.name, *(name for name in COLUMNS if name != own.name))
    verdict = "[green]monotone[/]" if series.monotone else "[red]not monotone[/]"
    late = "" if series.in_time else f", [red]a stroke is more than {1000 * LATE:.0f} ms off[/]"
    table = _titled(f"{series.gesture}: {series.parameter} ({verdict}{late})", series.parameter, names)
    for one in series.played:
        table.add_row(f"{one.value:g}", *_cells(one.measures, names))
    return table


def _presets(styles: Mapping[str, Played]) -> Table:
    names = ("stroke_speed", "energy", "elbow_offset", *COLUMNS)
    table = _titled("presets", "style", names)
    for name, one in styles.items():
        mark = "" if one.in_time else "[red]late [/]"
        table.add_row(mark + name, *_cells(one.measures, names))
    return table


def _titled(title: str, first: str, names: Sequence[str]) -> Table:
    heads = [f"{SHOWN[name].words}\n{SHOWN[name].unit}" for name in names]
    table = Table(first, title=title, title_justify="left", box=None)
    for head in heads:
        table.add_column(head, justify="right")
    return table


def _cells(measures: Measures, names: Sequence[str]) -> list[str]:
    found = [(getattr(measures, name), SHOWN[name].scale) for name in names]
    return ["-" if value is None else f"{value * scale:.3g}" for value, scale in found]
