"""Report of a run on servos: metrics, checks and servo log."""

from collections.abc import Mapping, Sequence

import numpy as np

from kinesic.hardware.servos import UNWATCHED_KIND
from kinesic.hardware.supervisor.notes import Note
from kinesic.metrics.servo_run import ServoRun
from kinesic.report.checks import GRADE_NAMES, Check, grade
from kinesic.report.checks.twin import P95_LIMIT, PEAK_ERROR_LIMIT
from kinesic.report.report import Json
from kinesic.sim.log import Log

SAFETY_TYPE = "SAFETY"  # type of warnings about missing protection of the servos
HOST_KIND = "host"  # kind of events about late cycles of the computer
FULL_RATE = "at 100 %"  # text in a message about late cycles that did not slow performance time
RMSE_LIMIT = 1.0  # [deg] limit of the RMS tracking error on servos
COMPLETE_FRACTION = 0.999  # performed fraction that counts as a complete plan
MIN_FULL_PACE_FRACTION = 0.95  # required fraction of samples at full speed; late cycles slow time briefly


def live_checks(live: ServoRun) -> list[Check]:
    """Check tracking error, completed fraction and full-speed fraction of a servo run."""
    results = [Check.of("measured.performed", live.performed, COMPLETE_FRACTION, live.why or live.ending)]
    if len(live.times):
        pace = live.full_speed_fraction
        results.append(Check.of("measured.pace", pace, MIN_FULL_PACE_FRACTION, _find_host_delay(live.notes)))
    errors = np.degrees(np.abs(live.errors))
    counted = errors[np.isfinite(errors)]
    if not len(counted):
        return results
    names = live.performance.plan.setup.robot.skeleton.names
    row, hinge = np.unravel_index(int(np.nan_to_num(errors).argmax()), errors.shape)
    worst = f"{names[hinge]} at {live.times[row]:.2f} s"
    most = names[int((np.nan_to_num(live.errors) ** 2).sum(axis=0).argmax())]
    return [
        *results,
        Check.of("measured.rmse", float(np.sqrt(np.mean(counted**2))), RMSE_LIMIT, f"most {most}"),
        Check.of("measured.p95", float(np.percentile(counted, 95)), P95_LIMIT),
        Check.of("measured.max", float(counted.max()), PEAK_ERROR_LIMIT, worst),
    ]


def _find_host_delay(notes: Sequence[Note]) -> str:
    """Return the first message about late cycles that slowed performance time."""
    slowing = (note.text for note in notes if note.kind == HOST_KIND and FULL_RATE not in note.text)
    return next((f"the computer was busy: {text}" for text in slowing), "")


def with_live(data: Mapping[str, Json], live: ServoRun) -> dict[str, Json]:
    """Return the report data with the results of a servo run."""
    results = live_checks(live)
    rows: list[Json] = [{**vars(check)} for check in results]
    earlier, syncs, warnings = data["checks"], data["sync"], data["warnings"]
    assert isinstance(earlier, list)  # as `report` makes them
    assert isinstance(syncs, list)
    assert isinstance(warnings, list)
    return {
        **data,
        "grade": max(str(data["grade"]), grade(results), key=GRADE_NAMES.index),
        "ok": bool(data["ok"]) and grade(results) != "fail",
        "checks": [*earlier, *rows],
        "warnings": [*warnings, *_safety_warnings(live.notes)],
        "sync": _syncs(syncs, live),
        "servos": _servos(live, {check.name.partition(".")[2]: check.value for check in results}),
    }


def _safety_warnings(notes: Sequence[Note]) -> list[Json]:
    """Return a report warning for each note about missing bus watchdogs."""
    return [{"type": SAFETY_TYPE, "id": "servos", "text": note.text} for note in notes if note.kind == UNWATCHED_KIND]


def _syncs(rows: list[Json], live: ServoRun) -> list[Json]:
    """Return the sync points with the times measured on the robot."""
    measured_rows: list[Json] = []
    for row, sync in zip(rows, live.performance.plan.syncs, strict=True):
        lag = live.lags.get(sync, 0.0)
        assert isinstance(row, dict)
        measured_rows.append({**row, "servos_s": None if lag is None else sync.planned + lag})
    return measured_rows


def _servos(live: ServoRun, figures: Mapping[str, float]) -> dict[str, Json]:
    names = live.performance.plan.setup.robot.skeleton.names
    squares = np.degrees(np.nan_to_num(live.errors)) ** 2
    means = squares.sum(axis=0) / np.maximum(np.isfinite(live.errors).sum(axis=0), 1)
    last = live.history[-1] if live.history else None
    return {
        "ending": live.ending,
        "why": live.why,
        "performed": live.performed,
        "full_pace": live.full_speed_fraction,
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
    """Return setpoints and measured angles as a log for identification."""
    return Log(live.clocks, live.setpoints, live.interpolated_angles)
