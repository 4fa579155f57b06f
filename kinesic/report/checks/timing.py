"""When the sync points are: as asked, as planned, and in the twin."""

import numpy as np

from kinesic.controller.performance import Performance
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime
from kinesic.report.checks.check import Check, at, goal

STROKE_MEDIAN = 0.015  # [s]
STROKE_P95 = 0.030  # [s]
ARRIVAL = 0.020  # [s] between plan and twin


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
    return [goal("timing.twin", late[worst], ARRIVAL, "s", f"{_name(worst)} {at(worst.planned)}")]


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
