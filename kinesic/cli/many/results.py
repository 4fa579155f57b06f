"""`kinesic results`: asks the results of a run in SQL, sums them up, or draws them."""

import json
from collections.abc import Mapping
from pathlib import Path

import click
from rich.table import Table

from kinesic.cli.terminal import console, quote_text
from kinesic.files.output_file import new_file
from kinesic.report.plots.results import draw_results
from kinesic.tasks.store import QueryResult, open_store

PICTURE = "results.png"
SUMMARIES: Mapping[str, str] = {  # by the table that they need
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
    """Prints what a query finds; `summary` is a table of each kind of results, and `plot` a picture of them."""
    with open_store(folder) as store:
        if query == "plot":
            path = out or folder / PICTURE
            with new_file(path, force=force or out is None) as fresh:
                draw_results(store, fresh)
            click.echo(f"png: {path}")
            return 0
        asked = [text for table, text in SUMMARIES.items() if table in store.tables] if query == "summary" else [query]
        answers = [store.ask(text) for text in asked]
    if as_json:
        rows = [dict(zip(answer.columns, row, strict=True)) for answer in answers for row in answer.rows]
        click.echo(json.dumps(rows, indent=1, default=str))
        return 0
    for answer in answers:
        console().print(_table(answer))
    return 0


def _table(answer: QueryResult) -> Table:
    table = Table(*answer.columns, box=None)
    for row in answer.rows:
        table.add_row(*(quote_text(_cell(value)) for value in row))
    return table


def _cell(value: object) -> str:
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
