"""Checks of the plan: what it asks of hinges and servos, and how near the robot comes to itself."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Clearance
from kinesic.controller.performance import Performance
from kinesic.report.checks.check import Check, format_time

TOLERANCE = 1.001  # on ratios to limits
DUTY = 1.0  # of full PWM
HOLDING = 0.4  # share of the stall torque that a posture should need


def limit_checks(performance: Performance) -> list[Check]:
    """Checks ratios to limits and margin to the stops at 1 kHz, duty by inverse dynamics, torque to stand still."""
    names = performance.plan.setup.robot.skeleton.names
    slack = TOLERANCE - 1.0
    found = [_margin(performance)]
    for quantity, peak in performance.reference.peaks.shares.items():
        where = f"{names[peak.hinge]} {format_time(peak.time)}"
        name = "limits.reserve" if quantity == "duty" else f"limits.{quantity}"
        found.append(Check.of(name, float(peak.ratios[peak.hinge]), 1.0, where, slack=slack))
    duty, where = _highest(performance.reference.duties, performance.measured.times, names)
    found.append(Check.of("limits.duty", duty, DUTY, where, slack=slack))
    times, shares = performance.reference.holding
    share, where = _highest(shares, times, names)
    return [*found, Check.of("limits.holding", share, HOLDING, where)]


def _margin(performance: Performance) -> Check:
    """Degrees to the nearest stop; a motion may lie on it."""
    skeleton = performance.plan.setup.robot.skeleton
    position = performance.reference.peaks.shares["position"]
    half = (skeleton.upper - skeleton.lower) / 2
    margins = np.degrees(half * (1.0 - position.ratios))
    hinge = int(margins.argmin())
    slack = float(np.degrees(half[hinge])) * (TOLERANCE - 1.0)
    return Check.of("limits.margin", float(margins[hinge]), 0.0, skeleton.names[hinge], slack=slack)


def _highest(values: Floats, times: Floats, names: tuple[str, ...]) -> tuple[float, str]:
    """Finds the largest magnitude of (m, n) values at (m,) times [s], with hinge and time; the first of equal ones."""
    peaks = np.maximum(values.max(axis=1), -values.min(axis=1))  # a long motion has no room for all magnitudes
    row = int(peaks.argmax())
    hinge = int(np.abs(values[row]).argmax())
    return float(peaks[row]), f"{names[hinge]} {format_time(times[row])}"


def distance_checks(performance: Performance) -> list[Check]:
    """Checks the smallest distance on plan and twin, with pair and time, and how often segments overlap."""
    plan, measured = performance.plan, performance.measured
    required = plan.setup.robot.least_clearance
    found = [
        Check.of(name, distance, required, where)
        for name, (distance, where) in (
            ("collision.plan", smallest_distance(plan.clearance, plan.clearance_times)),
            ("collision.twin", smallest_distance(measured.clearance, measured.times)),
        )
    ]
    overlaps = penetrations(performance)
    where = min(found, key=lambda check: check.value).where if overlaps else ""
    return [*found, Check.of("collision.penetrations", float(overlaps), 0.0, where)]


def smallest_distance(clearance: Clearance, times: Floats) -> tuple[float, str]:
    """Finds the smallest distance [m] and where it occurs."""
    worst = clearance.worst
    a, b = clearance.pairs[worst]
    return float(clearance.distances[worst]), f"{a} and {b} {format_time(times[worst])}"


def penetrations(performance: Performance) -> int:
    """Counts samples of plan and twin at which two segments overlap."""
    return sum(
        int((clearance.distances < 0.0).sum())
        for clearance in (performance.plan.clearance, performance.measured.clearance)
    )
