import numpy as np
import pytest

from kinesic.body.utterance import Sound
from kinesic.speech import loudspeaker
from kinesic.speech.loudspeaker import Feed, PortAudio, SpeakerError
from kinesic.speech.speaker import Speaker, mix

RATE = 1000
CLICK = Sound.of(RATE, [1.0, 0.5, 0.25])
LATENCY = 0.05


class Tape:
    """A device that keeps what it is given; its clock goes on with what it plays."""

    latency = LATENCY

    def __init__(self, misjudged: tuple[float, ...] = (0.0,)) -> None:
        self.now, self.heard, self._misjudged = 100.0, np.zeros(0), misjudged
        self._feed: Feed | None = None

    def clock(self) -> float:
        return self.now

    def open(self, rate: int, feed: Feed) -> None:
        assert rate == RATE
        self._feed = feed

    def close(self) -> None:
        self._feed = None

    def turn(self, pieces: int, count: int = 64) -> None:
        for piece in range(pieces):
            if self._feed is None:
                return
            wrong = self._misjudged[piece % len(self._misjudged)]
            self.heard = np.append(self.heard, self._feed(count, self.now + LATENCY + wrong))
            self.now += count / RATE

    def at(self, time: float) -> int:
        """Sample that is heard at a time."""
        return round((time - 100.0 - LATENCY) * RATE)


@pytest.mark.parametrize("misjudged", [(0.0,), (0.0, 0.003, -0.004)])
def test_a_sound_is_heard_at_its_time_without_stumbling(misjudged: tuple[float, ...]):
    tape = Tape(misjudged)
    speaker = Speaker(tape.clock, device=tape, rate=RATE)
    speaker.play(CLICK, 100.5)
    tape.turn(20)
    assert np.flatnonzero(tape.heard).tolist() == [tape.at(100.5) + k for k in range(3)]
    assert speaker.latency == LATENCY


def test_a_device_that_stood_still_goes_on_in_time():
    tape = Tape()
    speaker = Speaker(tape.clock, device=tape, rate=RATE)
    speaker.play(CLICK, 101.0)
    tape.turn(3)
    tape.now += 0.5  # nothing was asked for
    lost = tape.at(101.0) - 500
    tape.turn(20)
    assert np.flatnonzero(tape.heard).tolist() == [lost, lost + 1, lost + 2]


def test_what_is_past_is_left_out_and_the_rest_is_in_time():
    tape = Tape()
    Speaker(tape.clock, device=tape, rate=RATE).play(Sound.of(RATE, np.linspace(0.1, 0.9, 500)), 99.9)
    tape.turn(10)
    assert tape.heard[0] == pytest.approx(np.linspace(0.1, 0.9, 500)[150], abs=1e-6)
    assert np.flatnonzero(tape.heard)[-1] == tape.at(99.9) + 499


def test_several_sounds_are_mixed():
    tape = Tape()
    speaker = Speaker(tape.clock, device=tape, rate=RATE)
    speaker.play(CLICK, 100.2)
    speaker.play(CLICK, 100.201)
    tape.turn(10)
    first = tape.at(100.2)
    assert tape.heard[first : first + 4].tolist() == [1.0, 1.0, 0.75, 0.25]  # 1.5 is too loud


def test_stop_is_silent_and_play_begins_again():
    tape = Tape()
    speaker = Speaker(tape.clock, device=tape, rate=RATE)
    speaker.play(CLICK, 100.2)
    speaker.stop()
    tape.turn(10)
    assert not tape.heard.any()
    speaker.play(CLICK, 100.9)
    tape.turn(10)
    assert np.flatnonzero(tape.heard)[0] == tape.at(100.9)


def test_a_device_is_let_go():
    tape = Tape()
    speaker = Speaker(tape.clock, device=tape, rate=RATE)
    speaker.close()
    tape.turn(10)
    assert tape.heard.size == 0


def test_a_sound_of_another_rate_takes_as_long():
    sound = Sound.of(2 * RATE, np.ones(400))
    found = mix(((1.0, sound),), 0.9, 400, RATE)
    assert np.flatnonzero(found > 0.5).tolist() == list(range(100, 300))


@pytest.mark.parametrize("begin", [-5.0, 0.0, 5.0])
def test_before_and_after_it_is_silent(begin: float):
    assert mix(((1.0, CLICK),), begin, 16, RATE).tolist() == [0.0] * 16


def test_a_machine_that_plays_nothing_says_what_mends_it():
    if not loudspeaker.audio_fault():
        pytest.skip("this machine plays sounds")
    with pytest.raises(SpeakerError):
        Speaker()


@pytest.mark.parametrize(("error", "line"), [(ImportError, "pip install"), (OSError, "libportaudio2")])
def test_what_is_missing_is_named(error: type[Exception], line: str, monkeypatch: pytest.MonkeyPatch):
    def missing(_: str) -> None:
        raise error

    monkeypatch.setattr(loudspeaker.importlib, "import_module", missing)
    assert line in loudspeaker.audio_fault()


def test_port_audio_tells_when_a_sample_is_heard(monkeypatch: pytest.MonkeyPatch):
    """A stream that asks once, 30 ms before it is heard, and once without saying when."""

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
    device.open(RATE, feed)
    assert heard == pytest.approx([10.03, 10.02])
    assert device._stream.buffers[0].tolist() == [[0.5]] * 4
    device.close()
    assert device._stream.buffers == []
