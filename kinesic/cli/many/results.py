"""Verb `kinesic results`: query, summarise or plot stored results."""

import json
from collections.abc import Mapping
from pathlib import Path

import click

from kinesic.cli.plain_words import printable
from kinesic.cli.screen.table import Table
from kinesic.cli.terminal import console, quote_text
from kinesic.files.output_file import new_file
from kinesic.tasks.store import QueryResult, open_store

PICTURE_FILE = "results.png"  # default file name of the plot
SUMMARY_QUERIES: Mapping[str, str] = {  # table -> SQL query that summarises it
    "checks": """
SELECT name AS "check", count(*) AS documents, count(*) FILTER (status = 'fail') AS failed,
    count(*) FILTER (status = 'poor') AS poor, quantile_cont("value", 0.5) AS median,
    quantile_cont("value", 0.95) AS p95, max("limit") AS "limit", any_value(unit) AS unit
FROM checks GROUP BY name ORDER BY failed DESC, poor DESC, name
""",
    "sweep": """
SELECT gesture, style, parameter, count(*) AS played, max(abs(stroke_error)) AS worst_stroke_s,
    min(peak_speed) AS least_peak_speed, max(peak_speed) AS most_peak_speed
FROM sweep GROUP BY ALL ORDER BY parameter
""",
    "figures": "SELECT name, value, unit, goal, better, ok FROM figures ORDER BY ok, name",
    "designs": "SELECT * FROM designs ORDER BY unbeaten DESC, state, lateness",
}


def ask_results(query: str, folder: Path, as_json: bool, out: Path | None, force: bool) -> int:
    """Print or plot the result of an SQL query on stored results.

    The query is SQL, `summary` (a table per kind of result) or `plot` (a picture).
    """
    with open_store(folder) as store:
        if query == "plot":
            from kinesic.report.plots.results import draw_results  # noqa: PLC0415 - needs an extra

            path = out or folder / PICTURE_FILE
            with new_file(path, force=force or out is None) as temporary:
                draw_results(store, temporary)
            click.echo(f"png: {path}")
            return 0
        queries = (
            [text for table, text in SUMMARY_QUERIES.items() if table in store.tables]
            if query == "summary"
            else [query]
        )
        answers = [store.ask(text) for text in queries]
    if as_json:
        rows = [dict(zip(answer.columns, row, strict=True)) for answer in answers for row in answer.rows]
        click.echo(json.dumps(rows, indent=1, default=str))
        return 0
    for answer in answers:
        console().print(_tabulate(answer))
    return 0


def _tabulate(answer: QueryResult) -> Table:
    table = Table(*map(printable, answer.columns))
    for row in answer.rows:
        table.add_row(*(quote_text(_format_cell(value)) for value in row))
    return table


def _format_cell(value: object) -> str:
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
