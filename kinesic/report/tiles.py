"""The checks in groups, each with the one that matters most: the figures at the head of the page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from kinesic.report.report import Json

SEVERITY = {"fail": 0, "warn": 1, "pass": 2}
TITLES = {
    "limits": "Limits",
    "collision": "Clearance",
    "timing": "Timing",
    "tracking": "Tracking",
    "measured": "On the robot",
    "servo": "Servos",
}  # else the word itself
SMALLER = {"s": ("ms", 1000.0), "m": ("mm", 1000.0)}  # for values below 1
SYMBOLS = {"deg": "\u00b0", "times": "\u00d7"}
TIGHT = {"\u00b0"}  # units that stand at the figure


@dataclass(frozen=True)
class Tile:
    """One group of checks."""

    title: str
    status: str
    name: str  # of the check that matters most
    value: str
    unit: str
    limit: str  # with its unit and the side it is on
    where: str
    others: int  # checks in the group beside it


def tiles(checks: Sequence[Mapping[str, Json]]) -> list[Tile]:
    """One tile for each group of checks, by the part of their names before the dot, as they come.

    Args:
        checks: rows of the report.
    """
    groups: dict[str, list[Mapping[str, Json]]] = {}
    for row in checks:
        groups.setdefault(str(row["name"]).split(".")[0], []).append(row)
    return [_tile(TITLES.get(name, name.capitalize()), rows) for name, rows in groups.items()]


def _tile(title: str, rows: list[Mapping[str, Json]]) -> Tile:
    worst = min(rows, key=lambda row: (SEVERITY[str(row["status"])], -_nearness(row)))
    unit = str(worst["unit"])
    value, shown = quantity(worst["value"], unit)
    limit, beside = quantity(worst["limit"], unit)
    if value == limit and worst["status"] != "pass":
        value = f"{worst['value']:.7g}"  # so that it shows on which side it is
    side = "at least" if worst["at_least"] else "at most"
    return Tile(
        title=title,
        status=str(worst["status"]),
        name=str(worst["name"]).split(".", 1)[-1].replace("_", " "),
        value=value,
        unit=shown,
        limit=f"{side} {limit}{'' if beside in TIGHT else ' '}{beside}".rstrip(),
        where=str(worst["where"]),
        others=len(rows) - 1,
    )


def _nearness(row: Mapping[str, Json]) -> float:
    """Share of a limit that is used up: 1 is the limit."""
    value, limit = row["value"], row["limit"]
    if not isinstance(value, int | float) or not isinstance(limit, int | float) or not value or not limit:
        return 0.0
    return limit / value if row["at_least"] else value / limit


def quantity(value: Json, unit: str) -> tuple[str, str]:
    """A value and its unit as people write them."""
    if isinstance(value, int | float) and unit in SMALLER and abs(value) < 1.0:
        unit, scale = SMALLER[unit]
        value = scale * value
    if isinstance(value, float) and unit == "ratio":
        return f"{value:.2f}", ""
    brief = f"{value:.2g}" if isinstance(value, float) and abs(value) < 0.1 else format_number(value)
    return brief.replace("-", "\u2212"), SYMBOLS.get(unit, unit)


def format_number(value: Json) -> str:
    """A number with three digits that count; other values as they are, none as a dash."""
    if value is None:
        return "\u2013"
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    return f"{value:.0f}" if abs(value) >= 100 else f"{value + 0.0:.3g}"
