"""Checks of the twin: when it meets sync points, how near it stays to the plan, and how smoothly its hands move."""

from dataclasses import dataclass

import numpy as np

from kinesic.controller.performance import Performance
from kinesic.controller.smoothness import dimensionless_jerk
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime
from kinesic.report.checks.check import Check, format_time, goal
from kinesic.sim.servo_factors import NOMINAL

STROKE_MEDIAN = 0.015  # [s]
STROKE_P95 = 0.030  # [s]
ARRIVAL = 0.020  # [s] between plan and twin
RMSE = {True: 0.2, False: 1.0}  # [deg] whether the servos are as described
P95 = 2.5  # [deg]
MAX = 5.0  # [deg]
LATENESS = 0.030  # [s] of a hinge
JERKIER = 2.0  # times the dimensionless jerk


def timing_checks(performance: Performance) -> list[Check]:
    """Shifts of the plan; strokes of the twin against the plan, against what was asked, and those that never came."""
    return [_shift(performance), *_arrival(performance), *_strokes(performance)]


def is_stroke(sync: SyncTime) -> bool:
    """Whether a sync point is a stroke, or one of several."""
    return sync.sync == "stroke" or sync.sync.startswith("stroke:")


def stroke_errors(performance: Performance) -> list[tuple[float | None, str]]:
    """(error [s] to the asked time in the twin, name) of each stroke; None: never arrived."""
    return [
        (None if lag is None else sync.planned + lag - sync.asked, _name(sync))
        for sync, lag in performance.lags.items()
        if is_stroke(sync)
    ]


def _shift(performance: Performance) -> Check:
    moved = [sync for sync in performance.plan.syncs if abs(sync.planned - sync.asked) > SHIFT_TO_WARN]
    worst = max(moved, key=lambda sync: abs(sync.planned - sync.asked), default=None)
    if worst is None:
        return goal("timing.shift", 0.0, SHIFT_TO_WARN, "s")
    where = f"{len(moved)} moved, most {_name(worst)}"
    return goal("timing.shift", abs(worst.planned - worst.asked), SHIFT_TO_WARN, "s", where)


def _arrival(performance: Performance) -> list[Check]:
    late = {sync: abs(lag) for sync, lag in performance.lags.items() if lag is not None and is_stroke(sync)}
    if not late:
        return []
    worst = max(late, key=lambda sync: late[sync])
    return [goal("timing.twin", late[worst], ARRIVAL, "s", f"{_name(worst)} {format_time(worst.planned)}")]


def _strokes(performance: Performance) -> list[Check]:
    strokes = stroke_errors(performance)
    arrived = [(abs(error), name) for error, name in strokes if error is not None]
    lost = [name for error, name in strokes if error is None]
    found = []
    if strokes:
        found.append(goal("timing.arrival", float(len(lost)), 0.0, "strokes", ", ".join(lost)))
    if arrived:
        errors = np.array([error for error, _ in arrived])
        median, of = float(np.median(errors)), f"of {len(errors)} stroke{'s' if len(errors) > 1 else ''}"
        found.append(goal("timing.stroke_median", median, STROKE_MEDIAN, "s", of))
        found.append(goal("timing.stroke_p95", float(np.percentile(errors, 95)), STROKE_P95, "s", max(arrived)[1]))
    return found


def _name(sync: SyncTime) -> str:
    return f"{sync.behaviour}:{sync.sync}"


@dataclass(frozen=True)
class Tracking:
    """Errors of all moving hinges together [deg]; 0 when nothing moves."""

    rmse: float
    p95: float
    max: float


def tracking_errors(performance: Performance) -> Tracking:
    """Root mean square, 95th percentile and largest error over the samples that count."""
    errors = np.degrees(np.abs(performance.errors[performance.reference.moving]))
    if not len(errors):
        return Tracking(0.0, 0.0, 0.0)
    return Tracking(float(np.sqrt(np.mean(errors**2))), float(np.percentile(errors, 95)), float(errors.max()))


def tracking_checks(performance: Performance) -> list[Check]:
    """Error and lateness; none when nothing moves."""
    if not performance.reference.moving.any():
        return []
    names = performance.plan.setup.robot.skeleton.names
    errors = np.nan_to_num(np.abs(performance.errors))
    row, hinge = np.unravel_index(int(errors.argmax()), errors.shape)
    squares = (errors**2).sum(axis=0)
    found = tracking_errors(performance)
    moving = int(performance.reference.moving.any(axis=0).sum())
    late = np.nan_to_num(np.abs(performance.lateness))
    last = int(late.argmax())
    return [
        goal("tracking.rmse", found.rmse, RMSE[performance.twin == NOMINAL], "deg", f"most {names[squares.argmax()]}"),
        goal("tracking.p95", found.p95, P95, "deg", f"of {moving} moving hinge{'s' if moving > 1 else ''}"),
        goal("tracking.max", found.max, MAX, "deg", f"{names[hinge]} {format_time(performance.measured.times[row])}"),
        goal("tracking.lateness", float(late[last]), LATENESS, "s", names[last]),
    ]


def motion_checks(performance: Performance) -> list[Check]:
    """How many times the planned jerk the hands of the twin have, both of them without dimension.

    Spectral arc length would not tell: it is made for single reaches, and of several even a shaking hand's is short.
    """
    jerkier: dict[str, float] = {}
    for side, performed in performance.measured.hands.items():
        planned = performance.reference.smoothness[side]
        if planned is None:
            continue
        found = dimensionless_jerk(performed, period=performance.period)
        if found is not None:
            jerkier[side] = found / planned
    if not jerkier:
        return []
    worst = max(jerkier, key=lambda side: jerkier[side])
    return [goal("smoothness.hands", jerkier[worst], JERKIER, "times", f"{worst}_hand")]
