import wave
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.utterance import Script, Sound, Utterance
from kinesic.controller.perform import plan, set_up
from kinesic.controller.soundtrack import SpeechPlayback, resample, sound, write_wav
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.planning.setup import Setup
from kinesic.speech.loudspeaker import Feed
from kinesic.speech.speaker import SAMPLE_RATE as HEARD_RATE
from kinesic.speech.speaker import Speaker
from kinesic.speech.voice import read_wav

RATE = 16000
BLOCK = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    '<speech id="one" start="0.5"><text>one</text></speech>'
    '<speech id="two" start="{two}"><text>two</text></speech>'
    '<gesture id="g" lexeme="offer" mode="RIGHT_HAND" stroke="0.4" end="4"/></bml>'
)


class Beep:
    """A voice that says everything as a constant of half a second."""

    def __init__(self, loudness: float = 0.25) -> None:
        self._loudness = loudness

    def say(self, script: Script, /, *, rate: float = 1.0, pitch: float = 1.0) -> Utterance:
        own = RATE if script.text == "one" else RATE // 2
        beep = Sound.of(own, np.full(own // 2, self._loudness))
        return Utterance(0.5, {}, (), "beep", beep)


@pytest.fixture
def known() -> Setup:
    return set_up()


def beeping(known: Setup, two: float, loudness: float = 0.25):
    object.__setattr__(known, "voice", Beep(loudness))
    return plan(BLOCK.format(two=two), known)


def test_every_utterance_is_at_its_performance_time(known: Setup):
    planned = beeping(known, 2.0)
    assert planned.trajectory.zero > 0.0  # the hand begins before the block does
    heard = sound(planned)
    assert heard is not None
    assert heard.rate == RATE
    assert heard.duration == pytest.approx(planned.duration, abs=1e-3)
    edges = np.flatnonzero(np.diff((np.abs(heard.samples) > 0.125).astype(int))) / RATE
    zero = planned.trajectory.zero
    assert edges == pytest.approx([zero + 0.5, zero + 1.0, zero + 2.0, zero + 2.5], abs=1e-3)


def test_utterances_at_once_are_mixed_and_never_too_loud(known: Setup):
    heard = sound(beeping(known, 0.75, loudness=0.8))
    assert heard is not None
    assert np.abs(heard.samples).max() == pytest.approx(1.0)


def test_nothing_is_heard_of_a_silent_voice():
    assert sound(plan(BLOCK.format(two=2), set_up())) is None


def test_another_rate_keeps_the_tone():
    tone = Sound.of(RATE, 0.5 * np.sin(2 * np.pi * 200 * np.arange(RATE) / RATE))
    other = resample(tone, 22050)
    assert len(other) == 22050
    expected = 0.5 * np.sin(2 * np.pi * 200 * np.arange(22050) / 22050)
    assert np.abs(other - expected)[200:-200].max() < 0.01


def test_a_file_holds_what_was_heard(tmp_path: Path):
    ramp = Sound.of(RATE, np.linspace(-1.0, 1.0, 1001))
    write_wav(ramp, tmp_path / "ramp.wav")
    with wave.open(str(tmp_path / "ramp.wav")) as file:
        assert (file.getnchannels(), file.getsampwidth(), file.getframerate()) == (1, 2, RATE)
    assert read_wav(tmp_path / "ramp.wav").samples == pytest.approx(ramp.samples, abs=1e-4)


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
        assert rate == HEARD_RATE
        self._feed, self.open_now = feed, True

    def close(self) -> None:
        self._feed, self.open_now = None, False

    def turn(self, seconds: float) -> None:
        for _ in range(round(seconds * HEARD_RATE / PIECE)):
            if self._feed is not None:
                self.heard.append(self._feed(PIECE, self.now + AHEAD))
            self.now += PIECE / HEARD_RATE

    def part(self, begin: float, end: float) -> np.ndarray:
        """What is heard between two times on the clock."""
        first, last = (round((time - 100.0 - AHEAD) * HEARD_RATE) for time in (begin, end))
        return np.concatenate(self.heard)[first:last]


class Stand:
    """A supervisor's word every `LOOK` seconds, and a sound whose samples tell its time: half of the seconds."""

    def __init__(self) -> None:
        self.tape = Tape()
        self.speaker = Speaker(self.tape.clock, device=self.tape)
        self.aloud = SpeechPlayback(Sound.of(HEARD_RATE, np.arange(2 * HEARD_RATE) / HEARD_RATE / 2), self.speaker)
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


def own_times(samples: np.ndarray) -> np.ndarray:
    """The sound's own time of each [s]."""
    return 2 * samples


def test_it_begins_when_performance_time_does(stand: Stand):
    stand.go(0.3, Stage.HOLD, 0.0)
    stand.go(0.6, Stage.ACTIVE)
    assert not stand.tape.part(100.05, BEGIN).any()
    heard = own_times(stand.tape.part(BEGIN + 0.1, BEGIN + 0.5))
    np.testing.assert_allclose(heard, 0.1 + np.arange(len(heard)) / HEARD_RATE, atol=0.002)


def test_it_is_silent_while_time_slows_and_goes_on_where_the_robot_is(stand: Stand):
    stand.go(0.3, Stage.HOLD, 0.0)
    stand.go(0.4, Stage.ACTIVE)
    stand.go(0.2, Stage.DEGRADED, 0.5)
    stand.go(0.2, Stage.HOLD, 0.0)
    stand.go(0.4, Stage.ACTIVE)
    assert not stand.tape.part(BEGIN + 0.45, BEGIN + 0.8).any()
    heard = own_times(stand.tape.part(BEGIN + 0.9, BEGIN + 1.1))
    passed = 0.4 + 0.5 * 0.2 + 0.1  # [s]
    np.testing.assert_allclose(heard, passed + np.arange(len(heard)) / HEARD_RATE, atol=0.002)


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
    heard = own_times(stand.tape.part(BEGIN + 0.3, BEGIN + 0.4))
    np.testing.assert_allclose(heard, 0.5 + np.arange(len(heard)) / HEARD_RATE, atol=0.002)


def test_a_word_that_comes_late_changes_nothing(stand: Stand):
    stand.go(0.3, Stage.HOLD, 0.0)
    stand.go(0.1, Stage.ACTIVE)
    stand.go(0.2, Stage.ACTIVE, told=False)
    stand.go(0.2, Stage.ACTIVE)
    heard = own_times(stand.tape.part(BEGIN + 0.1, BEGIN + 0.4))
    np.testing.assert_allclose(heard, 0.1 + np.arange(len(heard)) / HEARD_RATE, atol=0.002)
