"""`kinesic validate`: dry-runs many documents."""

import json
import os
from collections.abc import Generator
from contextlib import closing
from pathlib import Path

import click
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from kinesic.body.config import ConfigError
from kinesic.cli.options import TWIN_HELP, PlanningOptions, planning, read_twins
from kinesic.cli.terminal import console
from kinesic.cli.validate_fingerprint import fingerprint
from kinesic.cli.validate_table import summarise
from kinesic.report.batch import JOURNAL, DocumentVerdict, documents, validate_documents
from kinesic.report.batch_totals import totals
from kinesic.report.output import empty_folder
from kinesic.report.report import Json

SUMMARY = "validate.json"
INTERRUPTED = 130


@click.command()
@click.argument("paths", nargs=-1, required=True, type=click.Path(path_type=Path))
@planning
@click.option("--twin", default="nominal", show_default=True, help=TWIN_HELP)
@click.option("--jobs", type=click.IntRange(min=1), help="Processes (default: one for each core).")
@click.option("--out", type=click.Path(path_type=Path), help="Folder of the reports; an interrupted run goes on there.")
@click.option("--force", is_flag=True, help="Begins anew in an existing folder.")
@click.option("--json", "as_json", is_flag=True, help="Prints verdicts and totals as JSON.")
def validate(
    paths: tuple[Path, ...],
    settings: PlanningOptions,
    twin: str,
    jobs: int | None,
    out: Path | None,
    force: bool,
    as_json: bool,
) -> int:
    """Performs every document of PATHS (folders are searched) in the twin.

    With --out, an interrupted run goes on where it stopped when the same command is given again.
    """
    twins = read_twins(twin)
    settings.setup()  # a wrong option is one line here, not one in each process
    files = documents(paths)
    folder = _folder(out, force=force) if out else None
    found = validate_documents(
        files,
        settings.setup,
        jobs=jobs or os.cpu_count() or 1,
        twins=twins,
        folder=folder,
        settings=fingerprint(settings, twin) if folder else "",
    )
    verdicts, finished = _gathered(found, len(files))
    order = {str(file): number for number, file in enumerate(files)}
    verdicts.sort(key=lambda verdict: order[verdict.file])
    data: dict[str, Json] = {
        "documents": [_entry(verdict) for verdict in verdicts],
        "totals": totals(verdicts),
        "interrupted": not finished,
    }
    text = json.dumps(data, indent=1)
    if as_json:
        click.echo(text)
    else:
        summarise(verdicts, console())
    if folder and finished:
        fresh = folder / f"{SUMMARY}.new"
        fresh.write_text(text, encoding="utf-8")
        fresh.replace(folder / SUMMARY)  # a run whose summary is there is finished
        click.echo(f"summary: {folder / SUMMARY}", err=as_json)
    if not finished:
        rest = "the same command goes on from here" if folder else "--out DIR lets a run go on where it stopped"
        click.echo(f"kinesic: interrupted after {len(verdicts)} of {len(files)} documents; {rest}", err=True)
        return INTERRUPTED
    return max((verdict.exit for verdict in verdicts), default=0)


def _folder(out: Path, *, force: bool) -> Path:
    """The folder of the reports, new, emptied, or of a run that did not finish.

    Raises:
        ConfigError: it holds something else, or a run that did finish.
    """
    if force or not out.exists():
        return empty_folder(out)
    if (out / SUMMARY).exists():
        raise ConfigError(f"{out} holds a finished run; --force begins anew, --out names another folder")
    if not (out / JOURNAL).exists():
        raise ConfigError(f"{out} exists already; --force replaces it, --out names another")
    return out


def _gathered(found: Generator[DocumentVerdict, None, None], count: int) -> tuple[list[DocumentVerdict], bool]:
    """All verdicts, or those until the run was interrupted, and whether it finished."""
    verdicts: list[DocumentVerdict] = []
    columns = (
        TextColumn("dry-running"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        TextColumn("{task.description}"),
    )
    with closing(found), Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("", total=count)
        try:
            for verdict in found:
                verdicts.append(verdict)
                bad = sum(verdict.exit > 0 for verdict in verdicts)
                progress.update(task, advance=1, description=f"[red]{bad} failed[/]" if bad else "")
        except KeyboardInterrupt:
            return verdicts, False
    return verdicts, True


def _entry(verdict: DocumentVerdict) -> dict[str, Json]:
    entry: dict[str, Json] = {
        "file": verdict.file,
        "outcome": verdict.outcome,
        "exit": verdict.exit,
        "realised": verdict.count("realised"),
        "substituted": verdict.count("substituted"),
        "dropped": verdict.count("dropped"),
    }
    if verdict.error:
        return entry | {"error": verdict.error}
    failed: list[Json] = [
        {"name": c.name, "value": c.value, "limit": c.limit, "unit": c.unit, "where": c.where}
        for c in verdict.checks
        if c.status == "fail"
    ]
    return entry | {"report": verdict.report, "failed": failed}
