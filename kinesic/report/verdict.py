"""The verdict on a performance in one line, from what its report says."""

from collections.abc import Mapping

from kinesic.report.checks.check import GRAVITY
from kinesic.report.report import Json

STATUSES: list[str] = list(GRAVITY)  # the gravest first
NAMED = 3  # dropped behaviours that are named


def verdict(data: Mapping[str, Json]) -> str:
    """Says the report in one line: whether all is well, of what, and what is not.

    Args:
        data: what `report` says.
    """
    checks = rows_of(data, "checks")
    bad = [row for row in checks if row["status"] in ("fail", "poor")]
    said = [row for row in bad if row["name"] != "meaning.performed"]  # which names say better
    timing = data["timing"]
    duration = format_number(timing["duration_s"]) if isinstance(timing, dict) else "?"
    counts = (
        (sum(row["status"] == "warn" for row in checks), "missed goal"),
        (len(rows_of(data, "warnings")), "warning"),
    )
    notes = ", ".join(f"{count} {noun}{'s' if count > 1 else ''}" for count, noun in counts if count)
    beyond = ", ".join([*(_beyond(row) for row in sorted(said, key=gravity_of)), *_dropped(data)])
    what = f"{data['input']} on {data['robot']}, {duration} s"
    found = "fail" if any(row["status"] == "fail" for row in bad) else "poor" if bad else "ok"
    return f"{found}: {what}, {beyond or 'nothing fails'}{'; ' if notes else ''}{notes}"


def _dropped(data: Mapping[str, Json]) -> list[str]:
    """What an audience will miss, in a few words; nothing where all is performed."""
    rows = rows_of(data, "behaviours")
    names = [str(row["name"]) for row in rows if row["outcome"] == "dropped"]
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return [f"{len(names)} of {len(rows)} dropped: {', '.join(names[:NAMED])}{more}"] if names else []


def _beyond(row: Mapping[str, Json]) -> str:
    """A check and the limit that it is beyond; units are in the table below."""
    word = "limit" if row["status"] == "fail" else "poor below" if row["at_least"] else "poor above"
    return f"{row['name']} {format_number(row['value'])} ({word} {format_number(row['limit'])})"


def gravity_of(row: Mapping[str, Json]) -> int:
    """Ranks a check by its status, the gravest first."""
    return STATUSES.index(str(row["status"]))


def format_number(value: Json) -> str:
    """Formats a number with three digits that count; other values as they are, none as a dash."""
    if value is None:
        return "\u2013"
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    return f"{value:.0f}" if abs(value) >= 100 else f"{value + 0.0:.3g}"


def rows_of(data: Mapping[str, Json], name: str) -> list[dict[str, Json]]:
    """Lists the rows of a table of the report; none where it has none."""
    table = data[name]
    return [row for row in table if isinstance(row, dict)] if isinstance(table, list) else []
