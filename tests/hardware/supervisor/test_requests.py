"""Requests in the channel, and their effect on the state machine."""

import mmap
from dataclasses import fields

import pytest

from kinesic.hardware.supervisor.channel import Channel, memory_size
from kinesic.hardware.supervisor.observation import Observation
from kinesic.hardware.supervisor.requests import Requests
from kinesic.hardware.supervisor.state_machine import Stage, SupervisorState
from kinesic.hardware.supervisor.transitions import step


class Asked:
    """Requests of a planner that lives until the test ends it."""

    def __init__(self) -> None:
        self.alive = True
        self.channel = Channel(mmap.mmap(-1, memory_size(1)), 1)
        self.requests = Requests(self.channel, lambda: self.alive)

    def ask(self, word: str, value: int) -> tuple[str, ...]:
        self.channel.set(word, value)
        return self.requests.events()


@pytest.fixture
def asked() -> Asked:
    return Asked()


def test_no_request_is_reported_until_the_planner_makes_a_request(asked: Asked):
    requests = asked.requests
    for _ in range(2):
        assert (requests.alone, requests.ended, requests.release, requests.confirmed) == (False,) * 4
        assert requests.events() == ()
        requests.look()


def test_end_and_death_of_the_planner_are_reported_only_after_the_planner_is_polled(asked: Asked):
    asked.alive = False
    asked.channel.set("ended", 1)
    assert not asked.requests.alone, "nobody has looked yet"
    assert not asked.requests.ended, "its last commands are taken before"
    asked.requests.look()
    assert (asked.requests.alone, asked.requests.ended) == (True, True)


@pytest.mark.parametrize("word", [0, 1])
def test_regular_end_and_death_of_the_planner_are_reported_separately(asked: Asked, word: int):
    asked.channel.set("ended", word)
    asked.alive = bool(word)
    asked.requests.look()
    assert (asked.requests.alone, asked.requests.ended) == (not word, bool(word))


def test_new_or_stronger_stop_request_is_reported_once(asked: Asked):
    assert asked.ask("estop", 1) == ("estop",)
    assert asked.requests.events() == ()
    assert asked.ask("estop", 2) == ("estop",), "a second one that lets go"
    assert asked.ask("estop", 1) == (), "which is taken back"
    assert asked.ask("estop", 0) == ()
    assert asked.ask("estop", 1) == ("estop",)


def test_successive_resume_requests_are_each_reported_once(asked: Asked):
    assert asked.ask("resume", 1) == ("resumed",)
    assert asked.requests.events() == ()
    assert asked.ask("resume", 2) == ("resumed",)


def test_resume_request_during_an_emergency_stop_is_ignored(asked: Asked):
    asked.ask("estop", 1)
    assert asked.ask("resume", 1) == ()
    assert asked.ask("estop", 0) == ()
    assert asked.ask("resume", 2) == ("resumed",)


def test_emergency_stop_overrides_a_simultaneous_resume_request(asked: Asked):
    asked.channel.set("resume", 1)
    assert asked.ask("estop", 1) == ("estop",)


def test_emergency_stop_cancels_an_earlier_release_request(asked: Asked):
    asked.channel.set("release", 1)
    assert asked.requests.release
    asked.ask("estop", 1)
    assert not asked.requests.release
    asked.requests.events()
    asked.ask("release", 2)
    assert asked.requests.release, "asked again, while the stop stands"


def test_resume_request_does_not_cancel_a_release_request(asked: Asked):
    asked.channel.set("release", 1)
    asked.ask("resume", 1)
    assert asked.requests.release


def test_confirmation_request_is_reported_as_confirmed(asked: Asked):
    asked.ask("confirm", 1)
    assert asked.requests.confirmed


def test_stop_request_selects_its_policy_and_the_default_policy_applies_without_a_stop_request(asked: Asked):
    assert [asked.requests.policy("hold"), asked.requests.policy("limp")] == ["hold", "limp"]
    asked.channel.set("estop", 1)
    assert asked.requests.policy("limp") == "hold"
    asked.channel.set("estop", 2)
    assert asked.requests.policy("hold") == "limp"


FLAGS = [field.name for field in fields(Observation) if field.type in (bool, "bool")]


@pytest.mark.parametrize("flag", FLAGS)
def test_only_listed_observation_flags_end_a_performance_or_a_stop(flag: str):
    """Each flag alone is inverted, starting from a healthy robot at rest."""
    seen = Observation(**{flag: not getattr(Observation(), flag)})
    waiting, stopped = SupervisorState(Stage.LIMP, checked=True), SupervisorState(Stage.STOPPED, stopped=True)
    ended = step(waiting, "tick", seen)[0].stage is Stage.CLOSED
    assert ended == (flag in {"ended", "release", "weak", "confirmed"})
    dismissed = step(stopped, "tick", seen)[0].stage is Stage.HOLD
    assert dismissed == (flag in {"release", "confirmed", "alone"})


def test_initial_observation_is_healthy_without_torque():
    calm = Observation()
    assert [flag for flag in FLAGS if getattr(calm, flag)] == ["answering", "well", "still"]
    assert calm.policy == "hold"


def test_performance_time_runs_at_full_rate_until_the_clearance_watch_slows_it(asked: Asked):
    assert asked.requests.pace == 1.0
    for pace in (0.02, 0.5, 0.0, 1.0):
        asked.channel.slow_to(pace)
        assert asked.requests.pace == pytest.approx(pace)
