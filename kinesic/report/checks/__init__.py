"""Checks a performance: pass, warn, poor or fail, each with value, limit and place."""

# A goal that is missed without danger warns (timing, tracking, load), and is poor where an audience would see it;
# limits and distances fail.

from kinesic.controller.performance import Performance
from kinesic.report.checks.check import GRADES, GRAVITY, Check, CheckStatus, Grade, grade
from kinesic.report.checks.content import content_checks
from kinesic.report.checks.plan import TOLERANCE, distance_checks, limit_checks
from kinesic.report.checks.servos import power_checks, servo_checks
from kinesic.report.checks.twin import motion_checks, stroke_errors, timing_checks, tracking_checks
from kinesic.report.checks.watch import watch_checks

__all__ = ["GRADES", "GRAVITY", "TOLERANCE", "Check", "CheckStatus", "Grade", "checks", "grade", "stroke_errors"]


def checks(performance: Performance) -> tuple[Check, ...]:
    """Makes all checks of one performance."""
    parts = (
        limit_checks,
        distance_checks,
        watch_checks,
        content_checks,
        timing_checks,
        tracking_checks,
        servo_checks,
        power_checks,
        motion_checks,
    )
    return tuple(check for part in parts for check in part(performance))
