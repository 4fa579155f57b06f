"""Checks what the twin's errors left of the clearance, and what it cost to keep it."""

from kinesic.controller.performance import COMMANDS_PER_LOOK, Performance
from kinesic.controller.watch.clearance import EASY
from kinesic.report.checks.check import Check, format_time

WHOLE = 0.999  # share of a plan that is all of it


def watch_checks(performance: Performance) -> list[Check]:
    """Checks the clearance with the errors that were measured, how slow time ran, and whether the end was reached."""
    rooms, times = performance.rooms, performance.reference.times
    nearest = int(rooms.argmin())
    least = EASY * performance.plan.setup.robot.least_clearance
    stopped = "" if performance.performed >= WHOLE else f"stopped before contact {format_time(times[-1])}"
    return [
        Check.of("collision.foreseen", float(rooms[nearest]), least, format_time(times[nearest * COMMANDS_PER_LOOK])),
        Check.of("collision.pace", performance.least_pace, WHOLE, ""),
        Check.of("collision.performed", min(1.0, performance.performed), WHOLE, stopped),
    ]
