"""One check of a performance: its value beside its limit, and what it means to be beyond."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf
from typing import Literal, Self

CheckStatus = Literal["pass", "warn", "poor", "fail"]
GRAVITY: dict[CheckStatus, int] = {"fail": 0, "poor": 1, "warn": 2, "pass": 3}

Grade = Literal["ok", "poor", "fail"]
GRADES: tuple[Grade, ...] = ("ok", "poor", "fail")


@dataclass(frozen=True)
class Limit:
    """How values of one name are judged."""

    unit: str
    beyond: CheckStatus = "warn"  # a goal that is missed does no harm, and warns; a danger fails
    at_least: bool = False  # whether a value below the limit is the bad one
    poor: float | None = None  # a goal that is missed by more than this is what an audience sees
    danger: float = inf  # a goal's value above this fails, with this as its limit

    def is_beyond(self, value: float, bound: float) -> bool:
        """Says whether a value is on the bad side of a bound; what is no number is."""
        return not (value >= bound if self.at_least else value <= bound)


LIMITS = {
    "limits.margin": Limit("deg", "fail", at_least=True),
    **{f"limits.{quantity}": Limit("ratio", "fail") for quantity in ("position", "speed", "acceleration", "jerk")},
    "limits.reserve": Limit("ratio", "fail"),
    "limits.duty": Limit("ratio", "fail"),
    "limits.holding": Limit("of stall", danger=0.8),  # above which the servo overheats or gives way
    "collision.plan": Limit("m", "fail", at_least=True),
    "collision.twin": Limit("m", "fail", at_least=True),
    "collision.penetrations": Limit("samples", "fail"),
    "collision.foreseen": Limit("m", at_least=True, poor=0.0),
    "collision.pace": Limit("ratio", at_least=True, poor=0.5),
    "collision.performed": Limit("ratio", "fail", at_least=True),
    "meaning.performed": Limit("ratio", at_least=True, poor=0.9),
    "amplitude.path": Limit("ratio", poor=0.25),
    "timing.shift": Limit("s", poor=0.5),
    "timing.twin": Limit("s", poor=0.1),
    "timing.arrival": Limit("strokes", poor=0.0),
    "timing.stroke_median": Limit("s", poor=0.08),
    "timing.stroke_p95": Limit("s", poor=0.2),
    "tracking.rmse": Limit("deg", poor=3.0),
    "tracking.p95": Limit("deg", poor=7.5),
    "tracking.max": Limit("deg", poor=15.0),
    "tracking.lateness": Limit("s", poor=0.1),
    "tracking.restoring": Limit("ratio", at_least=True),
    "servo.saturation": Limit("s", poor=0.5),
    "servo.load": Limit("of stall"),
    "power.peak": Limit("A"),
    "power.mean": Limit("A"),
    "power.warming": Limit("K"),
    "smoothness.hands": Limit("times", poor=10.0),
    "measured.performed": Limit("ratio", "fail", at_least=True),
    "measured.pace": Limit("ratio", at_least=True, poor=0.5),
    "measured.rmse": Limit("deg", poor=3.0),
    "measured.p95": Limit("deg", poor=7.5),
    "measured.max": Limit("deg", poor=15.0),
}


@dataclass(frozen=True)
class Check:
    """One verdict."""

    name: str
    status: CheckStatus
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
        if rule.poor is not None and rule.is_beyond(value, rule.poor):
            return cls(name, "poor", value, rule.poor, rule.unit, where, rule.at_least)
        bad = rule.is_beyond(value, limit - slack if rule.at_least else limit + slack)
        return cls(name, rule.beyond if bad else "pass", value, limit, rule.unit, where, rule.at_least)


def grade(verdicts: Iterable[Check]) -> Grade:
    """Grades a performance by its gravest check; one that only warns is still ok."""
    statuses = {check.status for check in verdicts}
    return "fail" if "fail" in statuses else "poor" if "poor" in statuses else "ok"


def format_time(time: float) -> str:
    """Says a time [s] as places have it."""
    return f"at {round(time, 2) + 0.0:.2f} s"
