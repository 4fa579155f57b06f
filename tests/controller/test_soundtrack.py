import wave
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.utterance import Script, Sound, Utterance
from kinesic.controller.perform import plan, set_up
from kinesic.controller.soundtrack import resample, sound, write_wav
from kinesic.planning.setup import Setup
from kinesic.speech.recorded import read_wav

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
