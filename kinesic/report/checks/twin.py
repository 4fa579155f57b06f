"""Measures and checks the twin: when it meets sync points, how near to the plan and how smoothly it moves."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

import numpy as np

from kinesic.controller.learned_gains import describe_belief
from kinesic.controller.performance import Performance
from kinesic.controller.smoothness import visible_jerk
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.report.checks.check import Check, format_time
from kinesic.report.labels import label_sync
from kinesic.sim.servo_factors import NOMINAL

STROKE_MEDIAN = 0.015  # [s]
STROKE_P95 = 0.030  # [s]
ARRIVAL = 0.020  # [s] between plan and twin
RMSE = {True: 0.2, False: 1.0}  # [deg] whether the servos are as described
P95 = 2.5  # [deg]
MAX = 5.0  # [deg]
LATENESS = 0.030  # [s] of a hinge
JERKIER = 2.0  # times the squared jerk
UNSEEN = 0.5 * (0.0005 * (2.0 * np.pi * 5.0) ** 3) ** 2  # [m^2/s^6] of a shake by 0.5 mm at 5 Hz


def timing_checks(performance: Performance) -> list[Check]:
    """Checks shifts of the plan, and the twin's strokes: against the plan, against BML, and those that never came."""
    return [_shift(performance), *_arrival(performance), *_strokes(performance)]


def stroke_errors(performance: Performance) -> list[tuple[float | None, str]]:
    """Measures (error [s] to the asked time in the twin, name) of each stroke; None: it never arrived."""
    block = performance.plan.timeline.block
    return [
        (None if lag is None else sync.planned + lag - sync.asked, label_sync(sync, block))
        for sync, lag in performance.lags.items()
        if sync.is_stroke
    ]


def _shift(performance: Performance) -> Check:
    moved = [sync for sync in performance.plan.syncs if abs(sync.planned - sync.asked) > SHIFT_TO_WARN]
    worst = max(moved, key=lambda sync: abs(sync.planned - sync.asked), default=None)
    if worst is None:
        return Check.of("timing.shift", 0.0, SHIFT_TO_WARN)
    where = f"{len(moved)} moved, most {label_sync(worst, performance.plan.timeline.block)}"
    return Check.of("timing.shift", abs(worst.planned - worst.asked), SHIFT_TO_WARN, where)


def _arrival(performance: Performance) -> list[Check]:
    late = {sync: abs(lag) for sync, lag in performance.lags.items() if lag is not None and sync.is_stroke}
    if not late:
        return []
    worst = max(late, key=lambda sync: late[sync])
    where = f"{label_sync(worst, performance.plan.timeline.block)} {format_time(worst.planned)}"
    return [Check.of("timing.twin", late[worst], ARRIVAL, where)]


def _strokes(performance: Performance) -> list[Check]:
    strokes = stroke_errors(performance)
    arrived = [(abs(error), name) for error, name in strokes if error is not None]
    lost = [name for error, name in strokes if error is None]
    found = []
    if strokes:
        found.append(Check.of("timing.arrival", float(len(lost)), 0.0, ", ".join(lost)))
    if arrived:
        errors = sorted(error for error, _ in arrived)
        of = f"of {len(errors)} stroke{'s' if len(errors) > 1 else ''}"
        found.append(Check.of("timing.stroke_median", median(errors), STROKE_MEDIAN, of))
        found.append(Check.of("timing.stroke_p95", _percentile(errors, 0.95), STROKE_P95, max(arrived)[1]))
    return found


def _percentile(ordered: Sequence[float], share: float) -> float:
    """The value below which a share of ordered ones is; of a few, NumPy takes longer than all else of the check."""
    place = share * (len(ordered) - 1)
    below = int(place)
    above = min(below + 1, len(ordered) - 1)
    return ordered[below] + (place - below) * (ordered[above] - ordered[below])


@dataclass(frozen=True)
class TwinFigures:
    """How well one twin followed a plan, in few figures to put beside another's; None: there is nothing to measure."""

    rmse_deg: float
    p95_deg: float
    max_deg: float
    strokes: int
    strokes_lost: int  # never reached
    stroke_median_s: float | None  # of the magnitude of the error to the asked time
    stroke_p95_s: float | None
    min_distance_m: float


def measure_tracking(performance: Performance) -> TwinFigures:
    """Measures how well the twin of a performance followed its plan."""
    found, strokes = performance.tracking, stroke_errors(performance)
    errors = [abs(error) for error, _ in strokes if error is not None]
    return TwinFigures(
        rmse_deg=found.rmse,
        p95_deg=found.p95,
        max_deg=found.max,
        strokes=len(strokes),
        strokes_lost=len(strokes) - len(errors),
        stroke_median_s=float(np.median(errors)) if errors else None,
        stroke_p95_s=float(np.percentile(errors, 95)) if errors else None,
        min_distance_m=float(performance.measured.clearance.distances.min()),
    )


def tracking_checks(performance: Performance) -> list[Check]:
    """Checks error and lateness; none when nothing moves."""
    if not performance.reference.moving.any():
        return []
    names = performance.plan.setup.robot.skeleton.names
    found = performance.tracking
    largest = f"{names[found.hinge]} {format_time(performance.measured.times[found.row])}"
    moving = int(performance.reference.moving.any(axis=0).sum())
    late = np.nan_to_num(np.abs(performance.lateness))
    last = int(late.argmax())
    return [
        Check.of("tracking.rmse", found.rmse, RMSE[performance.twin == NOMINAL], f"most {names[found.most]}"),
        Check.of("tracking.p95", found.p95, P95, f"of {moving} moving hinge{'s' if moving > 1 else ''}"),
        Check.of("tracking.max", found.max, MAX, largest),
        Check.of("tracking.lateness", float(late[last]), LATENESS, names[last]),
        *_restoring(performance),
    ]


def _restoring(performance: Performance) -> list[Check]:
    """Warns where servos are known to be so stiff and late that a full correction would swing."""
    if performance.restoring == 1.0:
        return []
    return [
        Check.of(
            "tracking.restoring", performance.restoring, 1.0, f"more swings: {describe_belief(performance.believed)}"
        )
    ]


def motion_checks(performance: Performance) -> list[Check]:
    """Checks how many times the planned jerk the twin's hands have, as far as anybody sees it.

    Spectral arc length would not tell: it is made for single reaches, and of several even a shaking hand's is short.
    """
    reference, period = performance.reference, performance.period
    jerkier: dict[str, float] = {}
    for side, performed in performance.measured.hands.items():
        if reference.smoothness[side] is not None:
            jerkier[side] = visible_jerk(performed, period=period) / (reference.visible_jerks[side] + UNSEEN)
    if not jerkier:
        return []
    worst = max(jerkier, key=lambda side: jerkier[side])
    return [Check.of("smoothness.hands", jerkier[worst], JERKIER, f"{worst}_hand")]
