"""What is said while servos perform, on a device that keeps what it is given."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.utterance import Sound
from kinesic.controller.speech_sync import SpeechPlayback
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.speech.loudspeaker import Feed
from kinesic.speech.speaker import RATE, Speaker

AHEAD = 0.02  # [s] by which the device asks before it is heard
PIECE = 441  # samples that it asks for at once
LOOK = 0.02  # [s] between two looks at the supervisor
BEGIN = 100.3  # [s] on the clock at which performance time 0 begins


class Tape:
    """A device whose clock goes on with what it plays."""

    latency = AHEAD

    def __init__(self) -> None:
        self.now, self.open_now = 100.0, False
        self.heard: list[np.ndarray] = []
        self._feed: Feed | None = None

    def clock(self) -> float:
        return self.now

    def open(self, rate: int, feed: Feed) -> None:
        assert rate == RATE
        self._feed, self.open_now = feed, True

    def close(self) -> None:
        self._feed, self.open_now = None, False

    def turn(self, seconds: float) -> None:
        for _ in range(round(seconds * RATE / PIECE)):
            if self._feed is not None:
                self.heard.append(self._feed(PIECE, self.now + AHEAD))
            self.now += PIECE / RATE

    def part(self, begin: float, end: float) -> np.ndarray:
        """What is heard between two times on the clock."""
        first, last = (round((time - 100.0 - AHEAD) * RATE) for time in (begin, end))
        return np.concatenate(self.heard)[first:last]


class Stand:
    """A supervisor's word every `LOOK` seconds, and a sound whose samples tell its time: half of the seconds."""

    def __init__(self) -> None:
        self.tape = Tape()
        self.speaker = Speaker(self.tape.clock, device=self.tape)
        self.aloud = SpeechPlayback(Sound.of(RATE, np.arange(2 * RATE) / RATE / 2), self.speaker)
        self.time = 0.0

    def go(self, seconds: float, stage: Stage, scale: float = 1.0, *, told: bool = True) -> None:
        """Performance time goes on for a while."""
        for _ in range(round(seconds / LOOK)):
            if told:
                self.aloud(replace(Status(stage), clock=self.tape.now, time=self.time, scale=scale))
            self.tape.turn(LOOK)
            self.time += scale * LOOK


@pytest.fixture
def stand() -> Stand:
    return Stand()


def times(samples: np.ndarray) -> np.ndarray:
    """The sound's own time of each [s]."""
    return 2 * samples


def test_it_begins_when_performance_time_does(stand: Stand):
    stand.go(0.3, Stage.HOLD, 0.0)
    stand.go(0.6, Stage.ACTIVE)
    assert not stand.tape.part(100.05, BEGIN).any()
    heard = times(stand.tape.part(BEGIN + 0.1, BEGIN + 0.5))
    np.testing.assert_allclose(heard, 0.1 + np.arange(len(heard)) / RATE, atol=0.002)


def test_it_is_silent_while_time_slows_and_goes_on_where_the_robot_is(stand: Stand):
    stand.go(0.3, Stage.HOLD, 0.0)
    stand.go(0.4, Stage.ACTIVE)
    stand.go(0.2, Stage.DEGRADED, 0.5)
    stand.go(0.2, Stage.HOLD, 0.0)
    stand.go(0.4, Stage.ACTIVE)
    assert not stand.tape.part(BEGIN + 0.45, BEGIN + 0.8).any()
    heard = times(stand.tape.part(BEGIN + 0.9, BEGIN + 1.1))
    np.testing.assert_allclose(heard, 0.6 + np.arange(len(heard)) / RATE, atol=0.002)  # 0.4 s, half of 0.2 s, 0.1 s


@pytest.mark.parametrize("stage", [Stage.STOPPED, Stage.FOLD, Stage.LOST, Stage.LIMP])
def test_it_ends_with_the_performance(stand: Stand, stage: Stage):
    stand.go(0.3, Stage.HOLD, 0.0)
    stand.go(0.4, Stage.ACTIVE)
    stand.go(0.4, stage)
    assert not stand.tape.part(BEGIN + 0.45, BEGIN + 0.75).any()


def test_it_stays_with_a_robot_that_is_elsewhere_than_was_thought(stand: Stand):
    stand.go(0.3, Stage.HOLD, 0.0)
    stand.go(0.2, Stage.ACTIVE)
    stand.time += 0.2
    stand.go(0.3, Stage.ACTIVE)
    heard = times(stand.tape.part(BEGIN + 0.3, BEGIN + 0.4))
    np.testing.assert_allclose(heard, 0.5 + np.arange(len(heard)) / RATE, atol=0.002)


def test_a_word_that_comes_late_changes_nothing(stand: Stand):
    stand.go(0.3, Stage.HOLD, 0.0)
    stand.go(0.1, Stage.ACTIVE)
    stand.go(0.2, Stage.ACTIVE, told=False)
    stand.go(0.2, Stage.ACTIVE)
    heard = times(stand.tape.part(BEGIN + 0.1, BEGIN + 0.4))
    np.testing.assert_allclose(heard, 0.1 + np.arange(len(heard)) / RATE, atol=0.002)
