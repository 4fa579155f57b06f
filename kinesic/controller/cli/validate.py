"""`kinesic validate`: dry-runs many documents."""

import json
from pathlib import Path

import click
from rich.console import Console
from rich.progress import track
from rich.table import Table

from kinesic.controller.cli.console import console
from kinesic.controller.cli.options import Settings, planning
from kinesic.controller.output import emptied, free_folder
from kinesic.controller.report import Json
from kinesic.controller.validate import Verdict, documents, totals
from kinesic.controller.validate import validate as validate_documents


@click.command()
@click.argument("paths", nargs=-1, required=True, type=click.Path(path_type=Path))
@planning
@click.option("--jobs", type=click.IntRange(min=1), help="Processes (default: one for each core).")
@click.option("--out", type=click.Path(path_type=Path), help="Folder for one report.json a document.")
@click.option("--force", is_flag=True, help="Replaces an existing folder.")
@click.option("--json", "as_json", is_flag=True, help="Prints verdicts and totals as JSON.")
def validate(
    paths: tuple[Path, ...],
    settings: Settings,
    jobs: int | None,
    out: Path | None,
    force: bool,
    as_json: bool,
) -> int:
    """Performs every document of PATHS (folders are searched) in the twin."""
    settings.facts()  # a wrong option is one line here, not one in each process
    files = documents(paths)
    folder = emptied(free_folder(out, "validate", force=force)) if out else None
    found = validate_documents(files, settings.facts, jobs=jobs)
    progress = track(found, "dry-running", total=len(files), console=Console(stderr=True), transient=True)
    verdicts = sorted(progress, key=lambda verdict: verdict.file)
    reports = {verdict.file: _write(verdict, folder, k) for k, verdict in enumerate(verdicts) if folder}
    if as_json:
        entries = [_entry(verdict, reports.get(verdict.file)) for verdict in verdicts]
        click.echo(json.dumps({"documents": entries, "totals": totals(verdicts)}, indent=1))
    else:
        _print(verdicts)
    return max((verdict.exit for verdict in verdicts), default=0)


def _write(verdict: Verdict, folder: Path, number: int) -> str | None:
    if not verdict.report:
        return None
    path = folder / f"{number:04d}-{Path(verdict.file).stem}.json"
    path.write_text(json.dumps(verdict.report, indent=1), encoding="utf-8")
    return str(path)


def _entry(verdict: Verdict, path: str | None) -> dict[str, Json]:
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
    failed = [check for check in _checks(verdict) if check["status"] == "fail"]
    return entry | {"report": path, "failed": [*failed]}


def _checks(verdict: Verdict) -> list[dict[str, Json]]:
    checks = verdict.report["checks"]
    return [check for check in checks if isinstance(check, dict)] if isinstance(checks, list) else []


def _print(verdicts: list[Verdict]) -> None:
    screen = console()
    for verdict in verdicts:
        if verdict.error:
            screen.print(f"refused  {verdict.error}", highlight=False, markup=False, soft_wrap=True)
        for check in _checks(verdict) if not verdict.error else []:
            if check["status"] == "fail":
                figures = f"{check['name']} {check['value']} (limit {check['limit']}) {check['where']}"
                screen.print(f"failed   {verdict.file}: {figures}", highlight=False, markup=False, soft_wrap=True)
    table = Table("folder", "documents", "performed", "refused", "realised", "substituted", "dropped", box=None)
    for folder in sorted({str(Path(verdict.file).parent) for verdict in verdicts}):
        here = [verdict for verdict in verdicts if str(Path(verdict.file).parent) == folder]
        _add_row(table, folder, here)
    _add_row(table, "all", verdicts)
    screen.print(table)


def _add_row(table: Table, name: str, verdicts: list[Verdict]) -> None:
    counts = [sum(verdict.outcome == outcome for verdict in verdicts) for outcome in ("performed", "refused")]
    shares = [sum(verdict.count(outcome) for verdict in verdicts) for outcome in ("realised", "substituted", "dropped")]
    table.add_row(name, str(len(verdicts)), *(str(number) for number in [*counts, *shares]))
