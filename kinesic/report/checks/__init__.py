"""Checks of a performance, each with status, value, limit and place."""

# A goal that is missed without danger warns (timing, tracking, load), and is poor where an audience would see it;
# limits and distances fail.

from kinesic.metrics.dry_run import DryRun
from kinesic.report.checks.check import GRADE_NAMES, SEVERITY_RANKS, Check, CheckStatus, Grade, grade
from kinesic.report.checks.content import content_checks
from kinesic.report.checks.impacts import impact_checks
from kinesic.report.checks.plan import LIMIT_TOLERANCE, distance_checks, limit_checks
from kinesic.report.checks.servos import power_checks, servo_checks
from kinesic.report.checks.twin import motion_checks, stroke_errors, timing_checks, tracking_checks
from kinesic.report.checks.watch import watch_checks

__all__ = [
    "GRADE_NAMES",
    "LIMIT_TOLERANCE",
    "SEVERITY_RANKS",
    "Check",
    "CheckStatus",
    "Grade",
    "checks",
    "grade",
    "stroke_errors",
]


CHECK_FUNCTIONS = (  # functions of a performance, in the order of the report
    limit_checks,
    distance_checks,
    impact_checks,
    watch_checks,
    content_checks,
    timing_checks,
    tracking_checks,
    servo_checks,
    power_checks,
    motion_checks,
)


def checks(performance: DryRun) -> tuple[Check, ...]:
    """Return the results of all checks of one performance."""
    return tuple(check for function in CHECK_FUNCTIONS for check in function(performance))
