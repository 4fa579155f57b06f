"""Fractions of answers as text and JSON."""

from collections.abc import Mapping

from kinesic.report.report import Json
from kinesic.studies.gesture_perception.analysis import Fraction


def format_cells(fraction: Fraction) -> tuple[str, ...]:
    """Return table cells of a fraction: answers, rate, confidence interval, p value."""
    low, high = fraction.interval
    return f"{fraction.total}", f"{fraction.rate:.2f}", f"{low:.2f} to {high:.2f}", f"{fraction.p:.3f}"


def format_rate(fraction: Fraction) -> str:
    """Return a fraction's rate with its confidence interval as text."""
    low, high = fraction.interval
    return f"{fraction.rate:.2f} ({low:.2f} to {high:.2f})"


def fractions_to_json(fractions: Mapping[str, Fraction]) -> dict[str, Json]:
    """Convert fractions by name to JSON values."""
    return {name: fraction_to_json(fraction) for name, fraction in fractions.items()}


def fraction_to_json(fraction: Fraction) -> dict[str, Json]:
    """Convert a fraction to JSON values."""
    return {
        "share": fraction.rate,
        "hits": fraction.hits,
        "answers": fraction.total,
        "interval": list(fraction.interval),
        "p": fraction.p,
    }
