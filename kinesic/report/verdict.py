"""One-line verdict on a performance."""

from collections.abc import Mapping

from kinesic.report.checks.check import SEVERITY_RANKS
from kinesic.report.report import Json

STATUS_ORDER: list[str] = list(SEVERITY_RANKS)  # statuses of checks, the most severe first
NEUTRAL_STYLE = "neutral"  # style that the verdict does not mention
MAX_NAMED_DROPS = 3  # dropped behaviours listed by name in the verdict


def verdict(data: Mapping[str, Json]) -> str:
    """Return a one-line summary: grade, document and violated checks.

    Args:
        data: data of the report.
    """
    checks = rows_of(data, "checks")
    bad = [row for row in checks if row["status"] in ("fail", "poor")]
    reported = [row for row in bad if row["name"] != "meaning.performed"]  # which names say better
    timing = data["timing"]
    duration = format_number(timing["duration_s"]) if isinstance(timing, dict) else "?"
    counts = (
        (sum(row["status"] == "warn" for row in checks), "missed goal"),
        (len(rows_of(data, "warnings")), "warning"),
    )
    notes = ", ".join(f"{count} {noun}{'s' if count > 1 else ''}" for count, noun in counts if count)
    violations = ", ".join([*(_format_violation(row) for row in sorted(reported, key=severity_rank)), *_dropped(data)])
    subject = f"{data['input']} on {data['robot']}{_style_note(data)}, {duration} s"
    overall_grade = "fail" if any(row["status"] == "fail" for row in bad) else "poor" if bad else "ok"
    return f"{overall_grade}: {subject}, {violations or 'nothing fails'}{'; ' if notes else ''}{notes}"


def _style_note(data: Mapping[str, Json]) -> str:
    """Return a comma and the style's name, unless it is neutral."""
    style = data.get("style")
    name = str(style.get("name", NEUTRAL_STYLE)) if isinstance(style, Mapping) else NEUTRAL_STYLE
    return "" if name == NEUTRAL_STYLE else f", {name}"


def _dropped(data: Mapping[str, Json]) -> list[str]:
    """Return a list with one text about dropped behaviours, empty without any."""
    rows = rows_of(data, "behaviours")
    names = [str(row["name"]) for row in rows if row["outcome"] == "dropped"]
    more = f" and {len(names) - MAX_NAMED_DROPS} more" if len(names) > MAX_NAMED_DROPS else ""
    return [f"{len(names)} of {len(rows)} dropped: {', '.join(names[:MAX_NAMED_DROPS])}{more}"] if names else []


def _format_violation(row: Mapping[str, Json]) -> str:
    """Format a violated check's name, value and limit."""
    word = "limit" if row["status"] == "fail" else "poor below" if row["at_least"] else "poor above"
    return f"{row['name']} {format_number(row['value'])} ({word} {format_number(row['limit'])})"


def severity_rank(row: Mapping[str, Json]) -> int:
    """Return the severity rank of a check, 0 being the most severe."""
    return STATUS_ORDER.index(str(row["status"]))


def format_number(value: Json) -> str:
    """Format a number with three digits, rounded to an integer from 100."""
    if value is None:
        return "\u2013"
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    return f"{value:.0f}" if abs(value) >= 100 else f"{value + 0.0:.3g}"


def rows_of(data: Mapping[str, Json], name: str) -> list[dict[str, Json]]:
    """Return the rows of a report table, or an empty list."""
    table = data[name]
    return [row for row in table if isinstance(row, dict)] if isinstance(table, list) else []
