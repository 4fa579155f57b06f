"""Verb `kinesic servos stop` with supervisors of a virtual clock."""

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.cli.servos import stop
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import Stage

CYCLE_PERIOD = 0.01  # [s] cycle period of a supervisor
SETPOINT_VELOCITY = 0.5  # [rad/s] velocity of a setpoint that is not constant yet


class Clock:
    def __init__(self) -> None:
        self.now, self.naps = 50.0, list[float]()

    def sleep(self, seconds: float) -> None:
        self.naps.append(seconds)
        self.now += seconds


class Supervisor:
    """Test double of a supervisor that decelerates after an emergency stop."""

    def __init__(
        self, clock: Clock, slows: float, *, stage: Stage = Stage.STOPPED, frozen: bool = False, moves: bool = False
    ) -> None:
        self.clock, self.slows, self.final, self.frozen, self.moves = clock, slows, stage, frozen, moves
        self.policies: list[str] = []

    def stop(self, policy: str) -> None:
        self.policies.append(policy)

    def word(self, name: str) -> int:
        assert name == "cycles"
        return 7 if self.frozen else round(self.clock.now / CYCLE_PERIOD)

    def status(self) -> Status:
        passed = self.clock.now - 50.0
        stands = passed >= self.slows
        moved = SETPOINT_VELOCITY * (passed if self.moves else min(passed, self.slows))
        setpoints = np.array([moved, np.nan])
        return Status(self.final if stands else Stage.ACTIVE, energised=11, setpoints=setpoints)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(stop, "time", SimpleNamespace(monotonic=lambda: made.now, sleep=made.sleep))
    return made


@pytest.fixture
def run(kinesic, clock: Clock, monkeypatch: pytest.MonkeyPatch) -> Callable:
    """Return a function that runs `servos stop` with the given supervisors."""

    def stop_these(*supervisors: Supervisor):
        monkeypatch.setattr(stop, "find_supervisors", lambda: iter(supervisors))
        monkeypatch.setattr(stop, "find_faults", lambda: ("folder: full", "other: missing"))
        return kinesic("servos", "stop")

    return stop_these


def test_stop_verb_stops_all_supervisors_and_waits_for_standstill(run, clock: Clock):
    supervisors = [Supervisor(clock, 0.5), Supervisor(clock, 1.5)]
    ended = run(*supervisors)
    assert (ended.code, ended.out) == (0, "stopped: 22 servos hold their positions\n")
    assert ended.err.startswith("to resume: Enter in `perform`")
    assert [supervisor.policies for supervisor in supervisors] == [["hold"], ["hold"]]
    assert 1.5 <= clock.now - 50.0 <= 1.6
    assert max(clock.naps) <= 0.05


@pytest.mark.parametrize("stage", sorted(stop.STATIONARY_STAGES - {Stage.CLOSED}, key=str))
def test_stop_verb_does_not_wait_for_a_supervisor_in_a_stage_without_motion(run, clock: Clock, stage: Stage):
    assert run(Supervisor(clock, 0.2, stage=stage)).code == 0
    assert clock.now - 50.0 < 0.4


@pytest.mark.parametrize(
    ("given", "stage"),
    [({"frozen": True}, "stopped"), ({"moves": True}, "stopped"), ({"stage": Stage.FOLD}, "fold"), ({}, "active")],
)
def test_stop_verb_reports_a_supervisor_that_does_not_stop_within_3_s(run, clock: Clock, given: dict, stage: str):
    slows = 0.1 if given else 1000.0
    ended = run(Supervisor(clock, 0.1), Supervisor(clock, slows, **given))
    assert (ended.code, ended.out) == (2, "")
    assert ended.err == f"kinesic: 1 of 2 robots have not stopped in 3 s ({stage}); switch the power off\n"
    assert 3.0 <= clock.now - 50.0 < 3.2


def test_stop_verb_counts_a_closed_supervisor_as_stopped(run, clock: Clock):
    assert run(Supervisor(clock, 0.0, stage=Stage.CLOSED, frozen=True)).code == 0


def test_stop_verb_reports_why_no_supervisor_was_found(run):
    ended = run()
    assert ended.code == 2
    assert "from this machine; folder: full; other: missing; if a robot still moves, switch the power off" in ended.err


def test_stop_verb_names_a_remedy_on_systems_that_cannot_find_supervisors(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(stop, "STOP_FROM_OUTSIDE", replace(stop.STOP_FROM_OUTSIDE, is_available=False))
    with pytest.raises(ConfigError, match="press space in `perform`, or send stop to `serve`"):
        stop.stop_robots()
