"""Checks of the plan: joint limits, servo limits and body clearance."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Clearance
from kinesic.metrics.dry_run import DryRun
from kinesic.report.checks.check import Check, format_time

LIMIT_TOLERANCE = 1.001  # largest accepted ratio of a peak value of the motion to its limit
MAX_DUTY = 1.0  # largest accepted duty, as a fraction of full PWM
MAX_HOLDING_RATIO = 0.4  # largest recommended ratio of holding torque to stall torque


def limit_checks(performance: DryRun) -> list[Check]:
    """Check motion limits, joint limit margins, duty and holding torque.

    Limits and margin are sampled at 1 kHz; the duty is computed by inverse dynamics.
    """
    names = performance.plan.setup.robot.skeleton.names
    slack = LIMIT_TOLERANCE - 1.0
    results = [_margin(performance)]
    for quantity, peak in performance.reference.peaks.by_quantity.items():
        where = f"{names[peak.hinge]} {format_time(peak.time)}"
        name = "limits.reserve" if quantity == "duty" else f"limits.{quantity}"
        results.append(Check.of(name, float(peak.ratios[peak.hinge]), 1.0, where, slack=slack))
    duty, where = _highest(performance.reference.duties, performance.measured.times, names)
    results.append(Check.of("limits.duty", duty, MAX_DUTY, where, slack=slack))
    times, ratios = performance.reference.holding_torques
    ratio, where = _highest(ratios, times, names)
    return [*results, Check.of("limits.holding", ratio, MAX_HOLDING_RATIO, where)]


def _margin(performance: DryRun) -> Check:
    """Check the smallest margin [deg] of any joint to its limits."""
    skeleton = performance.plan.setup.robot.skeleton
    position = performance.reference.peaks.by_quantity["position"]
    half = (skeleton.upper - skeleton.lower) / 2
    margins = np.degrees(half * (1.0 - position.ratios))
    hinge = int(margins.argmin())
    slack = float(np.degrees(half[hinge])) * (LIMIT_TOLERANCE - 1.0)
    return Check.of("limits.margin", float(margins[hinge]), 0.0, skeleton.names[hinge], slack=slack)


def _highest(values: Floats, times: Floats, names: tuple[str, ...]) -> tuple[float, str]:
    """Return the largest magnitude among (m, n) values, with joint and time.

    Joint and time are one text. The first of equal values counts. Times are (m,) [s].
    """
    peaks = np.maximum(
        values.max(axis=1), -values.min(axis=1)
    )  # needs less memory than all magnitudes of a long motion
    row = int(peaks.argmax())
    hinge = int(np.abs(values[row]).argmax())
    return float(peaks[row]), f"{names[hinge]} {format_time(times[row])}"


def distance_checks(performance: DryRun) -> list[Check]:
    """Check the smallest self-distance in plan and twin, and count overlaps."""
    plan, measured = performance.plan, performance.measured
    required = plan.setup.robot.min_clearance
    results = [
        Check.of(name, distance, required, where)
        for name, (distance, where) in (
            ("collision.plan", smallest_distance(plan.clearance, plan.clearance_times)),
            ("collision.twin", smallest_distance(measured.clearance, measured.times)),
        )
    ]
    overlaps = penetrations(performance)
    where = min(results, key=lambda check: check.value).where if overlaps else ""
    return [*results, Check.of("collision.penetrations", float(overlaps), 0.0, where)]


def smallest_distance(clearance: Clearance, times: Floats) -> tuple[float, str]:
    """Return the smallest self-distance [m], with its segments and time."""
    worst = clearance.worst
    a, b = clearance.pairs[worst]
    return float(clearance.distances[worst]), f"{a} and {b} {format_time(times[worst])}"


def penetrations(performance: DryRun) -> int:
    """Count samples of plan and twin with overlapping segments."""
    return sum(
        int((clearance.distances < 0.0).sum())
        for clearance in (performance.plan.clearance, performance.measured.clearance)
    )
