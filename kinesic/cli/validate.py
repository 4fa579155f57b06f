"""`kinesic validate`: dry-runs many documents."""

import hashlib
import json
from collections.abc import Generator, Iterable, Iterator
from contextlib import closing
from pathlib import Path

import click
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from kinesic.body.calibration import calibration_path
from kinesic.body.config import ConfigError, locate
from kinesic.cli.ending_signals import STOPPED
from kinesic.cli.many.table import summarise
from kinesic.cli.many.workers import Workers
from kinesic.cli.options import Output, Planning
from kinesic.cli.terminal import console
from kinesic.files.output_file import write_text
from kinesic.files.output_folder import check_folder, is_made, new_folder
from kinesic.report.batch import DocumentVerdict, documents, validate_documents
from kinesic.report.batch_totals import totals
from kinesic.report.checks import Check, CheckStatus
from kinesic.report.report import Json
from kinesic.sim.servo_factors import read_twins
from kinesic.tasks.program import program_files
from kinesic.tasks.store import JOURNAL

PARTS = (".py", ".toml", ".so", ".pyd")  # endings of the program's files
SUMMARY = "validate.json"
LISTED: dict[str, CheckStatus] = {"failed": "fail", "poor": "poor"}  # checks that are listed, by key


def validate_paths(paths: tuple[Path, ...], planning: Planning, twin: str, workers: Workers, output: Output) -> int:
    """Performs every document of files and folders in the twin; an interrupted run goes on in its folder."""
    goes_on = output.out is not None and _check_folder(output.out, force=output.force)
    twins = read_twins(twin)
    planning.set_up()  # a wrong option is one line here, not one in each process
    files = documents(paths)
    folder = output.out
    if folder is not None and not goes_on:
        with new_folder(folder, force=output.force):
            pass
    settings = fingerprint_inputs(planning, twin) if folder else ""
    with workers.engine() as engine:
        found = validate_documents(files, planning.set_up, engine=engine, twins=twins, folder=folder, settings=settings)
        verdicts, finished = _gathered(found, len(files))
    order = {str(file): number for number, file in enumerate(files)}
    verdicts.sort(key=lambda verdict: order[verdict.file])
    data: dict[str, Json] = {
        "documents": [_entry(verdict) for verdict in verdicts],
        "totals": totals(verdicts),
        "interrupted": not finished,
    }
    text = json.dumps(data, indent=1)
    if output.as_json:
        click.echo(text)
    else:
        summarise(verdicts, console())
    if folder and finished:
        write_text(folder / SUMMARY, text, force=True)  # a run whose summary is there is finished
        click.echo(f"summary: {folder / SUMMARY}", err=output.as_json)
    if not finished:
        rest = "the same command goes on from here" if folder else "--out DIR lets a run go on where it stopped"
        click.echo(f"kinesic: interrupted after {len(verdicts)} of {len(files)} documents; {rest}", err=True)
        return STOPPED
    return max((verdict.exit for verdict in verdicts), default=0)


def _check_folder(out: Path, *, force: bool) -> bool:
    """Says whether a folder holds a run that did not finish and goes on.

    Raises:
        ConfigError: it holds something else, or a run that did finish.
    """
    if not force and is_made(out):
        if (out / SUMMARY).exists():
            raise ConfigError(f"{out} holds a finished run; --force begins anew, --out names another folder")
        if (out / JOURNAL).exists():
            return True
    check_folder(out, force=force)
    return False


def fingerprint_inputs(planning: Planning, *others: str) -> str:
    """Hashes everything that could change a verdict: options, files that they name, and the program.

    Args:
        planning: the options of planning.
        others: further options that name a file, or nothing.
    """
    digest = hashlib.sha256(repr((planning, others)).encode())
    calibration = calibration_path(locate("robot", planning.robot))
    files = (planning.options.get("lexicon"), planning.options.get("targets"))
    named = (planning.robot, calibration, planning.style, *files, *others)
    for file in (*program_files(PARTS), *_named(option for option in named if isinstance(option, str | Path))):
        digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()


def _named(options: Iterable[str | Path]) -> Iterator[Path]:
    """Yields files that options name, and those in folders that they name."""
    for option in options:
        path = Path(option)
        if path.is_file():
            yield path
        elif path.is_dir():
            yield from (file for file in sorted(path.rglob("*")) if file.is_file())


def _gathered(found: Generator[DocumentVerdict, None, None], count: int) -> tuple[list[DocumentVerdict], bool]:
    """Gathers verdicts under a progress bar; says, too, whether the run finished before an interruption."""
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
        "partly": verdict.count("partly"),
        "substituted": verdict.count("substituted"),
        "dropped": verdict.count("dropped"),
    }
    if verdict.error:
        return entry | {"error": verdict.error}
    beyond: dict[str, Json] = {key: _rows(verdict.checks, status) for key, status in LISTED.items()}
    return entry | {"report": verdict.report, **beyond}


def _rows(checks: Iterable[Check], status: CheckStatus) -> list[Json]:
    return [
        {"name": c.name, "value": c.value, "limit": c.limit, "unit": c.unit, "where": c.where}
        for c in checks
        if c.status == status
    ]
