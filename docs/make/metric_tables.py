"""Tables of metrics in pages of docs/benchmarks, with the definitions in metric_definitions.toml."""

import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path

from kinesic.bench.metric import Metric

BENCHMARKS = Path(__file__).resolve().parents[1] / "benchmarks"
DEFINITIONS_FILE = Path(__file__).with_name("metric_definitions.toml")
VERDICTS = {True: "met", False: "missed", None: ""}
MISSED_NOTES = {True: "", False: " (missed)", None: ""}


def read_definitions(table: str) -> dict[str, str]:
    """Return the definitions of a table's metrics, in the table's order."""
    definitions: dict[str, str] = tomllib.loads(DEFINITIONS_FILE.read_text(encoding="utf-8"))[table]
    return definitions


def metric_table(metrics: Iterable[Metric], table: str, details: Mapping[str, str]) -> list[str]:
    """Format the metrics of one table of definitions as Markdown.

    Args:
        metrics: measured metrics; those without a definition are left out.
        table: name of the table in metric_definitions.toml.
        details: text of the last column, by full name of the metric.
    """
    found = {metric.name: metric for metric in metrics}
    rows = []
    for name, definition in read_definitions(table).items():
        if name not in found:
            continue  # for example the nearest of no pairs
        metric, short = found[name], name.partition(".")[2]
        cells = format_value(metric), format_goal(metric), VERDICTS[metric.ok], details.get(name, "")
        rows.append((f"`{short}`", definition, *cells))
    return format_table("metric", "definition", "value", "goal", "result", "details", rows=rows)


def compared_table(
    metrics: Iterable[Metric], table: str, columns: Mapping[str, str], details: Mapping[str, str]
) -> list[str]:
    """Format several measurements of the same metrics as Markdown columns.

    Args:
        metrics: measured metrics; the goal of a row is that of its first metric.
        table: name of the table in metric_definitions.toml.
        columns: prefix of the metrics' names, by title of the column.
        details: text of the last column, by full name of the row's first metric.
    """
    found = {metric.name: metric for metric in metrics}
    rows = []
    for name, definition in read_definitions(table).items():
        values = [found.get(prefix + name) for prefix in columns.values()]
        first = next((metric for metric in values if metric is not None), None)
        if first is None:
            continue
        cells = ["" if metric is None else format_value(metric, MISSED_NOTES[metric.ok]) for metric in values]
        rows.append((f"`{name}`", definition, *cells, format_goal(first), details.get(first.name, "")))
    return format_table("metric", "definition", *columns, "goal", "details", rows=rows)


def format_value(metric: Metric, note: str = "") -> str:
    """Format a value with three significant digits, its unit and a note."""
    unit = metric.unit.removesuffix("count")
    return ("not measured" if metric.value is None else f"{format_number(metric.value)} {unit}".strip()) + note


def format_number(value: float) -> str:
    """Format a number with three digits, without exponent below a million."""
    return f"{value:.0f}" if 100 <= abs(value) < 1e6 else f"{value:.3g}"


def format_goal(metric: Metric) -> str:
    """Format a metric's goal with its direction, such as `<= 5`."""
    if metric.goal is None:
        return ""
    return "0" if metric.goal == 0.0 else f"{'>=' if metric.better == 'higher' else '<='} {metric.goal:g}"


def format_table(*header: str, rows: Iterable[Iterable[str]]) -> list[str]:
    """Format rows as a Markdown table without empty columns."""
    cells = [tuple(row) for row in rows]
    kept = [k for k, title in enumerate(header) if k == 0 or any(row[k] for row in cells)]
    lines = ["| " + " | ".join(row[k] for k in kept) + " |" for row in (header, *cells)]
    return [lines[0], "|---" * len(kept) + "|", *lines[1:]]


def replace_tables(page: Path, tables: Mapping[str, Iterable[str]]) -> None:
    """Replace a page's tables between `<!-- NAME -->` and `<!-- end of NAME -->`."""
    text = page.read_text(encoding="utf-8")
    for name, lines in tables.items():
        begin, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
        before, _, rest = text.partition(begin)
        text = "\n".join([before + begin, "", *lines, "", end + rest.partition(end)[2]])
    page.write_text(text, encoding="utf-8")
