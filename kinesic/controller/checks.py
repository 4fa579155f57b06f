"""The dry run's verdicts: pass, warn or fail, each with value, limit and place."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Clearance
from kinesic.controller.performance import Performance
from kinesic.controller.syncs import SHIFT_TO_WARN

Status = Literal["pass", "warn", "fail"]

TOLERANCE = 1.001  # on ratios to limits
STROKE_P95 = 0.030  # [s]
STROKE_MEDIAN = 0.015  # [s]
TRACKING_RMSE = np.radians(0.2)  # [rad] nominal twin
TRACKING_P95 = np.radians(2.5)  # [rad]
TRACKING_MAX = np.radians(5.0)  # [rad]
DUTY = 1.0


@dataclass(frozen=True)
class Check:
    """One verdict."""

    name: str
    status: Status
    value: float
    limit: float
    unit: str
    where: str = ""


def checks(performance: Performance) -> tuple[Check, ...]:
    """All verdicts on one performance.

    A goal that is missed without danger warns (stroke timing, tracking, duty); limits and distances fail.
    """
    return (*_limits(performance), *_distances(performance), *_timing(performance), *_tracking(performance))


def _limits(performance: Performance) -> list[Check]:
    names = performance.plan.facts.robot.skeleton.names
    found = []
    for quantity, ratios in performance.ratios.items():
        worst = int(ratios.argmax())
        status: Status = "pass" if ratios[worst] <= TOLERANCE else "fail"
        found.append(Check(f"limits.{quantity}", status, float(ratios[worst]), 1.0, "ratio", names[worst]))
    duty = np.abs(performance.duties)
    row, hinge = np.unravel_index(int(duty.argmax()), duty.shape)
    where = f"{names[hinge]} at {performance.measured.times[row]:.2f} s"
    found.append(_goal("limits.duty", float(duty[row, hinge]), DUTY, "ratio", where))
    return found


def _distances(performance: Performance) -> list[Check]:
    plan = performance.plan
    least = plan.facts.robot.least_clearance
    places = (
        ("plan", plan.clearance, plan.clearance_times),
        ("twin", performance.measured.clearance, performance.measured.times),
    )
    found = []
    for name, clearance, times in places:
        distance, where = closest(clearance, times)
        status: Status = "pass" if distance >= least else "fail"
        found.append(Check(f"collision.{name}", status, distance, least, "m", where))
    return found


def closest(clearance: Clearance, times: Floats) -> tuple[float, str]:
    """Smallest distance [m] and where it occurs."""
    worst = clearance.worst
    a, b = clearance.pairs[worst]
    return float(clearance.distances[worst]), f"{a} and {b} at {times[worst]:.2f} s"


def stroke_errors(performance: Performance) -> list[tuple[float | None, str]]:
    """(error [s] to the asked time in the twin, name) of each stroke; None: never arrived."""
    return [
        (None if lag is None else sync.planned + lag - sync.asked, f"{sync.behaviour}:{sync.sync}")
        for sync, lag in performance.lags.items()
        if sync.sync == "stroke" or sync.sync.startswith("stroke:")
    ]


def _timing(performance: Performance) -> list[Check]:
    moved = [sync for sync in performance.plan.syncs if abs(sync.planned - sync.asked) > SHIFT_TO_WARN]
    worst = max(moved, key=lambda sync: abs(sync.planned - sync.asked), default=None)
    where = "" if worst is None else f"{len(moved)} moved, most {worst.behaviour}:{worst.sync}"
    shift = 0.0 if worst is None else abs(worst.planned - worst.asked)
    found = [_goal("timing.shift", shift, SHIFT_TO_WARN, "s", where)]
    strokes = stroke_errors(performance)
    arrived = [(abs(error), name) for error, name in strokes if error is not None]
    lost = [name for error, name in strokes if error is None]
    if lost:
        found.append(Check("timing.arrival", "warn", float(len(lost)), 0.0, "strokes", ", ".join(lost)))
    if arrived:
        errors = np.array([error for error, _ in arrived])
        found.append(_goal("timing.stroke_median", float(np.median(errors)), STROKE_MEDIAN, "s"))
        found.append(_goal("timing.stroke_p95", float(np.percentile(errors, 95)), STROKE_P95, "s", max(arrived)[1]))
    return found


def _tracking(performance: Performance) -> list[Check]:
    errors = np.abs(performance.errors)
    moved = errors[np.isfinite(errors)]
    if not len(moved):
        return []
    peak = np.nan_to_num(errors).max(axis=0)
    where = performance.plan.facts.robot.skeleton.names[int(peak.argmax())]
    figures = (
        ("rmse", float(np.sqrt(np.mean(moved**2))), TRACKING_RMSE, ""),
        ("p95", float(np.percentile(moved, 95)), TRACKING_P95, ""),
        ("max", float(moved.max()), TRACKING_MAX, where),
    )
    return [
        _goal(f"tracking.{name}", float(np.degrees(value)), float(np.degrees(limit)), "deg", place)
        for name, value, limit, place in figures
    ]


def _goal(name: str, value: float, limit: float, unit: str, where: str = "") -> Check:
    return Check(name, "pass" if value <= limit else "warn", value, limit, unit, where)
