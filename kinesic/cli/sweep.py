"""Verb `kinesic sweep`: measure effects of style parameters in the twin."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

import click

from kinesic.body.config import ConfigError
from kinesic.cli.many.workers import Workers
from kinesic.cli.options import Output, Planning
from kinesic.cli.progress import show_stages
from kinesic.cli.screen.table import Table
from kinesic.cli.screen.text import Text
from kinesic.cli.terminal import console, quote_text
from kinesic.expressivity.style.style import EXPRESSIVITY_RANGES
from kinesic.files.output_folder import check_folder, new_folder
from kinesic.report.output import default_folder
from kinesic.report.report import Json
from kinesic.studies.sweep.measures import MEASURE_FORMATS, Measures
from kinesic.studies.sweep.series import (
    MAX_STROKE_ERROR,
    MEASURE_OF,
    STROKE_TIME,
    Played,
    Series,
    draw_series,
    play_all,
    preset_tasks,
    tasks_of,
)
from kinesic.tasks.store import SWEEP_FILE

MEASURE_COLUMNS = ("stroke_error", "peak_speed", "path_length", "swept_volume", "jerk", "overshoot", "torso_travel")


def sweep_gesture(
    gesture: str,
    planning: Planning,
    parameter: str | None,
    values: str | None,
    all_parameters: bool,
    workers: Workers,
    output: Output,
) -> int:
    """Perform a gesture over a parameter's range, measure and plot it."""
    if all_parameters == (parameter is not None):
        raise ConfigError("give --parameter NAME or --all; parameters are " + ", ".join(EXPRESSIVITY_RANGES))
    folder = output.out or default_folder(f"sweep-{gesture}")
    check_folder(folder, force=output.force)
    setup = planning.set_up()
    parameters = list(MEASURE_OF) if parameter is None else [parameter]
    tasks = {name: tasks_of(gesture, name, setup, _parse_values(values)) for name in parameters}
    style_tasks = preset_tasks(gesture, setup) if all_parameters else {}
    with workers.engine(), show_stages() as stage:
        sweeps = []
        for k, (name, sweep_tasks) in enumerate(tasks.items()):
            stage(f"sweeping {name}", k / len(parameters) if all_parameters else None)
            sweeps.append(Series(gesture, name, tuple(play_all(sweep_tasks, planning.set_up))))
        stage("measuring the presets of style" if all_parameters else "drawing")
        styles = dict(zip(style_tasks, play_all(list(style_tasks.values()), planning.set_up), strict=True))
        data = _to_json(gesture, planning.style, sweeps, styles)
        with new_folder(folder, force=output.force) as temporary:
            names = _write_results(sweeps, temporary, data)
    if output.as_json:
        click.echo(json.dumps(data, indent=1))
    else:
        for series in sweeps:
            console().print(_tabulate_series(series))
        if styles:
            console().print(_tabulate_presets(styles))
    for name in names:
        click.echo(f"{Path(name).suffix[1:]}: {folder / name}", err=output.as_json)
    in_time = all(series.in_time for series in sweeps) and all(sample.in_time for sample in styles.values())
    return 0 if in_time and all(series.monotone for series in sweeps) else 1


def _parse_values(text: str | None) -> list[float]:
    if text is None:
        return []
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise ConfigError(f"--values is {text!r}; give numbers separated by commas, such as -1,0,1") from None


def _write_results(sweeps: Sequence[Series], folder: Path, data: Json) -> list[str]:
    """Write all measures, and one plot per swept parameter, returning file names."""
    (folder / SWEEP_FILE).write_text(json.dumps(data, indent=1), encoding="utf-8")
    return [SWEEP_FILE, *(draw_series(series, folder / f"{series.parameter}.png").name for series in sweeps)]


def _to_json(gesture: str, style: str, sweeps: Sequence[Series], styles: Mapping[str, Played]) -> dict[str, Json]:
    series: list[Json] = [
        {
            "parameter": sweep.parameter,
            "measure": MEASURE_OF[sweep.parameter].name,
            "sign": MEASURE_OF[sweep.parameter].sign,
            "monotone": sweep.monotone,
            "worst_stroke_s": sweep.worst_stroke,
            "played": [{"value": sample.value, **asdict(sample.measures)} for sample in sweep.played],
        }
        for sweep in sweeps
    ]
    presets: dict[str, Json] = {name: asdict(sample.measures) for name, sample in styles.items()}
    return {"gesture": gesture, "style": style, "stroke_s": STROKE_TIME, "series": series, "presets": presets}


def _tabulate_series(series: Series) -> Table:
    """Tabulate a sweep by parameter value, with the parameter's own measure first."""
    measure = MEASURE_OF[series.parameter]
    names = (measure.name, *(name for name in MEASURE_COLUMNS if name != measure.name))
    title = Text(f"{series.gesture}: {series.parameter} (")
    title += Text("monotone", "green") if series.monotone else Text("not monotone", "red")
    if not series.in_time:
        title += Text(", ") + Text(f"a stroke error is above {1000 * MAX_STROKE_ERROR:.0f} ms", "red")
    table = _start_table(title + ")", series.parameter, names)
    for sample in series.played:
        table.add_row(f"{sample.value:g}", *_format_measures(sample.measures, names))
    return table


def _tabulate_presets(styles: Mapping[str, Played]) -> Table:
    names = ("stroke_speed", "energy", "elbow_offset", *MEASURE_COLUMNS)
    table = _start_table(Text("presets"), "style", names)
    for name, sample in styles.items():
        late_note = Text("" if sample.in_time else "late ", "red")
        table.add_row(late_note + quote_text(name), *_format_measures(sample.measures, names))
    return table


def _start_table(title: Text, first: str, names: Sequence[str]) -> Table:
    heads = [f"{MEASURE_FORMATS[name].words}\n{MEASURE_FORMATS[name].unit}" for name in names]
    table = Table(first, title=title)
    for head in heads:
        table.add_column(head, justify="right")
    return table


def _format_measures(measures: Measures, names: Sequence[str]) -> list[str]:
    scaled_values = [(getattr(measures, name), MEASURE_FORMATS[name].scale) for name in names]
    return ["-" if value is None else f"{value * scale:.3g}" for value, scale in scaled_values]
