"""Study results of compared motion systems: matched speech and ratings."""

from math import isnan

from kinesic.cli.screen.console import Console
from kinesic.cli.screen.table import Table
from kinesic.cli.study.fractions import format_cells, format_rate, fraction_to_json, fractions_to_json
from kinesic.cli.terminal import quote_text
from kinesic.report.report import Json
from kinesic.studies.gesture_perception.analysis import MatchResult
from kinesic.studies.gesture_perception.elo import RatingResult


def print_matches(result: MatchResult, screen: Console) -> None:
    """Print each system's fraction of motions matched with the right speech."""
    screen.print("speech of the motion found (guessing: 0.50); detectable: smallest rate shown with a power of 80 %")
    table = Table("system", "answers", "found", "interval", "p", "detectable")
    for system, fraction in result.systems.items():
        table.add_row(quote_text(system), *format_cells(fraction), _format_number(result.detectable[system], ".2f"))
    screen.print(table)
    screen.print(f"the first of two speeches was chosen: {format_rate(result.first)}, p = {result.first.p:.3f}")


def print_ratings(result: RatingResult, screen: Console) -> None:
    """Print Elo ratings of motion systems, estimated from participants' pairwise choices."""
    screen.print("rating of systems (Elo: a lead of 200 points is 76 %); interval: participants resampled")
    table = Table("system", "answers", "preferred", "rating", "interval")
    for system, rating in result.ratings.items():
        low, high = (_format_number(bound, ".0f") for bound in rating.interval)
        table.add_row(
            quote_text(system), f"{rating.answers}", f"{rating.wins}", f"{rating.points:.0f}", f"{low} to {high}"
        )
    screen.print(table)
    if not result.is_bounded:
        screen.print("a system always won or lost: its pairs get half an answer on each side, and no interval")
    if not result.is_connected:
        screen.print("not all systems were compared directly or indirectly: compare ratings only within a group")


def matches_to_json(result: MatchResult) -> dict[str, Json]:
    """Convert results of matching speech with motion to JSON values."""
    return {
        "systems": {
            system: {**fraction_to_json(fraction), "detectable": _to_number(result.detectable[system])}
            for system, fraction in result.systems.items()
        },
        **fractions_to_json({"first_speech": result.first}),
    }


def ratings_to_json(result: RatingResult) -> dict[str, Json]:
    """Convert Elo ratings of motion systems to JSON values."""
    return {
        "systems": {
            system: {
                "rating": rating.points,
                "interval": [_to_number(bound) for bound in rating.interval],
                "wins": rating.wins,
                "answers": rating.answers,
            }
            for system, rating in result.ratings.items()
        },
        "probabilities": [
            {"preferred": one, "to": other, "probability": probability}
            for (one, other), probability in result.probabilities.items()
        ],
        "bounded": result.is_bounded,
        "connected": result.is_connected,
    }


def _to_number(value: float) -> float | None:
    return None if isnan(value) else value


def _format_number(value: float, form: str) -> str:
    return "-" if isnan(value) else format(value, form)
