"""One check of a performance: its value, its limit and its severity."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf
from typing import Literal, Self

CheckStatus = Literal["pass", "warn", "poor", "fail"]
SEVERITY_RANKS: dict[CheckStatus, int] = {"fail": 0, "poor": 1, "warn": 2, "pass": 3}  # sort order of check statuses

Grade = Literal["ok", "poor", "fail"]
GRADE_NAMES: tuple[Grade, ...] = ("ok", "poor", "fail")  # grades of a report, the best first


@dataclass(frozen=True)
class Limit:
    """Unit, direction and severity of the limit of one check."""

    unit: str
    beyond: CheckStatus = "warn"  # status beyond the limit: a missed goal warns, a danger fails
    at_least: bool = False  # whether the limit is a minimum
    poor: float | None = None  # bound beyond which an audience sees the miss
    danger: float = inf  # bound above which the status is always `fail`

    def is_beyond(self, value: float, bound: float) -> bool:
        """Return whether a value violates a bound, as NaN always does."""
        return not (value >= bound if self.at_least else value <= bound)


# Check name -> unit, direction and severity of its limit.
CHECK_LIMITS = {
    "limits.margin": Limit("deg", "fail", at_least=True),
    **{f"limits.{quantity}": Limit("ratio", "fail") for quantity in ("position", "speed", "acceleration", "jerk")},
    "limits.reserve": Limit("ratio", "fail"),
    "limits.duty": Limit("ratio", "fail"),
    "limits.holding": Limit("of stall", danger=0.8),  # the servo overheats or yields above this
    "collision.plan": Limit("m", "fail", at_least=True),
    "collision.twin": Limit("m", "fail", at_least=True),
    "collision.penetrations": Limit("samples", "fail"),
    "collision.foreseen": Limit("m", at_least=True, poor=0.0),
    "collision.pace": Limit("ratio", at_least=True, poor=0.5),
    "collision.performed": Limit("ratio", "fail", at_least=True),
    "safety.energy": Limit("J", "fail"),
    "safety.force": Limit("of limit", "fail"),
    "safety.clamp": Limit("N"),  # planning cannot open gaps between links, so that covers are the remedy
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
    """Result of one check: status, value, limit and place."""

    name: str
    status: CheckStatus
    value: float
    limit: float
    unit: str
    where: str = ""
    at_least: bool = False  # whether the limit is a minimum

    @classmethod
    def of(cls, name: str, value: float, limit: float, where: str = "", *, slack: float = 0.0) -> Self:
        """Make a check result by comparing a value with its limit.

        Args:
            name: name of the check, a key of `CHECK_LIMITS`.
            value: measured value in the unit of `CHECK_LIMITS`.
            limit: limit in the same unit.
            where: place or time of the value.
            slack: tolerance beyond the limit.

        Raises:
            LookupError: the check has no limit.
        """
        rule = CHECK_LIMITS.get(name)
        if rule is None:
            raise LookupError(f"no limit of check {name}: add it to CHECK_LIMITS in kinesic/report/checks/check.py")
        if value > rule.danger:
            return cls(name, "fail", value, rule.danger, rule.unit, where)
        if rule.poor is not None and rule.is_beyond(value, rule.poor):
            return cls(name, "poor", value, rule.poor, rule.unit, where, rule.at_least)
        bad = rule.is_beyond(value, limit - slack if rule.at_least else limit + slack)
        return cls(name, rule.beyond if bad else "pass", value, limit, rule.unit, where, rule.at_least)


def grade(verdicts: Iterable[Check]) -> Grade:
    """Return the overall grade of checks, ignoring warnings."""
    statuses = {check.status for check in verdicts}
    return "fail" if "fail" in statuses else "poor" if "poor" in statuses else "ok"


def format_time(time: float) -> str:
    """Format a time [s] as place of a check: `at 1.20 s`."""
    return f"at {round(time, 2) + 0.0:.2f} s"
