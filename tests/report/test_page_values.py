"""Tiles of check groups, and numbers, of the report page."""

import pytest

from kinesic.report.page import quantity, tiles
from kinesic.report.report import Json
from kinesic.report.verdict import format_number


def row(name: str, status: str, value: float, limit: float, unit: str = "ratio") -> dict[str, Json]:
    floor = name.startswith("collision")
    return {
        "name": name,
        "status": status,
        "value": value,
        "limit": limit,
        "unit": unit,
        "where": "there",
        "at_least": floor,
    }


def test_each_group_of_checks_has_one_tile_that_shows_its_most_severe_check() -> None:
    result = tiles(
        [
            row("limits.speed", "pass", 0.5, 1.0),
            row("limits.duty", "pass", 0.9, 1.0),
            row("timing.shift", "warn", 0.0832, 0.01, "s"),
            row("timing.twin", "pass", 0.0199, 0.02, "s"),
            row("collision.plan", "pass", 0.05, 0.01, "m"),
            row("collision.twin", "fail", 0.004, 0.01, "m"),
        ]
    )
    assert [(tile.title, tile.status, tile.name) for tile in result] == [
        ("Limits", "pass", "duty"),
        ("Timing", "warn", "shift"),
        ("Clearance", "fail", "twin"),
    ]
    assert [(tile.value, tile.unit, tile.limit) for tile in result] == [
        ("0.90", "", "at most 1.00"),
        ("83.2", "ms", "at most 10 ms"),
        ("4", "mm", "at least 10 mm"),
    ]


def test_value_just_over_its_limit_is_printed_with_enough_digits() -> None:
    (tile,) = tiles([row("limits.jerk", "fail", 1.00123, 1.0)])
    assert (tile.value, tile.limit) == ("1.00123", "at most 1.00")


def test_unknown_group_of_checks_has_a_tile_even_if_a_limit_is_zero() -> None:
    result = tiles([row("weather.rain", "pass", 0.0, 0.0, "strokes"), row("weather.wind", "pass", 3.0, 5.0, "deg")])
    assert [(tile.title, tile.name, tile.limit) for tile in result] == [("Weather", "wind", "at most 5\u00b0")]


@pytest.mark.parametrize(
    ("value", "unit", "shown"),
    [
        (0.0214, "m", ("21.4", "mm")),
        (2.0, "s", ("2", "s")),
        (-0.00638, "times", ("\u22120.0064", "\u00d7")),
        (None, "s", ("\u2013", "s")),
    ],
)
def test_report_values_are_formatted_with_units(value: Json, unit: str, shown: tuple[str, str]) -> None:
    assert quantity(value, unit) == shown


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "\u2013"), (0.012345, "0.0123"), (12345.6, "12346"), (True, "True"), (-0.0, "0"), ("a", "a")],
)
def test_report_numbers_are_rounded_to_three_significant_digits_or_to_an_integer(value: Json, text: str) -> None:
    assert format_number(value) == text
