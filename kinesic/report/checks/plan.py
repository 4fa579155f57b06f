"""Checks of the plan: what it asks of hinges and servos, and how near the robot comes to itself."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Clearance
from kinesic.controller.performance import Performance
from kinesic.report.checks.check import Check, bound, format_time, goal, least

TOLERANCE = 1.001  # on ratios to limits
DUTY = 1.0  # of full PWM
HOLDING_GOAL = 0.4  # share of the stall torque that a posture should need
HOLDING_LIMIT = 0.8  # above which the servo overheats or gives way


def limit_checks(performance: Performance) -> list[Check]:
    """Ratios to limits and margin to the stops at 1 kHz, duty by inverse dynamics, torque to stand still."""
    names = performance.plan.setup.robot.skeleton.names
    slack = TOLERANCE - 1.0
    found = [_margin(performance)]
    for quantity, peak in performance.reference.peaks.shares.items():
        where = f"{names[peak.hinge]} {format_time(peak.time)}"
        name = "limits.reserve" if quantity == "duty" else f"limits.{quantity}"
        found.append(bound(name, float(peak.ratios[peak.hinge]), 1.0, "ratio", where, slack=slack))
    found.append(_duty(performance))
    found.append(_holding(performance))
    return found


def _margin(performance: Performance) -> Check:
    """Degrees to the nearest stop; a motion may lie on it."""
    skeleton = performance.plan.setup.robot.skeleton
    position = performance.reference.peaks.shares["position"]
    half = (skeleton.upper - skeleton.lower) / 2
    margins = np.degrees(half * (1.0 - position.ratios))
    hinge = int(margins.argmin())
    slack = float(np.degrees(half[hinge])) * (TOLERANCE - 1.0)
    return least("limits.margin", float(margins[hinge]), 0.0, "deg", skeleton.names[hinge], slack=slack)


def _duty(performance: Performance) -> Check:
    duty = np.abs(performance.reference.duties)
    row, hinge = np.unravel_index(int(duty.argmax()), duty.shape)
    where = f"{performance.plan.setup.robot.skeleton.names[hinge]} {format_time(performance.measured.times[row])}"
    return bound("limits.duty", float(duty[row, hinge]), DUTY, "ratio", where, slack=TOLERANCE - 1.0)


def _holding(performance: Performance) -> Check:
    times, shares = performance.reference.holding
    row, hinge = np.unravel_index(int(shares.argmax()), shares.shape)
    value = float(shares[row, hinge])
    where = f"{performance.plan.setup.robot.skeleton.names[hinge]} {format_time(times[row])}"
    judge, limit = (bound, HOLDING_LIMIT) if value > HOLDING_LIMIT else (goal, HOLDING_GOAL)
    return judge("limits.holding", value, limit, "of stall", where)


def distance_checks(performance: Performance) -> list[Check]:
    """Smallest distance on plan and twin, with pair and time, and how often segments overlap."""
    plan, measured = performance.plan, performance.measured
    required = plan.setup.robot.least_clearance
    found = []
    for name, clearance, times in (
        ("plan", plan.clearance, plan.clearance_times),
        ("twin", measured.clearance, measured.times),
    ):
        distance, where = smallest_distance(clearance, times)
        found.append(least(f"collision.{name}", distance, required, "m", where))
    overlaps = penetrations(performance)
    deepest = min(found, key=lambda check: check.value)
    where = deepest.where if overlaps else ""
    found.append(bound("collision.penetrations", float(overlaps), 0.0, "samples", where))
    return found


def smallest_distance(clearance: Clearance, times: Floats) -> tuple[float, str]:
    """Smallest distance [m] and where it occurs."""
    worst = clearance.worst
    a, b = clearance.pairs[worst]
    return float(clearance.distances[worst]), f"{a} and {b} {format_time(times[worst])}"


def penetrations(performance: Performance) -> int:
    """Samples of plan and twin at which two segments overlap."""
    return sum(
        int((clearance.distances < 0.0).sum())
        for clearance in (performance.plan.clearance, performance.measured.clearance)
    )
