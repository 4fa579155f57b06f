"""What is asked of the supervisor: the words of the channel, and what of them the state machine gets to know."""

import mmap
from dataclasses import fields

import pytest

from kinesic.hardware.supervisor.channel import Channel, memory_size
from kinesic.hardware.supervisor.observation import Observation
from kinesic.hardware.supervisor.requests import Requests


class Asked:
    """Requests of a planner that lives until a test says otherwise."""

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


def test_nothing_is_asked_at_first(asked: Asked):
    requests = asked.requests
    for _ in range(2):
        assert (requests.alone, requests.ended, requests.release, requests.confirmed) == (False,) * 4
        assert requests.events() == ()
        requests.look()


def test_a_planner_is_looked_at_before_its_last_commands_are_taken(asked: Asked):
    asked.alive = False
    asked.channel.set("ended", 1)
    assert not asked.requests.alone, "nobody has looked yet"
    assert not asked.requests.ended, "its last commands are taken before"
    asked.requests.look()
    assert (asked.requests.alone, asked.requests.ended) == (True, True)


@pytest.mark.parametrize("word", [0, 1])
def test_a_planner_that_ends_with_a_word_may_live_and_one_that_dies_may_have_said_none(asked: Asked, word: int):
    asked.channel.set("ended", word)
    asked.alive = bool(word)
    asked.requests.look()
    assert (asked.requests.alone, asked.requests.ended) == (not word, bool(word))


def test_each_stop_is_told_once(asked: Asked):
    assert asked.ask("estop", 1) == ("estop",)
    assert asked.requests.events() == ()
    assert asked.ask("estop", 2) == ("estop",), "a second one that lets go"
    assert asked.ask("estop", 1) == (), "which is taken back"
    assert asked.ask("estop", 0) == ()
    assert asked.ask("estop", 1) == ("estop",)


def test_a_consent_is_told_once(asked: Asked):
    assert asked.ask("resume", 1) == ("resumed",)
    assert asked.requests.events() == ()
    assert asked.ask("resume", 2) == ("resumed",)


def test_a_consent_while_a_stop_stands_is_void(asked: Asked):
    asked.ask("estop", 1)
    assert asked.ask("resume", 1) == ()
    assert asked.ask("estop", 0) == ()
    assert asked.ask("resume", 2) == ("resumed",)


def test_a_stop_and_a_consent_at_once_are_a_stop(asked: Asked):
    asked.channel.set("resume", 1)
    assert asked.ask("estop", 1) == ("estop",)


def test_a_stop_makes_earlier_releases_void(asked: Asked):
    asked.channel.set("release", 1)
    assert asked.requests.release
    asked.ask("estop", 1)
    assert not asked.requests.release
    asked.requests.events()
    asked.ask("release", 2)
    assert asked.requests.release, "asked again, while the stop stands"


def test_a_consent_makes_no_release_void(asked: Asked):
    asked.channel.set("release", 1)
    asked.ask("resume", 1)
    assert asked.requests.release


def test_only_a_person_confirms(asked: Asked):
    asked.ask("confirm", 1)
    assert asked.requests.confirmed


def test_a_stop_says_itself_what_it_is_to_do(asked: Asked):
    assert [asked.requests.policy("hold"), asked.requests.policy("limp")] == ["hold", "limp"]
    asked.channel.set("estop", 1)
    assert asked.requests.policy("limp") == "hold"
    asked.channel.set("estop", 2)
    assert asked.requests.policy("hold") == "limp"


FLAGS = [field.name for field in fields(Observation) if field.type in (bool, "bool")]


@pytest.mark.parametrize("flag", FLAGS)
def test_what_ends_a_performance_and_what_a_stop(flag: str):
    """Each flag by itself, turned from what it is while all is well and nothing is performed."""
    calm = Observation()
    assert (calm.over, calm.dismissed) == (False, False)
    seen = Observation(**{flag: not getattr(calm, flag)})
    assert seen.over == (flag in {"ended", "release", "weak", "confirmed"})
    assert seen.dismissed == (flag in {"release", "confirmed", "alone"})


def test_at_first_all_answer_and_nobody_has_torque():
    calm = Observation()
    assert [flag for flag in FLAGS if getattr(calm, flag)] == ["answering", "well", "still"]
    assert calm.policy == "hold"


def test_time_runs_as_it_may_until_a_watch_asks_for_less(asked: Asked):
    assert asked.requests.pace == 1.0
    for pace in (0.02, 0.5, 0.0, 1.0):
        asked.channel.slow_to(pace)
        assert asked.requests.pace == pytest.approx(pace)
