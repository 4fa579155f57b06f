from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.body.command import Command
from kinesic.controller.dry_run import dry_run
from kinesic.controller.servo_performance import RunRequest, perform_live
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.servos import UNWATCHED_KIND
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.notes import Note
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.metrics.dry_run import DryRun
from kinesic.metrics.servo_run import ServoRun
from kinesic.report.report import report
from kinesic.report.servo_report import live_checks, live_log, with_live
from kinesic.report.verdict import verdict
from kinesic.session.plan import plan
from kinesic.sim.servo_factors import PESSIMISTIC_FACTORS, Factors

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.8"/></bml>'


@pytest.fixture(scope="module")
def performance() -> DryRun:
    return dry_run(plan(NOD))


def told(status: Status, goals: Floats, angles: Floats) -> Status:
    """Return a status with the given setpoints and angles, measured at its clock."""
    return replace(status, setpoints=goals, angles=angles, taken=np.full(len(angles), status.clock))


class Actor:
    """Servos that replay commands with a delay after closing.

    `late` is the delay [s]; `part` is the performed fraction after a stop.
    """

    def __init__(self, late: float = 0.0, part: float = 1.0, error: BusError | None = None, faulty: bool = False):
        self.told: list[Command] = []
        self.late, self.part, self.error, self.faulty = late, part, error, faulty
        self.done: list[str] = []
        self.paces: list[float] = []
        self.waiting: Callable[[], bool] = lambda: False

    def write(self, command: Command, /) -> None:
        self.told.append(command)

    def close(self) -> None:
        while self.waiting():
            pass
        self.done.append("close")
        if self.error is not None:
            raise self.error

    def stop(self) -> None:
        self.done.append("stop")

    def slow_to(self, pace: float) -> None:
        self.paces.append(pace)

    def resume(self) -> None:
        self.done.append("resume")

    def release(self) -> None:
        self.done.append("release")

    def history(self) -> tuple[Status, ...]:
        if "close" not in self.done:
            return ()
        self.done.remove("close")
        times = [command.time for command in self.told]
        rows = np.array([command.angles for command in self.told])
        seen = [np.interp(np.array(times) - self.late, times, row) for row in rows.T]
        results = [
            told(Status(Stage.ACTIVE, 100.0 + c.time, c.time, 1.0, 23, faulty=self.faulty), c.setpoints, angles)
            for c, angles in zip(self.told, np.transpose(seen), strict=True)
        ]
        return (Status(stage=Stage.HOLD), *results[: round(self.part * len(results))])

    def events(self) -> tuple[Note, ...]:
        return (Note(1.0, 5, "failed", "skullbase_tilt: shut down"),) if self.faulty else ()


def test_servo_run_without_tracking_errors_passes_all_checks(performance: DryRun):
    live = perform_live(performance, Actor())
    assert (live.ending, live.performed) == ("performed", pytest.approx(1.0))
    results = {check.name: check for check in live_checks(live)}
    assert all(check.status == "pass" for check in results.values())
    assert results["measured.rmse"].value < 1e-6


def test_pace_check_gives_a_busy_computer_as_cause_only_if_it_slowed_the_performance(performance: DryRun):
    live = perform_live(performance, Actor())
    longer, slower = (
        Note(0.0, -1, "host", f"cycles begin up to {gap} ms apart: time runs at {rate} %")
        for gap, rate in ((9, 100), (57, 50))
    )
    places = [
        {check.name: check.where for check in live_checks(replace(live, notes=notes))}["measured.pace"]
        for notes in ((longer,), (longer, slower))
    ]
    assert places == ["", f"the computer was busy: {slower.text}"]
    assert set(live.lags.values()) <= {0.0}


def test_servos_late_by_100_ms_get_a_poor_rmse_check_and_a_measured_lag_of_100_ms(performance: DryRun):
    live = perform_live(performance, Actor(late=0.1))
    results = {check.name: check for check in live_checks(live)}
    assert results["measured.rmse"].status == "poor"
    assert results["measured.rmse"].where == "most skullbase_tilt"
    assert max(live.lags.values()) == pytest.approx(0.1, abs=0.03)


def test_report_of_a_servo_run_contains_twin_and_servo_results(performance: DryRun):
    live = perform_live(performance, Actor(late=0.02))
    before = report(performance, source="nod")
    result = with_live(before, live)
    assert set(before) < set(result)
    assert result["servos"]["rmse_deg"] == pytest.approx(np.sqrt(np.nanmean(np.degrees(live.errors) ** 2)))
    assert result["servos"]["per_joint"]["l_elbow_flexion"] == 0.0
    assert [row["name"] for row in result["checks"]][-5:] == [
        "measured.performed",
        "measured.pace",
        "measured.rmse",
        "measured.p95",
        "measured.max",
    ]
    moved = [row for row in result["sync"] if row["servos_s"] != row["planned_s"]]
    assert all(row["servos_s"] > row["planned_s"] for row in moved)


def test_report_of_a_servo_run_warns_of_servos_without_a_bus_watchdog(performance: DryRun):
    live = replace(perform_live(performance, Actor()), notes=(Note(0.0, -1, UNWATCHED_KIND, "they hold"),))
    result = with_live(report(performance, source="nod"), live)
    assert result["warnings"][-1] == {"type": "SAFETY", "id": "servos", "text": "they hold"}
    assert "1 warning" in verdict(result)


def test_servo_log_contains_setpoints_and_measured_angles(performance: DryRun):
    actor = Actor(late=0.02)
    log = live_log(perform_live(performance, actor))
    assert log.times[0] == 0.0
    assert np.allclose(np.diff(log.times), 0.01)
    np.testing.assert_array_equal(log.setpoints, [command.setpoints for command in actor.told])
    np.testing.assert_allclose(log.angles[2:], [command.angles for command in actor.told[:-2]], atol=1e-9)


@pytest.mark.parametrize(
    ("wishes", "done", "ending"),
    [
        (["stop"], ["stop"], "stopped"),
        (["stop", "end"], ["stop", "release"], "stopped"),
        (["stop", "stop"], ["stop", "stop"], "stopped"),
        (["stop", "resume", "end"], ["stop", "resume", "release"], "ended"),
        (["end"], ["release"], "ended"),
        ([], [], "performed"),
    ],
)
def test_stop_resume_and_end_requests_are_forwarded_to_the_servos(
    performance: DryRun, wishes: list[RunRequest], done: list[str], ending: str
):
    actor, left = Actor(part=0.4 if wishes else 1.0), [*wishes]
    actor.waiting = lambda: bool(left)
    live = perform_live(performance, actor, requested=lambda: left.pop(0) if left else "go on")
    assert [word for word in actor.done if word != "close"] == done
    assert live.ending == ending
    status = live_checks(live)[0].status
    assert status == ("fail" if wishes else "pass")


class Straying(Actor):
    """Servos whose elbows bend until the hands meet, with statuses in pieces."""

    def __init__(self, angles: Floats) -> None:
        super().__init__()
        self.angles, self.cycles = angles, 0
        self.waiting = lambda: self.cycles < 60

    def history(self) -> tuple[Status, ...]:
        first, self.cycles = self.cycles, min(self.cycles + 10, len(self.told))
        return tuple(
            told(Status(Stage.ACTIVE, 100.0 + c.time, c.time, 1.0, 23), c.setpoints, self.angles)
            for c in self.told[first : self.cycles]
        )


def test_servo_run_is_slowed_and_stopped_if_measured_hands_collide(performance: DryRun):
    robot = performance.plan.setup.robot
    meeting = robot.skeleton.rest.copy()
    for side in "lr":  # forearms level, hands before the belly
        for name, degrees in (("elbow_flexion", 90.0), ("shoulder_twisting", -60.0)):
            meeting[robot.skeleton.names.index(f"{side}_{name}")] = np.radians(degrees)
    assert performance.plan.setup.distances.clearance(meeting[None]).distances[0] < 0.0
    actor = Straying(meeting)
    live = perform_live(performance, actor)
    assert actor.paces[0] < 0.5
    assert "stop" in actor.done
    assert live.ending == "stopped"
    assert "clearance" in [note.kind for note in live.notes]
    assert "too little clearance" in live.why


def test_servos_that_follow_the_plan_accurately_are_not_slowed(performance: DryRun):
    actor = Straying(performance.plan.trajectory.at(0.0).angles)
    live = perform_live(performance, actor)
    assert set(actor.paces) == {1.0}
    assert (live.ending, "stop" in actor.done) == ("performed", False)


def test_setpoints_for_servos_depend_on_the_servo_estimate_and_not_on_the_twin(performance: DryRun):
    plain, tired, fitted = Actor(), Actor(), Actor()
    perform_live(performance, plain)
    perform_live(replace(performance, twin=PESSIMISTIC_FACTORS), tired)
    perform_live(replace(performance, servo_estimate=Factors(gain=0.5, latency=0.012)), fitted)
    tilt = performance.plan.setup.robot.skeleton.names.index("skullbase_tilt")
    angles, goals, result = (
        np.array([row[tilt] for row in rows])
        for rows in (
            [c.angles for c in plain.told],
            [c.setpoints for c in plain.told],
            [c.setpoints for c in fitted.told],
        )
    )
    np.testing.assert_array_equal([c.setpoints[tilt] for c in tired.told], goals)
    assert np.abs(result - angles).max() > 1.7 * np.abs(goals - angles).max()


def test_servo_fault_is_reported_with_reason(performance: DryRun):
    broken = perform_live(performance, Actor(error=BusError("the supervisor died"), part=0.3))
    assert (broken.ending, broken.why) == ("failed", "the supervisor died")
    faulty = perform_live(performance, Actor(faulty=True, part=0.3))
    assert (faulty.ending, faulty.why) == ("failed", "skullbase_tilt: shut down")


@pytest.mark.parametrize("kind", ["paused", "supply"])
def test_servo_run_fails_with_the_reason_of_a_pause_or_supply_fault(performance: DryRun, monkeypatch, kind: str):
    actor = Actor(part=0.3)
    monkeypatch.setattr(actor, "events", lambda: (Note(1e6, -1, kind, "a port is gone"),))
    live = perform_live(performance, actor)
    assert (live.ending, live.why) == ("failed", "a port is gone")
    monkeypatch.setattr(actor, "events", lambda: (Note(0.0, -1, kind, "a port is gone"),))
    actor.done.append("close")
    assert perform_live(performance, actor).ending == "performed"


def test_servo_run_without_samples_reports_its_rmse_as_none(performance: DryRun):
    live = perform_live(performance, Actor(part=0.0))
    result = with_live(report(performance, source="nod"), live)
    assert result["ok"] is False
    assert result["servos"]["rmse_deg"] is None
    assert result["servos"]["samples"] == 0


def test_tracking_errors_of_servos_count_only_while_time_runs_at_full_speed(performance: DryRun):
    live = perform_live(performance, Actor())
    slow = [replace(status, scale=0.5) for status in live.history]
    crept = ServoRun(live.performance, tuple(slow), (), "performed")
    result = with_live(report(performance, source="nod"), crept)
    assert (result["servos"]["full_pace"], result["servos"]["rmse_deg"]) == (0.0, None)
    assert {row["name"]: row["status"] for row in result["checks"]}["measured.pace"] == "poor"
    half = len(slow) // 2
    partly = ServoRun(live.performance, (*slow[:half], *live.history[half:]), (), "performed")
    results = {check.name: check for check in live_checks(partly)}
    assert results["measured.pace"].value == pytest.approx(0.5, abs=0.01)
    assert results["measured.pace"].status in ("warn", "poor")
    assert results["measured.rmse"].value < 1e-6


def test_slow_start_and_end_of_a_servo_run_do_not_lower_its_fraction_of_time_at_full_speed(performance: DryRun):
    live = perform_live(performance, Actor())
    begin, end = live.history[0].clock, live.history[-1].clock
    gentle = [
        replace(status, scale=0.5) if min(status.clock - begin, end - status.clock) < 0.4 else status
        for status in live.history
    ]
    assert ServoRun(live.performance, tuple(gentle), (), "performed").full_speed_fraction == 1.0
    middle = len(gentle) // 2
    gentle[middle] = replace(gentle[middle], scale=0.5)
    assert 0.9 < ServoRun(live.performance, tuple(gentle), (), "performed").full_speed_fraction < 1.0


def test_servo_samples_with_a_silent_servo_or_stopped_time_are_excluded(performance: DryRun):
    live = perform_live(performance, Actor())
    rows = list(live.history)
    gone = rows[20].angles.copy()
    gone[3] = np.nan
    rows[20] = replace(rows[20], angles=gone)
    rows.insert(30, rows[29])
    again = ServoRun(live.performance, tuple(rows), (), "performed")
    assert len(again.times) == len(live.times) - 1
    assert (np.diff(again.times) > 0).all()


def test_delayed_servo_reading_is_compared_once_with_the_plan_at_reading_time(performance: DryRun):
    live = perform_live(performance, Actor())
    rows = list(live.history)
    for k in range(1, len(rows), 2):
        rows[k] = replace(rows[k], angles=rows[k - 1].angles, taken=rows[k - 1].taken)
    again = ServoRun(live.performance, tuple(rows), (), "performed")
    assert np.nanmax(np.abs(again.errors)) < 1e-6
    assert np.isfinite(again.errors).sum() == pytest.approx(np.isfinite(live.errors).sum() / 2, rel=0.2)


def test_exception_in_the_request_callback_of_a_servo_run_releases_and_closes_the_servos(performance: DryRun):
    actor = Actor(part=0.3)
    actor.waiting = lambda: "release" not in actor.done

    def closed() -> RunRequest:
        raise OSError("the terminal has closed")

    with pytest.raises(OSError, match="has closed"):
        perform_live(performance, actor, requested=closed)
    assert actor.done == ["release", "close"]
