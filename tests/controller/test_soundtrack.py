import wave
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.utterance import Script, Sound, Utterance
from kinesic.controller import soundtrack
from kinesic.controller.soundtrack import SpeechPlayback, resample_sound, sound, speak_along, write_wav
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.metrics.servo_run import FULL_TIME_SCALE
from kinesic.planning.setup import Setup
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.speech.loudspeaker import Feed, SpeakerError
from kinesic.speech.recording import read_wav
from kinesic.speech.speaker import SAMPLE_RATE as HEARD_RATE
from kinesic.speech.speaker import Speaker

VOICE_RATE = 16000  # [Hz] sample rate of the voice
BLOCK = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    '<speech id="one" start="0.5"><text>one</text></speech>'
    '<speech id="two" start="{two}"><text>two</text></speech>'
    '<gesture id="g" lexeme="offer" mode="RIGHT_HAND" stroke="0.4" end="4"/></bml>'
)


class Beep:
    """Voice with a constant for every text."""

    def __init__(self, loudness: float = 0.25, seconds: float = 0.5) -> None:
        self._loudness, self._seconds = loudness, seconds

    def say(self, script: Script, /, *, rate: float = 1.0, pitch: float = 1.0) -> Utterance:
        own = VOICE_RATE if script.text == "one" else VOICE_RATE // 2
        beep = Sound.of(own, np.full(round(own * self._seconds), self._loudness))
        return Utterance(0.5, {}, (), "beep", beep)


@pytest.fixture
def known() -> Setup:
    return set_up()


def beeping(known: Setup, two: float, loudness: float = 0.25, seconds: float = 0.5):
    object.__setattr__(known, "voice", Beep(loudness, seconds))
    return plan(BLOCK.format(two=two), known)


def test_speech_samples_that_precede_the_motion_are_cut(known: Setup):
    object.__setattr__(known, "voice", Beep())
    both = '<speech id="one" start="0"><text>one</text></speech><gesture id="g" lexeme="offer" start="0.0123"/>'
    planned = plan(f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{both}</bml>', known)
    assert planned.trajectory.zero == pytest.approx(-0.0123)
    heard = sound(planned)
    assert heard is not None
    assert np.count_nonzero(heard.samples) == round((0.5 - 0.0123) * VOICE_RATE)
    assert heard.samples[0] > 0.0


def test_utterances_in_the_soundtrack_start_and_end_at_their_planned_times(known: Setup):
    planned = beeping(known, 2.0)
    assert planned.trajectory.zero > 0.0  # the hand begins before the block does
    heard = sound(planned)
    assert heard is not None
    assert heard.rate == VOICE_RATE
    assert heard.duration == pytest.approx(planned.duration, abs=1e-3)
    edges = np.flatnonzero(np.diff((np.abs(heard.samples) > 0.125).astype(int))) / VOICE_RATE
    zero = planned.trajectory.zero
    assert edges == pytest.approx([zero + 0.5, zero + 1.0, zero + 2.0, zero + 2.5], abs=1e-3)


def test_sample_rate_of_96_khz_speech_is_reduced_to_48_khz(known: Setup):
    planned = beeping(known, 2.0)
    utterances = {
        name: replace(spoken, sound=spoken.sound and Sound.of(96_000, np.zeros(96_000)))
        for name, spoken in planned.utterances.items()
    }
    heard = sound(replace(planned, utterances=utterances))
    assert heard is not None
    assert heard.rate == 48_000


def test_simultaneous_utterances_are_mixed_without_clipping(known: Setup):
    heard = sound(beeping(known, 0.75, loudness=0.8))
    assert heard is not None
    assert np.abs(heard.samples).max() == pytest.approx(1.0)


@pytest.mark.parametrize("loudness", [0.25, -0.25, -0.8])
def test_mixed_sound_of_simultaneous_speech_keeps_the_sample_sign(known: Setup, loudness: float):
    heard = sound(beeping(known, 0.75, loudness=loudness))
    assert heard is not None
    assert heard.samples[np.abs(heard.samples).argmax()] == pytest.approx(max(2 * loudness, -1.0), abs=0.1)


def test_soundtrack_contains_all_of_a_speech_that_is_longer_than_the_motion(known: Setup):
    planned = beeping(known, 2.0, seconds=9.0)
    heard = sound(planned)
    assert heard is not None
    assert planned.duration < 9.0
    assert heard.duration == pytest.approx(planned.trajectory.zero + 2.0 + 9.0, abs=1e-3)
    assert abs(heard.samples[-1]) > 0.1


def test_plan_with_the_silent_voice_has_no_soundtrack():
    assert sound(plan(BLOCK.format(two=2), set_up())) is None


def test_resampled_speech_keeps_its_pitch():
    tone = Sound.of(VOICE_RATE, 0.5 * np.sin(2 * np.pi * 200 * np.arange(VOICE_RATE) / VOICE_RATE))
    other = resample_sound(tone, 22050)
    assert len(other) == 22050
    expected = 0.5 * np.sin(2 * np.pi * 200 * np.arange(22050) / 22050)
    assert np.abs(other - expected)[200:-200].max() < 0.01


@pytest.mark.parametrize("count", [1, 5, 999])
@pytest.mark.parametrize(("given", "rate"), [(22050, 48000), (24000, 48000), (48000, 22050), (96000, 48000)])
def test_resampled_sound_matches_scipy(given: int, rate: int, count: int):
    signal = pytest.importorskip("scipy.signal", reason="SciPy, the oracle of this test, is not installed")
    noise = Sound.of(given, np.random.default_rng(count).uniform(-0.9, 0.9, count))
    other = signal.resample_poly(noise.samples, rate, given)
    np.testing.assert_allclose(resample_sound(noise, rate), other, atol=1e-6)


def test_wav_file_contains_the_soundtrack(tmp_path: Path):
    ramp = Sound.of(VOICE_RATE, np.linspace(-1.0, 1.0, 1001))
    write_wav(ramp, tmp_path / "ramp.wav")
    with wave.open(str(tmp_path / "ramp.wav")) as file:
        assert (file.getnchannels(), file.getsampwidth(), file.getframerate()) == (1, 2, VOICE_RATE)
    assert read_wav(tmp_path / "ramp.wav").samples == pytest.approx(ramp.samples, abs=1e-4)


def test_speech_samples_beyond_full_scale_are_clipped_in_the_wav_file(tmp_path: Path):
    write_wav(Sound.of(VOICE_RATE, np.array([1.5, -1.5, 0.5])), tmp_path / "loud.wav")
    with wave.open(str(tmp_path / "loud.wav")) as file:
        assert np.frombuffer(file.readframes(3), "<i2").tolist() == [32767, -32767, 16384]


class RecordingSpeaker:
    """Loudspeaker that records its calls."""

    def __init__(self) -> None:
        self.calls: list[object] = []

    def play(self, played: Sound, zero: float) -> None:
        self.calls.append((played.rate, zero))

    def stop(self) -> None:
        self.calls.append("stop")

    def close(self) -> None:
        self.calls.append("close")


def test_speech_plays_from_the_first_active_status_until_a_hold_and_the_speaker_is_closed(
    known: Setup, monkeypatch: pytest.MonkeyPatch
):
    speaker, warnings = RecordingSpeaker(), list[str]()
    monkeypatch.setattr(soundtrack, "Speaker", lambda: speaker)
    status = replace(Status(Stage.ACTIVE), clock=12.0, time=2.0, scale=1.0)
    with speak_along(beeping(known, 2.0), warnings.append) as follow:
        follow(replace(status, scale=FULL_TIME_SCALE))
        assert speaker.calls == []
        follow(status)
        follow(replace(status, stage=Stage.HOLD))
    assert speaker.calls == [(VOICE_RATE, 10.0), "stop", "close"]
    assert warnings == []


def test_missing_loudspeaker_causes_a_warning(known: Setup, monkeypatch: pytest.MonkeyPatch):
    def fail() -> None:
        raise SpeakerError("no device")

    monkeypatch.setattr(soundtrack, "Speaker", fail)
    warnings: list[str] = []
    with speak_along(beeping(known, 2.0), warnings.append) as follow:
        follow(replace(Status(Stage.ACTIVE), clock=12.0, time=2.0, scale=1.0))
    assert warnings == ["voice: no sound (no device)"]


def test_plan_without_sound_opens_no_loudspeaker(monkeypatch: pytest.MonkeyPatch):
    opened: list[bool] = []
    monkeypatch.setattr(soundtrack, "Speaker", lambda: opened.append(True))
    with speak_along(plan(BLOCK.format(two=2), set_up()), opened.append) as follow:
        follow(replace(Status(Stage.ACTIVE), clock=12.0, time=2.0, scale=1.0))
    assert opened == []


DEVICE_LEAD_TIME = 0.02  # [s] time from a request of the audio device to its playback
DEVICE_BLOCK_SIZE = 441  # number of samples per request of the audio device
STATUS_PERIOD = 0.02  # [s] time between two statuses of the supervisor
START_CLOCK = 100.3  # [s] clock at performance time 0


class Tape:
    """Audio device whose clock advances with its playback."""

    latency = DEVICE_LEAD_TIME

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
        for _ in range(round(seconds * HEARD_RATE / DEVICE_BLOCK_SIZE)):
            if self._feed is not None:
                self.heard.append(self._feed(DEVICE_BLOCK_SIZE, self.now + DEVICE_LEAD_TIME))
            self.now += DEVICE_BLOCK_SIZE / HEARD_RATE

    def part(self, begin: float, end: float) -> np.ndarray:
        """Return the sound between two clock times."""
        first, last = (round((time - 100.0 - DEVICE_LEAD_TIME) * HEARD_RATE) for time in (begin, end))
        return np.concatenate(self.heard)[first:last]


class Stand:
    """Supervisor with periodic statuses, and a sound that encodes its time.

    Each sample is half its time in seconds.
    """

    def __init__(self) -> None:
        self.tape = Tape()
        self.speaker = Speaker(self.tape.clock, device=self.tape)
        self.aloud = SpeechPlayback(Sound.of(HEARD_RATE, np.arange(2 * HEARD_RATE) / HEARD_RATE / 2), self.speaker)
        self.time = 0.0

    def go(self, seconds: float, stage: Stage, scale: float = 1.0, *, told: bool = True) -> None:
        """Advance the clock and the performance time in steps of the status period."""
        for _ in range(round(seconds / STATUS_PERIOD)):
            if told:
                self.aloud(replace(Status(stage), clock=self.tape.now, time=self.time, scale=scale))
            self.tape.turn(STATUS_PERIOD)
            self.time += scale * STATUS_PERIOD


@pytest.fixture
def stand() -> Stand:
    return Stand()


def own_times(samples: np.ndarray) -> np.ndarray:
    """Decode the time of each sample [s]."""
    return 2 * samples


def test_speech_playback_starts_when_performance_time_starts(stand: Stand):
    stand.go(0.3, Stage.HOLD, 0.0)
    stand.go(0.6, Stage.ACTIVE)
    assert not stand.tape.part(100.05, START_CLOCK).any()
    heard = own_times(stand.tape.part(START_CLOCK + 0.1, START_CLOCK + 0.5))
    np.testing.assert_allclose(heard, 0.1 + np.arange(len(heard)) / HEARD_RATE, atol=0.002)


def test_speech_pauses_with_slowed_time_and_resumes_in_sync(stand: Stand):
    stand.go(0.3, Stage.HOLD, 0.0)
    stand.go(0.4, Stage.ACTIVE)
    stand.go(0.2, Stage.DEGRADED, 0.5)
    stand.go(0.2, Stage.HOLD, 0.0)
    stand.go(0.4, Stage.ACTIVE)
    assert not stand.tape.part(START_CLOCK + 0.45, START_CLOCK + 0.8).any()
    heard = own_times(stand.tape.part(START_CLOCK + 0.9, START_CLOCK + 1.1))
    passed = 0.4 + 0.5 * 0.2 + 0.1  # [s]
    np.testing.assert_allclose(heard, passed + np.arange(len(heard)) / HEARD_RATE, atol=0.002)


@pytest.mark.parametrize("stage", [Stage.STOPPED, Stage.FOLD, Stage.LOST, Stage.LIMP])
def test_speech_ends_if_the_servos_are_stopped_folding_lost_or_without_torque(stand: Stand, stage: Stage):
    stand.go(0.3, Stage.HOLD, 0.0)
    stand.go(0.4, Stage.ACTIVE)
    stand.go(0.4, stage)
    assert not stand.tape.part(START_CLOCK + 0.45, START_CLOCK + 0.75).any()


def test_speech_playback_is_realigned_after_a_jump_of_performance_time(stand: Stand):
    stand.go(0.3, Stage.HOLD, 0.0)
    stand.go(0.2, Stage.ACTIVE)
    stand.time += 0.2
    stand.go(0.3, Stage.ACTIVE)
    heard = own_times(stand.tape.part(START_CLOCK + 0.3, START_CLOCK + 0.4))
    np.testing.assert_allclose(heard, 0.5 + np.arange(len(heard)) / HEARD_RATE, atol=0.002)


def test_speech_continues_through_200_ms_without_servo_status(stand: Stand):
    stand.go(0.3, Stage.HOLD, 0.0)
    stand.go(0.1, Stage.ACTIVE)
    stand.go(0.2, Stage.ACTIVE, told=False)
    stand.go(0.2, Stage.ACTIVE)
    heard = own_times(stand.tape.part(START_CLOCK + 0.1, START_CLOCK + 0.4))
    np.testing.assert_allclose(heard, 0.1 + np.arange(len(heard)) / HEARD_RATE, atol=0.002)
