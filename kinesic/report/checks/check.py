"""One check of a performance: its value beside its limit, and what it means to be beyond."""

from dataclasses import dataclass
from math import inf
from typing import Literal, Self

Status = Literal["pass", "warn", "fail"]


@dataclass(frozen=True)
class Limit:
    """How values of one name are judged."""

    unit: str
    beyond: Status = "warn"  # a goal that is missed does no harm, and warns; a danger fails
    at_least: bool = False  # whether a value below the limit is the bad one
    danger: float = inf  # a goal's value above this fails, with this as its limit


LIMITS = {
    "limits.margin": Limit("deg", "fail", at_least=True),
    **{f"limits.{quantity}": Limit("ratio", "fail") for quantity in ("position", "speed", "acceleration", "jerk")},
    "limits.reserve": Limit("ratio", "fail"),
    "limits.duty": Limit("ratio", "fail"),
    "limits.holding": Limit("of stall", danger=0.8),  # above which the servo overheats or gives way
    "collision.plan": Limit("m", "fail", at_least=True),
    "collision.twin": Limit("m", "fail", at_least=True),
    "collision.penetrations": Limit("samples", "fail"),
    "timing.shift": Limit("s"),
    "timing.twin": Limit("s"),
    "timing.arrival": Limit("strokes"),
    "timing.stroke_median": Limit("s"),
    "timing.stroke_p95": Limit("s"),
    **{f"tracking.{error}": Limit("deg") for error in ("rmse", "p95", "max")},
    "tracking.lateness": Limit("s"),
    "servo.saturation": Limit("s"),
    "servo.load": Limit("of stall"),
    "power.peak": Limit("A"),
    "power.mean": Limit("A"),
    "power.warming": Limit("K"),
    "smoothness.hands": Limit("times"),
    "measured.performed": Limit("ratio", "fail", at_least=True),
    **{f"measured.{error}": Limit("deg") for error in ("rmse", "p95", "max")},
}


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

    @classmethod
    def of(cls, name: str, value: float, limit: float, where: str = "", *, slack: float = 0.0) -> Self:
        """Judges a value.

        Args:
            name: of the check, in `LIMITS`.
            value: in the unit that stands there.
            limit: likewise.
            where: the value was found.
            slack: by which it may be beyond the limit.
        """
        rule = LIMITS[name]
        if value > rule.danger:
            return cls(name, "fail", value, rule.danger, rule.unit, where)
        good = value >= limit - slack if rule.at_least else value <= limit + slack
        return cls(name, "pass" if good else rule.beyond, value, limit, rule.unit, where, rule.at_least)


def format_time(time: float) -> str:
    """Says a time [s] as places have it."""
    return f"at {round(time, 2) + 0.0:.2f} s"
