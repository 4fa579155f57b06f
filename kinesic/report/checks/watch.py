"""Checks of the clearance watch: predicted clearance and slowed time."""

from kinesic.controller.watch.clearance import SLOWING_FRACTION
from kinesic.metrics.dry_run import COMMANDS_PER_LOOK, DryRun
from kinesic.report.checks.check import Check, format_time

COMPLETE_FRACTION = 0.999  # smallest performed fraction of a complete plan, and smallest time scale at full speed


def watch_checks(performance: DryRun) -> list[Check]:
    """Check the predicted clearance, the time scale and the completed fraction."""
    rooms, times = performance.clearance_forecast, performance.reference.times
    nearest = int(rooms.argmin())
    least = SLOWING_FRACTION * performance.plan.setup.robot.min_clearance
    stopped = "" if performance.performed >= COMPLETE_FRACTION else f"stopped before contact {format_time(times[-1])}"
    return [
        Check.of("collision.foreseen", float(rooms[nearest]), least, format_time(times[nearest * COMMANDS_PER_LOOK])),
        Check.of("collision.pace", performance.min_pace, COMPLETE_FRACTION, ""),
        Check.of("collision.performed", min(1.0, performance.performed), COMPLETE_FRACTION, stopped),
    ]
