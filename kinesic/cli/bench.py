"""Verb `kinesic bench`: run benchmarks and compare the results with their goals."""

import json
from collections.abc import Mapping
from dataclasses import asdict
from importlib import import_module
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory

import click

from kinesic.bench import BENCH_PARTS
from kinesic.bench.metric import Metric
from kinesic.body.config import names_of
from kinesic.cli.many.workers import Workers
from kinesic.cli.option_values import MetricsOutput
from kinesic.cli.progress import Stage, ignore_stage, show_stages
from kinesic.cli.screen.table import Table
from kinesic.cli.screen.text import Text
from kinesic.cli.terminal import console, quote_text
from kinesic.files.held_folder import name_failures
from kinesic.files.output_file import new_file
from kinesic.files.output_folder import check_folder, new_folder
from kinesic.host import LIVE_SERVER, VIRTUAL_PORTS, HostFeature
from kinesic.tasks.store import METRICS_FILE

PART_FEATURES: Mapping[str, HostFeature] = {  # benchmark part -> system feature that the part needs
    "bus": VIRTUAL_PORTS,
    "bml": LIVE_SERVER,
    "studio": LIVE_SERVER,
}
PROGRESS_RATE = 1.0  # [Hz] refresh rate of the progress bar, low so that it hardly affects timings


def measure(part: str, stage: Stage = ignore_stage) -> list[Metric]:
    """Run all benchmarks of one part, importing only that part's modules."""
    metrics: list[Metric] = []
    for module in BENCH_PARTS[part]:
        stage(f"measuring {module}")
        metrics += import_module(f"kinesic.bench.{module}").bench()
    return metrics


def _choose_parts(part: str) -> list[str]:
    """Return the benchmark parts to run on this system.

    `all` omits the parts that this system lacks, with a message.

    Raises:
        ConfigError: the part needs a feature that this system lacks.
    """
    if part != "all":
        if part in PART_FEATURES:
            PART_FEATURES[part].require()
        return [part]
    missing = [name for name, feature in PART_FEATURES.items() if not feature.is_available]
    for name in missing:
        click.echo(f"left out: {name}, as {PART_FEATURES[name].name} needs {PART_FEATURES[name].systems}", err=True)
    return [name for name in BENCH_PARTS if name not in missing]


def print_metrics(
    part: str,
    matrix: bool,
    styles: tuple[str, ...],
    capture: Path | None,
    output: MetricsOutput,
    workers: Workers,
) -> int:
    """Run benchmarks of one part or all, and print or plot metrics.

    Workers evaluate the gestures of the lexicon.
    """
    plots, out = output.plots, output.out
    if matrix:
        PART_FEATURES["bus"].require()
        return _print_matrix(as_json=output.as_json)
    if (styles or capture) and part != "naturalness":
        raise click.UsageError("--style and --capture apply only to naturalness")
    if out is not None:
        check_folder(out, force=output.force)
    if plots is not None:
        with name_failures(plots):
            plots.mkdir(parents=True, exist_ok=True)
    part_names = _choose_parts(part)
    with workers.engine(), show_stages(rate=PROGRESS_RATE) as stage:
        if styles or capture:
            stage("measuring naturalness")
            metrics = _measure_naturalness(styles, capture)
        else:
            metrics = [metric for name in part_names for metric in measure(name, stage)]
        if plots is not None:
            stage("drawing")
            _draw(
                metrics, part_names, plots, styles=styles or (() if capture else names_of("style")), force=output.force
            )
    text = json.dumps([asdict(metric) | {"ok": metric.ok} for metric in metrics], indent=1)
    if out is not None:
        with new_folder(out, force=output.force) as temporary:
            (temporary / METRICS_FILE).write_text(text, encoding="utf-8")
        click.echo(f"json: {out / METRICS_FILE}", err=output.as_json)
    if output.as_json:
        click.echo(text)
        return 0
    table = Table("name", "value", "unit", "goal", "", "")
    goal_marks = {True: Text("met", "green"), False: Text("missed", "red"), None: Text()}
    for metric in metrics:
        value = metric.why if metric.value is None else f"{metric.value:.4g}"
        note = "" if metric.value is None else metric.why
        comparison = ">=" if metric.better == "higher" else "<="
        goal = "" if metric.goal is None else f"{comparison} {metric.goal:g}"
        table.add_row(metric.name, quote_text(value), metric.unit, goal, goal_marks[metric.ok], quote_text(note))
    console().print(table)
    return 0


def _measure_naturalness(styles: tuple[str, ...], capture: Path | None) -> list[Metric]:
    """Measure the naturalness of gestures in given styles and of captured clips."""
    from kinesic.bench import naturalness  # noqa: PLC0415 - only this part has styles and clips

    metrics = naturalness.bench_styles(styles) if styles else []
    return metrics if capture is None else [*metrics, *naturalness.bench_clips(capture)]


def _print_matrix(*, as_json: bool) -> int:
    from kinesic.bench.bus import faults  # noqa: PLC0415 - only this part needs third-party drivers

    if as_json:
        with show_stages(rate=PROGRESS_RATE) as stage:
            stage("comparing drivers")
            rows = [result.record() for result in faults.compare_drivers()]
        click.echo(json.dumps(rows, indent=1))
        return 0
    for result in faults.compare_drivers():
        click.echo(result)
    return 0


def _draw(metrics: list[Metric], part_names: list[str], plots: Path, *, styles: tuple[str, ...], force: bool) -> None:
    """Plot benchmark metrics into a folder.

    The folder may contain other files; existing pictures are replaced only if forced.
    """
    from kinesic.bench import expressivity, growth, ik, naturalness  # noqa: PLC0415 - only plots need all of them

    with TemporaryDirectory() as temporary:
        plot_files = ik.draw(metrics, Path(temporary))
        if "expressivity" in part_names:
            plot_files += expressivity.draw(Path(temporary))
        if "growth" in part_names:
            plot_files += growth.draw(Path(temporary))
        if "naturalness" in part_names and styles:
            plot_files += naturalness.draw(styles, Path(temporary))
        for plot_file in plot_files:
            with new_file(plots / plot_file.name, force=force) as temporary_file:
                copyfile(plot_file, temporary_file)
