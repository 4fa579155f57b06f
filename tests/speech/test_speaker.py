import numpy as np
import pytest

from kinesic.body.utterance import Sound
from kinesic.speech import loudspeaker
from kinesic.speech.loudspeaker import Feed, PortAudio, SpeakerError
from kinesic.speech.speaker import FADE_DURATION, MAX_MUTE_DURATION, PlayedSound, Speaker, mix

SAMPLE_RATE = 1000  # [Hz]
CLICK_SOUND = Sound.of(SAMPLE_RATE, [1.0, 0.5, 0.25])  # sound of three samples
DEVICE_LATENCY = 0.05  # [s]


class Tape:
    """Fake sound device that records its input and has its own clock."""

    latency = DEVICE_LATENCY

    def __init__(self, time_errors: tuple[float, ...] = (0.0,)) -> None:
        self.now, self.heard, self._misjudged = 100.0, np.zeros(0), time_errors
        self._feed: Feed | None = None

    def clock(self) -> float:
        return self.now

    def open(self, rate: int, feed: Feed) -> None:
        assert rate == SAMPLE_RATE
        self._feed = feed

    def close(self) -> None:
        self._feed = None

    def turn(self, pieces: int, count: int = 64) -> None:
        for piece in range(pieces):
            if self._feed is None:
                return
            error = self._misjudged[piece % len(self._misjudged)]
            self.heard = np.append(self.heard, self._feed(count, self.now + DEVICE_LATENCY + error))
            self.now += count / SAMPLE_RATE

    def at(self, time: float) -> int:
        """Return the sample that is audible at a time."""
        return round((time - 100.0 - DEVICE_LATENCY) * SAMPLE_RATE)


@pytest.mark.parametrize("time_errors", [(0.0,), (0.0, 0.003, -0.004)])
def test_speaker_plays_a_sound_at_its_requested_time_without_gaps(time_errors: tuple[float, ...]):
    tape = Tape(time_errors)
    speaker = Speaker(tape.clock, device=tape, rate=SAMPLE_RATE)
    speaker.play(CLICK_SOUND, 100.5)
    tape.turn(20)
    assert np.flatnonzero(tape.heard).tolist() == [tape.at(100.5) + k for k in range(3)]
    assert speaker.latency == DEVICE_LATENCY


def test_sound_after_a_stall_of_the_device_starts_on_time():
    tape = Tape()
    speaker = Speaker(tape.clock, device=tape, rate=SAMPLE_RATE)
    speaker.play(CLICK_SOUND, 101.0)
    tape.turn(3)
    tape.now += 0.5  # no samples were requested
    lost = tape.at(101.0) - 500
    tape.turn(20)
    assert np.flatnonzero(tape.heard).tolist() == [lost, lost + 1, lost + 2]


def test_sound_requested_too_late_skips_its_beginning():
    tape = Tape()
    Speaker(tape.clock, device=tape, rate=SAMPLE_RATE).play(Sound.of(SAMPLE_RATE, np.linspace(0.1, 0.9, 500)), 99.9)
    tape.turn(10)
    assert tape.heard[0] == pytest.approx(np.linspace(0.1, 0.9, 500)[150], abs=1e-6)
    assert np.flatnonzero(tape.heard)[-1] == tape.at(99.9) + 499


def test_speaker_adds_overlapping_sounds_and_clips_the_sum_at_one():
    tape = Tape()
    speaker = Speaker(tape.clock, device=tape, rate=SAMPLE_RATE)
    speaker.play(CLICK_SOUND, 100.2)
    speaker.play(CLICK_SOUND, 100.201)
    tape.turn(10)
    first = tape.at(100.2)
    assert tape.heard[first : first + 4].tolist() == [1.0, 1.0, 0.75, 0.25]  # 1.5 is clipped


def test_stopped_speaker_is_silent_until_the_next_sound():
    tape = Tape()
    speaker = Speaker(tape.clock, device=tape, rate=SAMPLE_RATE)
    speaker.play(CLICK_SOUND, 100.2)
    speaker.stop()
    tape.turn(10)
    assert not tape.heard.any()
    speaker.play(CLICK_SOUND, 100.9)
    tape.turn(10)
    assert np.flatnonzero(tape.heard)[0] == tape.at(100.9)


def test_faded_sound_ends_without_a_step_while_other_sounds_continue():
    tape, tone = Tape(), Sound.of(SAMPLE_RATE, np.full(1000, 0.25))
    speaker = Speaker(tape.clock, device=tape, rate=SAMPLE_RATE)
    speaker.play(tone, 100.1)
    speaker.play(tone, 100.2)
    tape.turn(5)
    first = len(tape.heard)
    speaker.fade_out(tone, 100.1)
    tape.turn(2)
    speaker.fade_out(tone, 100.1)  # a second request does not begin the fade again
    tape.turn(5)
    assert tape.heard[first - 1] == 0.5
    assert np.abs(np.diff(tape.heard[first:])).max() < 0.25 * 1.6 / (FADE_DURATION * SAMPLE_RATE)
    assert (tape.heard[first + round(FADE_DURATION * SAMPLE_RATE) :] == 0.25).all()
    assert tape.heard[first + 20] == pytest.approx(0.375, abs=0.01)


def test_muted_speaker_fades_out_and_in_while_the_time_of_its_sounds_continues():
    tape = Tape()
    speaker = Speaker(tape.clock, device=tape, rate=SAMPLE_RATE)
    speaker.play(Sound.of(SAMPLE_RATE, np.linspace(0.2, 0.8, 1000)), 100.05)
    tape.turn(3)
    speaker.mute(on=True)
    tape.turn(3)
    speaker.mute(on=False)
    tape.turn(3)
    muted, heard, fade = 3 * 64, 6 * 64, round(FADE_DURATION * SAMPLE_RATE)
    assert np.abs(np.diff(tape.heard[muted - 1 : heard + fade])).max() < 0.03
    assert not tape.heard[muted + fade : heard].any()
    undisturbed = np.linspace(0.2, 0.8, 1000)
    assert tape.heard[heard + fade] == pytest.approx(undisturbed[heard + fade], abs=1e-3)
    assert tape.heard[muted - 1] == pytest.approx(undisturbed[muted - 1], abs=1e-3)


def test_muted_speaker_is_audible_again_after_the_maximum_mute_duration():
    tape = Tape()
    speaker = Speaker(tape.clock, device=tape, rate=SAMPLE_RATE)
    speaker.play(Sound.of(SAMPLE_RATE, np.full(9000, 0.5)), 100.0)
    speaker.mute(on=True)
    tape.turn(110)
    begin = np.flatnonzero(tape.heard[100:])[0] + 100
    assert begin / SAMPLE_RATE == pytest.approx(MAX_MUTE_DURATION - DEVICE_LATENCY, abs=0.07)
    assert tape.heard[-1] == 0.5


def test_closed_sound_device_plays_nothing():
    tape = Tape()
    speaker = Speaker(tape.clock, device=tape, rate=SAMPLE_RATE)
    speaker.close()
    tape.turn(10)
    assert tape.heard.size == 0


def test_sound_with_another_rate_keeps_its_duration():
    sound = Sound.of(2 * SAMPLE_RATE, np.ones(400))
    mixed = mix((PlayedSound(sound, 1.0),), 0.9, 400, SAMPLE_RATE)
    assert np.flatnonzero(mixed > 0.5).tolist() == list(range(100, 300))


@pytest.mark.parametrize("begin", [-5.0, 0.0, 5.0])
def test_speaker_mix_is_silent_before_and_after_a_sound(begin: float):
    assert mix((PlayedSound(CLICK_SOUND, 1.0),), begin, 16, SAMPLE_RATE).tolist() == [0.0] * 16


def test_missing_sound_device_raises_a_speaker_error():
    if not loudspeaker.audio_fault():
        pytest.skip("this machine plays sounds")
    with pytest.raises(SpeakerError):
        Speaker()


@pytest.mark.parametrize(("error", "line"), [(ImportError, "pip install"), (OSError, "libportaudio2")])
def test_missing_sound_package_is_reported_with_a_remedy(
    error: type[Exception], line: str, monkeypatch: pytest.MonkeyPatch
):
    def missing(_: str) -> None:
        raise error

    monkeypatch.setattr(loudspeaker.importlib, "import_module", missing)
    assert line in loudspeaker.audio_fault()


def test_port_audio_playback_time_includes_the_output_latency(monkeypatch: pytest.MonkeyPatch):
    """Use a stream that reports 30 ms of latency, then no time."""

    class Times:
        currentTime, outputBufferDacTime = 7.0, 7.03  # noqa: N815 - PortAudio's names

    class Unknown:
        currentTime = outputBufferDacTime = 0.0  # noqa: N815 - PortAudio's names

    class Stream:
        latency = 0.02

        def __init__(self, *, callback, **_: object) -> None:
            self.callback, self.buffers = callback, [np.zeros((4, 1)), np.zeros((4, 1))]

        def start(self) -> None:
            self.callback(self.buffers[0], 4, Times, None)
            device._stream = self
            self.callback(self.buffers[1], 4, Unknown, None)

        def abort(self) -> None:
            self.buffers = []

        def close(self) -> None:
            self.buffers = []

    class Devices:
        OutputStream, PortAudioError = Stream, ValueError

        @staticmethod
        def query_devices() -> list[dict[str, int]]:
            return [{"max_output_channels": 2}]

    heard: list[float] = []

    def feed(count: int, time: float) -> np.ndarray:
        heard.append(time)
        return np.full(count, 0.5, dtype=np.float32)

    monkeypatch.setattr(loudspeaker.importlib, "import_module", lambda _: Devices)
    device = PortAudio(lambda: 10.0)
    device.open(SAMPLE_RATE, feed)
    assert heard == pytest.approx([10.03, 10.02])
    assert device._stream.buffers[0].tolist() == [[0.5]] * 4
    device.close()
    assert device._stream.buffers == []


def test_monitor_of_a_speaker_gets_the_samples_that_the_device_gets():
    tape, copies = Tape(), []
    speaker = Speaker(tape.clock, device=tape, rate=SAMPLE_RATE)
    speaker.monitor = copies.append
    speaker.play(CLICK_SOUND, tape.now + 0.1)
    tape.turn(4)
    np.testing.assert_array_equal(np.concatenate(copies), tape.heard)
    assert tape.heard.max() == 1.0
