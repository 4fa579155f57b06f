"""`kinesic results`: asks the results of a run in SQL."""

import json
from pathlib import Path

import click
from rich.table import Table

from kinesic.cli.terminal import console, quote_text
from kinesic.report.batch import JOURNAL
from kinesic.tasks.store import ask

SUMMARY = """
SELECT name AS "check", count(*) AS documents, count(*) FILTER (status = 'fail') AS failed,
    count(*) FILTER (status = 'poor') AS poor, quantile_cont("value", 0.5) AS median,
    quantile_cont("value", 0.95) AS p95, max("limit") AS "limit", any_value(unit) AS unit
FROM checks GROUP BY name ORDER BY failed DESC, poor DESC, name
"""


def ask_results(query: str, folder: Path, as_json: bool) -> int:
    """Prints what a query finds; `summary` is one row for each check."""
    answer = ask(folder, SUMMARY if query == "summary" else query, JOURNAL)
    if as_json:
        rows = [dict(zip(answer.columns, row, strict=True)) for row in answer.rows]
        click.echo(json.dumps(rows, indent=1, default=str))
        return 0
    table = Table(*answer.columns, box=None)
    for row in answer.rows:
        table.add_row(*(quote_text(_cell(value)) for value in row))
    console().print(table)
    return 0


def _cell(value: object) -> str:
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
