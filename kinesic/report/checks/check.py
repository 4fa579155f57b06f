"""One verdict: pass, warn or fail, with value, limit and place."""

from dataclasses import dataclass
from typing import Literal

Status = Literal["pass", "warn", "fail"]


@dataclass(frozen=True)
class Check:
    """One verdict."""

    name: str
    status: Status
    value: float
    limit: float
    unit: str
    where: str = ""
    at_least: bool = False  # whether a value below the limit is the bad one


def format_time(time: float) -> str:
    """How a place names its time [s]."""
    return f"at {round(time, 2) + 0.0:.2f} s"


def goal(name: str, value: float, limit: float, unit: str, where: str = "") -> Check:
    """A value that should not exceed its limit: missing it does no harm, so it warns."""
    return Check(name, "pass" if value <= limit else "warn", value, limit, unit, where)


def bound(name: str, value: float, limit: float, unit: str, where: str = "", *, slack: float = 0.0) -> Check:
    """A value that must not exceed its limit by more than the slack: a danger, so it fails."""
    return Check(name, "pass" if value <= limit + slack else "fail", value, limit, unit, where)


def least(name: str, value: float, limit: float, unit: str, where: str = "", *, slack: float = 0.0) -> Check:
    """A value that must not fall below its limit by more than the slack."""
    return Check(name, "pass" if value >= limit - slack else "fail", value, limit, unit, where, at_least=True)
