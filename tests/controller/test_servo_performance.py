from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.body.command import Command
from kinesic.controller.perform import perform
from kinesic.controller.performance import Performance
from kinesic.controller.servo_performance import RunRequest, ServoRun, perform_live
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.supervisor.channel import Note, Status
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.report.report import report
from kinesic.report.servo_report import live_checks, live_log, with_live
from kinesic.sim.servo_factors import PESSIMISTIC, Factors

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.8"/></bml>'


@pytest.fixture(scope="module")
def performance() -> Performance:
    return perform(NOD)


def told(status: Status, goals: Floats, angles: Floats) -> Status:
    """With angles measured at its clock."""
    return replace(status, goals=goals, angles=angles, taken=np.full(len(angles), status.clock))


class Actor:
    """Plays what it is told, `late` seconds behind, when it is closed; `part` of it if it is stopped before."""

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
        found = [
            told(Status(Stage.ACTIVE, 100.0 + c.time, c.time, 1.0, 23, faulty=self.faulty), c.goals, angles)
            for c, angles in zip(self.told, np.transpose(seen), strict=True)
        ]
        return (Status(stage=Stage.HOLD), *found[: round(self.part * len(found))])

    def events(self) -> tuple[Note, ...]:
        return (Note(1.0, 5, "failed", "skullbase_tilt: shut down"),) if self.faulty else ()


def test_a_robot_that_follows_is_said_to(performance: Performance):
    live = perform_live(performance, Actor())
    assert (live.ending, live.performed) == ("performed", pytest.approx(1.0))
    found = {check.name: check for check in live_checks(live)}
    assert all(check.status == "pass" for check in found.values())
    assert found["measured.rmse"].value < 1e-6
    assert set(live.lags.values()) <= {0.0}


def test_a_late_robot_is_measured_by_the_plan(performance: Performance):
    live = perform_live(performance, Actor(late=0.1))
    found = {check.name: check for check in live_checks(live)}
    assert found["measured.rmse"].status == "poor"
    assert found["measured.rmse"].where == "most skullbase_tilt"
    assert max(live.lags.values()) == pytest.approx(0.1, abs=0.03)


def test_the_report_has_both(performance: Performance):
    live = perform_live(performance, Actor(late=0.02))
    before = report(performance, source="nod")
    told = with_live(before, live)
    assert set(before) < set(told)
    assert told["servos"]["rmse_deg"] == pytest.approx(np.sqrt(np.nanmean(np.degrees(live.errors) ** 2)))
    assert told["servos"]["per_joint"]["l_elbow_flexion"] == 0.0
    assert [row["name"] for row in told["checks"]][-5:] == [
        "measured.performed",
        "measured.pace",
        "measured.rmse",
        "measured.p95",
        "measured.max",
    ]
    moved = [row for row in told["sync"] if row["servos_s"] != row["planned_s"]]
    assert all(row["servos_s"] > row["planned_s"] for row in moved)


def test_the_log_is_what_was_sent_and_seen(performance: Performance):
    actor = Actor(late=0.02)
    log = live_log(perform_live(performance, actor))
    assert log.times[0] == 0.0
    assert np.allclose(np.diff(log.times), 0.01)
    np.testing.assert_array_equal(log.goals, [command.goals for command in actor.told])


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
def test_what_the_keyboard_wants_is_done(
    performance: Performance, wishes: list[RunRequest], done: list[str], ending: str
):
    actor, left = Actor(part=0.4 if wishes else 1.0), [*wishes]
    actor.waiting = lambda: bool(left)
    live = perform_live(performance, actor, requested=lambda: left.pop(0) if left else "go on")
    assert [word for word in actor.done if word != "close"] == done
    assert live.ending == ending
    status = live_checks(live)[0].status
    assert status == ("fail" if wishes else "pass")


class Straying(Actor):
    """Tells in pieces of a performance in which both elbows bend until the hands meet."""

    def __init__(self, angles: Floats) -> None:
        super().__init__()
        self.angles, self.cycles = angles, 0
        self.waiting = lambda: self.cycles < 60

    def history(self) -> tuple[Status, ...]:
        first, self.cycles = self.cycles, min(self.cycles + 10, len(self.told))
        return tuple(
            told(Status(Stage.ACTIVE, 100.0 + c.time, c.time, 1.0, 23), c.goals, self.angles)
            for c in self.told[first : self.cycles]
        )


def test_servos_that_stray_towards_the_body_are_slowed_down_and_stopped(performance: Performance):
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


def test_servos_that_follow_are_not_slowed_down(performance: Performance):
    actor = Straying(performance.plan.trajectory.at(0.0).angles)
    live = perform_live(performance, actor)
    assert set(actor.paces) == {1.0}
    assert (live.ending, "stop" in actor.done) == ("performed", False)


def test_servos_are_led_as_they_are_believed_to_be_whatever_the_twin_is(performance: Performance):
    plain, tired, fitted = Actor(), Actor(), Actor()
    perform_live(performance, plain)
    perform_live(replace(performance, twin=PESSIMISTIC), tired)
    perform_live(replace(performance, believed=Factors(gain=0.5, latency=0.012)), fitted)
    tilt = performance.plan.setup.robot.skeleton.names.index("skullbase_tilt")
    angles, goals, told = (
        np.array([row[tilt] for row in rows])
        for rows in ([c.angles for c in plain.told], [c.goals for c in plain.told], [c.goals for c in fitted.told])
    )
    np.testing.assert_array_equal([c.goals[tilt] for c in tired.told], goals)
    assert np.abs(told - angles).max() > 1.7 * np.abs(goals - angles).max()


def test_a_fault_is_told_by_its_reason(performance: Performance):
    broken = perform_live(performance, Actor(error=BusError("the supervisor died"), part=0.3))
    assert (broken.ending, broken.why) == ("failed", "the supervisor died")
    faulty = perform_live(performance, Actor(faulty=True, part=0.3))
    assert (faulty.ending, faulty.why) == ("failed", "skullbase_tilt: shut down")


@pytest.mark.parametrize("kind", ["paused", "supply"])
def test_who_stopped_for_good_has_failed_with_the_reason(performance: Performance, monkeypatch, kind: str):
    actor = Actor(part=0.3)
    monkeypatch.setattr(actor, "events", lambda: (Note(1e6, -1, kind, "a port is gone"),))
    live = perform_live(performance, actor)
    assert (live.ending, live.why) == ("failed", "a port is gone")
    monkeypatch.setattr(actor, "events", lambda: (Note(0.0, -1, kind, "a port is gone"),))
    actor.done.append("close")
    assert perform_live(performance, actor).ending == "performed"


def test_a_robot_that_never_moved_has_no_figures(performance: Performance):
    live = perform_live(performance, Actor(part=0.0))
    told = with_live(report(performance, source="nod"), live)
    assert told["ok"] is False
    assert told["servos"]["rmse_deg"] is None
    assert told["servos"]["samples"] == 0


def test_errors_are_measured_at_full_pace_alone_and_the_report_says_how_much_that_was(performance: Performance):
    live = perform_live(performance, Actor())
    slow = [replace(status, scale=0.5) for status in live.history]
    crept = ServoRun(live.performance, tuple(slow), (), "performed")
    told = with_live(report(performance, source="nod"), crept)
    assert (told["servos"]["full_pace"], told["servos"]["rmse_deg"]) == (0.0, None)
    assert {row["name"]: row["status"] for row in told["checks"]}["measured.pace"] == "poor"
    half = len(slow) // 2
    partly = ServoRun(live.performance, (*slow[:half], *live.history[half:]), (), "performed")
    found = {check.name: check for check in live_checks(partly)}
    assert found["measured.pace"].value == pytest.approx(0.5, abs=0.01)
    assert found["measured.pace"].status in ("warn", "poor")
    assert found["measured.rmse"].value < 1e-6


def test_samples_of_silent_servos_and_of_standing_time_do_not_count(performance: Performance):
    live = perform_live(performance, Actor())
    rows = list(live.history)
    gone = rows[20].angles.copy()
    gone[3] = np.nan
    rows[20] = replace(rows[20], angles=gone)
    rows.insert(30, rows[29])
    again = ServoRun(live.performance, tuple(rows), (), "performed")
    assert len(again.times) == len(live.times) - 1
    assert (np.diff(again.times) > 0).all()


def test_an_old_angle_is_compared_with_the_plan_of_its_own_time_and_counts_once(performance: Performance):
    live = perform_live(performance, Actor())
    rows = list(live.history)
    for k in range(1, len(rows), 2):
        rows[k] = replace(rows[k], angles=rows[k - 1].angles, taken=rows[k - 1].taken)
    again = ServoRun(live.performance, tuple(rows), (), "performed")
    assert np.nanmax(np.abs(again.errors)) < 1e-6
    assert np.isfinite(again.errors).sum() == pytest.approx(np.isfinite(live.errors).sum() / 2, rel=0.2)


def test_when_nobody_can_listen_any_more_the_robot_folds_at_once(performance: Performance):
    actor = Actor(part=0.3)
    actor.waiting = lambda: "release" not in actor.done

    def closed() -> RunRequest:
        raise OSError("the terminal has closed")

    with pytest.raises(OSError, match="has closed"):
        perform_live(performance, actor, requested=closed)
    assert actor.done == ["release", "close"]
