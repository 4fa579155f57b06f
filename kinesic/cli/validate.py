"""Verb `kinesic validate`: dry-run many documents in the twin."""

import hashlib
import json
from collections.abc import Generator, Iterable, Iterator
from contextlib import closing
from pathlib import Path

import click

from kinesic.body.calibration import calibration_path
from kinesic.body.config import ConfigError, locate_config
from kinesic.cli.ending_signals import INTERRUPTED_EXIT_CODE
from kinesic.cli.many.table import print_batch_summary
from kinesic.cli.many.workers import Workers
from kinesic.cli.options import Output, Planning
from kinesic.cli.progress import show_stages, show_steps
from kinesic.cli.terminal import console
from kinesic.files.output_file import write_text
from kinesic.files.output_folder import check_folder, is_made, new_folder
from kinesic.report.batch import DocumentVerdict, documents, validate_documents
from kinesic.report.batch_totals import totals
from kinesic.report.checks import Check, CheckStatus
from kinesic.report.report import Json
from kinesic.sim.servo_factors import read_twins
from kinesic.tasks.program import program_files
from kinesic.tasks.store import JOURNAL_FILE

PROGRAM_SUFFIXES = (".py", ".toml", ".so", ".pyd")  # suffixes of program files that affect verdicts
SUMMARY_FILE = "validate.json"  # file name of the summary in the output folder
LISTED_STATUSES: dict[str, CheckStatus] = {"failed": "fail", "poor": "poor"}  # summary key -> status of listed checks


def validate_paths(paths: tuple[Path, ...], planning: Planning, twin: str, workers: Workers, output: Output) -> int:
    """Perform every document of files and folders in the twin.

    An interrupted run resumes in its folder.
    """
    resumes = output.out is not None and _check_folder(output.out, force=output.force)
    twins = read_twins(twin)
    with show_stages() as stage:
        stage("reading the robot")
        planning.set_up()  # Report an invalid option once here, not in each process.
    files = documents(paths)
    folder = output.out
    if folder is not None and not resumes:
        with new_folder(folder, force=output.force):
            pass
    settings = fingerprint_inputs(planning, twin) if folder else ""
    with workers.engine() as engine:
        results = validate_documents(
            files, planning.set_up, engine=engine, twins=twins, folder=folder, settings=settings
        )
        verdicts, finished = _collect_verdicts(results, len(files))
    order = {str(file): number for number, file in enumerate(files)}
    verdicts.sort(key=lambda verdict: order[verdict.file])
    data: dict[str, Json] = {
        "documents": [_to_entry(verdict) for verdict in verdicts],
        "totals": totals(verdicts),
        "interrupted": not finished,
    }
    text = json.dumps(data, indent=1)
    if output.as_json:
        click.echo(text)
    else:
        print_batch_summary(verdicts, console())
    if folder and finished:
        write_text(folder / SUMMARY_FILE, text, force=True)  # The summary marks the run as finished.
        click.echo(f"summary: {folder / SUMMARY_FILE}", err=output.as_json)
    if not finished:
        hint = "the same command resumes the run" if folder else "with --out DIR a run can be resumed"
        click.echo(f"kinesic: interrupted after {len(verdicts)} of {len(files)} documents; {hint}", err=True)
        return INTERRUPTED_EXIT_CODE
    return max((verdict.exit for verdict in verdicts), default=0)


def _check_folder(out: Path, *, force: bool) -> bool:
    """Return whether the folder holds an interrupted run to resume.

    Raises:
        ConfigError: the folder holds other files, or a finished run.
    """
    if not force and is_made(out):
        if (out / SUMMARY_FILE).exists():
            raise ConfigError(f"{out} contains a finished run; --force starts again, --out names another folder")
        if (out / JOURNAL_FILE).exists():
            return True
    check_folder(out, force=force)
    return False


def fingerprint_inputs(planning: Planning, *others: str) -> str:
    """Hash all inputs that could change a verdict: options, named files, program.

    Args:
        planning: options of planning.
        others: further options, each of which may name a file.
    """
    digest = hashlib.sha256(repr((planning, others)).encode())
    calibration = calibration_path(locate_config("robot", planning.robot))
    files = (planning.options.get("lexicon"), planning.options.get("targets"))
    named = (planning.robot, calibration, planning.style, *files, *others)
    for file in (
        *program_files(PROGRAM_SUFFIXES),
        *_list_files(option for option in named if isinstance(option, str | Path)),
    ):
        digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()


def _list_files(options: Iterable[str | Path]) -> Iterator[Path]:
    """Yield the files that options name, including files in named folders."""
    for option in options:
        path = Path(option)
        if path.is_file():
            yield path
        elif path.is_dir():
            yield from (file for file in sorted(path.rglob("*")) if file.is_file())


def _collect_verdicts(
    results: Generator[DocumentVerdict, None, None], count: int
) -> tuple[list[DocumentVerdict], bool]:
    """Collect verdicts under a progress bar until finished or interrupted.

    Returns:
        The verdicts, and whether the run finished.
    """
    verdicts: list[DocumentVerdict] = []
    with closing(results), show_steps("dry-running", count) as step:
        try:
            for verdict in results:
                verdicts.append(verdict)
                failure_count = sum(verdict.exit > 0 for verdict in verdicts)
                step(f"{failure_count} failed" if failure_count else "")
        except KeyboardInterrupt:
            return verdicts, False
    return verdicts, True


def _to_entry(verdict: DocumentVerdict) -> dict[str, Json]:
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
    listed_checks: dict[str, Json] = {key: _to_rows(verdict.checks, status) for key, status in LISTED_STATUSES.items()}
    return entry | {"report": verdict.report, **listed_checks}


def _to_rows(checks: Iterable[Check], status: CheckStatus) -> list[Json]:
    return [
        {"name": c.name, "value": c.value, "limit": c.limit, "unit": c.unit, "where": c.where}
        for c in checks
        if c.status == status
    ]
