"""Tells what the robot did, beside what was planned: figures, checks, and a log that the twin can be fitted to."""

from collections.abc import Mapping

import numpy as np

from kinesic.controller.servo_performance import ServoRun
from kinesic.report.checks import GRADES, Check, grade
from kinesic.report.checks.twin import MAX, P95
from kinesic.report.report import Json
from kinesic.sim.log import Log

RMSE = 1.0  # [deg]
WHOLE = 0.999  # share of a plan that is all of it
PACE = 0.95  # share of samples at full pace: a cycle that comes late slows time for a moment


def live_checks(live: ServoRun) -> list[Check]:
    """Checks how near the robot stayed to the plan, and whether it came to its end."""
    found = [Check.of("measured.performed", live.performed, WHOLE, live.why or live.ending)]
    if len(live.times):
        found.append(Check.of("measured.pace", live.full_pace, PACE))
    errors = np.degrees(np.abs(live.errors))
    counted = errors[np.isfinite(errors)]
    if not len(counted):
        return found
    names = live.performance.plan.setup.robot.skeleton.names
    row, hinge = np.unravel_index(int(np.nan_to_num(errors).argmax()), errors.shape)
    worst = f"{names[hinge]} at {live.times[row]:.2f} s"
    most = names[int((np.nan_to_num(live.errors) ** 2).sum(axis=0).argmax())]
    return [
        *found,
        Check.of("measured.rmse", float(np.sqrt(np.mean(counted**2))), RMSE, f"most {most}"),
        Check.of("measured.p95", float(np.percentile(counted, 95)), P95),
        Check.of("measured.max", float(counted.max()), MAX, worst),
    ]


def with_live(data: Mapping[str, Json], live: ServoRun) -> dict[str, Json]:
    """Adds what the robot did to a report: more checks, the times of its sync points, and a table `servos`."""
    found = live_checks(live)
    rows: list[Json] = [{**vars(check)} for check in found]
    earlier, syncs = data["checks"], data["sync"]
    assert isinstance(earlier, list)  # as `report` makes them
    assert isinstance(syncs, list)
    return {
        **data,
        "grade": max(str(data["grade"]), grade(found), key=GRADES.index),
        "ok": bool(data["ok"]) and grade(found) != "fail",
        "checks": [*earlier, *rows],
        "sync": _syncs(syncs, live),
        "servos": _servos(live, {check.name.partition(".")[2]: check.value for check in found}),
    }


def _syncs(rows: list[Json], live: ServoRun) -> list[Json]:
    """With the time at which the robot met each."""
    found: list[Json] = []
    for row, sync in zip(rows, live.performance.plan.syncs, strict=True):
        lag = live.lags.get(sync, 0.0)
        assert isinstance(row, dict)
        found.append({**row, "servos_s": None if lag is None else sync.planned + lag})
    return found


def _servos(live: ServoRun, figures: Mapping[str, float]) -> dict[str, Json]:
    names = live.performance.plan.setup.robot.skeleton.names
    squares = np.degrees(np.nan_to_num(live.errors)) ** 2
    means = squares.sum(axis=0) / np.maximum(np.isfinite(live.errors).sum(axis=0), 1)
    last = live.history[-1] if live.history else None
    return {
        "ending": live.ending,
        "why": live.why,
        "performed": live.performed,
        "full_pace": live.full_pace,
        "rmse_deg": figures.get("rmse"),
        "p95_deg": figures.get("p95"),
        "max_deg": figures.get("max"),
        "per_joint": {name: float(np.sqrt(mean)) for name, mean in zip(names, means, strict=True)},
        "samples": len(live.times),
        "late_cycles": last.late if last else 0,
        "hottest_c": max((status.hottest for status in live.history), default=None),
        "lowest_v": min((status.volts for status in live.history), default=None),
        "events": [
            {
                "time_s": note.clock,
                "kind": note.kind,
                "servo": note.servo if note.servo >= 0 else None,
                "text": note.text,
            }
            for note in live.notes
        ],
    }


def live_log(live: ServoRun) -> Log:
    """Gathers goals sent and angles measured, as `kinesic twin fit` reads them."""
    return Log(live.clocks, live.goals, live.followed)
