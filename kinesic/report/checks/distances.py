"""How near the robot comes to itself."""

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Clearance
from kinesic.controller.performance import Performance
from kinesic.report.checks.check import Check, at, bound, least


def distance_checks(performance: Performance) -> list[Check]:
    """Smallest distance on plan and twin, with pair and time, and how often segments overlap."""
    plan, measured = performance.plan, performance.measured
    required = plan.facts.robot.least_clearance
    found = []
    for name, clearance, times in (
        ("plan", plan.clearance, plan.clearance_times),
        ("twin", measured.clearance, measured.times),
    ):
        distance, where = closest(clearance, times)
        found.append(least(f"collision.{name}", distance, required, "m", where))
    overlaps = penetrations(performance)
    deepest = min(found, key=lambda check: check.value)
    where = deepest.where if overlaps else ""
    found.append(bound("collision.penetrations", float(overlaps), 0.0, "samples", where))
    return found


def closest(clearance: Clearance, times: Floats) -> tuple[float, str]:
    """Smallest distance [m] and where it occurs."""
    worst = clearance.worst
    a, b = clearance.pairs[worst]
    return float(clearance.distances[worst]), f"{a} and {b} {at(times[worst])}"


def penetrations(performance: Performance) -> int:
    """Samples of plan and twin at which two segments overlap."""
    return sum(
        int((clearance.distances < 0.0).sum())
        for clearance in (performance.plan.clearance, performance.measured.clearance)
    )
