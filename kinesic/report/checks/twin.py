"""Measurements and checks of the twin: timing, tracking and smoothness."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

import numpy as np

from kinesic.controller.learned_gains import describe_estimate
from kinesic.metrics.dry_run import DryRun
from kinesic.metrics.smoothness import visible_jerk
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.report.checks.check import Check, format_time
from kinesic.report.labels import label_sync
from kinesic.sim.servo_factors import NOMINAL_FACTORS

MAX_STROKE_MEDIAN = 0.015  # [s] limit of the median timing error of strokes
MAX_STROKE_P95 = 0.030  # [s] limit of the 95th percentile of stroke timing errors
MAX_ARRIVAL_LAG = 0.020  # [s] largest difference, early or late, of the twin's stroke from its planned time
RMSE_LIMITS = {True: 0.2, False: 1.0}  # [deg] RMS tracking error limits: nominal servos (True), others (False)
P95_LIMIT = 2.5  # [deg] limit of the 95th percentile of tracking errors
PEAK_ERROR_LIMIT = 5.0  # [deg] limit of the largest tracking error
MAX_LATENESS = 0.030  # [s] limit of a joint's tracking delay
MAX_JERK_RATIO = 2.0  # limit of the ratio of performed to planned squared hand jerk
INVISIBLE_JERK = 0.5 * (0.0005 * (2.0 * np.pi * 5.0) ** 3) ** 2  # [m^2/s^6] squared jerk of a shake of 0.5 mm at 5 Hz


def timing_checks(performance: DryRun) -> list[Check]:
    """Check the plan's sync point shifts and the twin's stroke timing.

    Errors are relative to the plan and to BML. Strokes that never arrive are counted.
    """
    return [_shift(performance), *_arrival(performance), *_strokes(performance)]


def stroke_errors(performance: DryRun) -> list[tuple[float | None, str]]:
    """Return timing error [s] and name of each stroke in the twin.

    The error is relative to the requested time; None if the stroke never arrives.
    """
    block = performance.plan.timeline.block
    return [
        (None if lag is None else sync.planned + lag - sync.requested, label_sync(sync, block))
        for sync, lag in performance.lags.items()
        if sync.is_stroke
    ]


def _shift(performance: DryRun) -> Check:
    moved = [sync for sync in performance.plan.syncs if abs(sync.planned - sync.requested) > SHIFT_TO_WARN]
    worst = max(moved, key=lambda sync: abs(sync.planned - sync.requested), default=None)
    if worst is None:
        return Check.of("timing.shift", 0.0, SHIFT_TO_WARN)
    where = f"{len(moved)} moved, most {label_sync(worst, performance.plan.timeline.block)}"
    return Check.of("timing.shift", abs(worst.planned - worst.requested), SHIFT_TO_WARN, where)


def _arrival(performance: DryRun) -> list[Check]:
    late = {sync: abs(lag) for sync, lag in performance.lags.items() if lag is not None and sync.is_stroke}
    if not late:
        return []
    worst = max(late, key=lambda sync: late[sync])
    where = f"{label_sync(worst, performance.plan.timeline.block)} {format_time(worst.planned)}"
    return [Check.of("timing.twin", late[worst], MAX_ARRIVAL_LAG, where)]


def _strokes(performance: DryRun) -> list[Check]:
    strokes = stroke_errors(performance)
    arrived = [(abs(error), name) for error, name in strokes if error is not None]
    lost = [name for error, name in strokes if error is None]
    results = []
    if strokes:
        results.append(Check.of("timing.arrival", float(len(lost)), 0.0, ", ".join(lost)))
    if arrived:
        errors = sorted(error for error, _ in arrived)
        of = f"of {len(errors)} stroke{'s' if len(errors) > 1 else ''}"
        results.append(Check.of("timing.stroke_median", median(errors), MAX_STROKE_MEDIAN, of))
        results.append(Check.of("timing.stroke_p95", _percentile(errors, 0.95), MAX_STROKE_P95, max(arrived)[1]))
    return results


def _percentile(ordered: Sequence[float], fraction: float) -> float:
    """Return a quantile of sorted values, faster than NumPy for short lists."""
    place = fraction * (len(ordered) - 1)
    below = int(place)
    above = min(below + 1, len(ordered) - 1)
    return ordered[below] + (place - below) * (ordered[above] - ordered[below])


@dataclass(frozen=True)
class TwinFigures:
    """Tracking, timing and clearance metrics of one twin."""

    rmse_deg: float
    p95_deg: float
    max_deg: float
    strokes: int
    strokes_lost: int  # number of strokes that the twin never reached
    stroke_median_s: float | None  # median absolute error relative to the requested time
    stroke_p95_s: float | None
    min_distance_m: float


def measure_tracking(performance: DryRun) -> TwinFigures:
    """Measure tracking, stroke timing and clearance of a performance's twin."""
    tracking, strokes = performance.tracking, stroke_errors(performance)
    errors = [abs(error) for error, _ in strokes if error is not None]
    return TwinFigures(
        rmse_deg=tracking.rmse,
        p95_deg=tracking.p95,
        max_deg=tracking.max,
        strokes=len(strokes),
        strokes_lost=len(strokes) - len(errors),
        stroke_median_s=float(np.median(errors)) if errors else None,
        stroke_p95_s=float(np.percentile(errors, 95)) if errors else None,
        min_distance_m=float(performance.measured.clearance.distances.min()),
    )


def tracking_checks(performance: DryRun) -> list[Check]:
    """Check the tracking error and delay of the twin."""
    if not performance.reference.moving.any():
        return []
    names = performance.plan.setup.robot.skeleton.names
    tracking = performance.tracking
    largest = f"{names[tracking.hinge]} {format_time(performance.measured.times[tracking.row])}"
    moving = int(performance.reference.moving.any(axis=0).sum())
    late = np.nan_to_num(np.abs(performance.tracking_delays))
    last = int(late.argmax())
    return [
        Check.of(
            "tracking.rmse",
            tracking.rmse,
            RMSE_LIMITS[performance.twin == NOMINAL_FACTORS],
            f"most {names[tracking.most]}",
        ),
        Check.of("tracking.p95", tracking.p95, P95_LIMIT, f"of {moving} moving hinge{'s' if moving > 1 else ''}"),
        Check.of("tracking.max", tracking.max, PEAK_ERROR_LIMIT, largest),
        Check.of("tracking.lateness", float(late[last]), MAX_LATENESS, names[last]),
        *_restoring(performance),
    ]


def _restoring(performance: DryRun) -> list[Check]:
    """Check whether the observer's correction was reduced to keep servos stable."""
    if performance.restoring == 1.0:
        return []
    return [
        Check.of(
            "tracking.restoring",
            performance.restoring,
            1.0,
            f"more swings: {describe_estimate(performance.servo_estimate)}",
        )
    ]


def motion_checks(performance: DryRun) -> list[Check]:
    """Check each hand's ratio of performed to planned squared jerk.

    Spectral arc length is unsuitable: it is defined for single reaches and stays short for a shaking hand in several.
    """
    reference, period = performance.reference, performance.period
    jerkier: dict[str, float] = {}
    for side, performed in performance.measured.hands.items():
        if reference.smoothness[side] is not None:
            jerkier[side] = visible_jerk(performed, period=period) / (reference.visible_jerks[side] + INVISIBLE_JERK)
    if not jerkier:
        return []
    worst = max(jerkier, key=lambda side: jerkier[side])
    return [Check.of("smoothness.hands", jerkier[worst], MAX_JERK_RATIO, f"{worst}_hand")]
