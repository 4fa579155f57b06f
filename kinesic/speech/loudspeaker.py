"""The machine's loudspeaker, by PortAudio, and what a loudspeaker is to those who play on one."""

import importlib
from collections.abc import Callable
from typing import Protocol

from kinesic.body.utterance import Samples

INSTALL = "pip install 'kinesic[speech]'"
BUFFERED = 0.1  # [s] that are handed over ahead, so that a busy machine does not stutter
LIBRARY = "apt-get install libportaudio2"

Clock = Callable[[], float]
Feed = Callable[[int, float], Samples]  # so many samples, heard from this time on the clock -> the samples


class SpeakerError(RuntimeError):
    """Nothing can be played here; the text says why, and what mends it."""


class Device(Protocol):
    """Something that plays samples as they come."""

    @property
    def latency(self) -> float:
        """[s] from asking for samples until they are heard, as last measured."""

    def open(self, rate: int, feed: Feed) -> None:
        """Begins to ask for samples of one channel at a rate [Hz], again and again.

        Raises:
            SpeakerError: there is nothing to play on.
        """

    def close(self) -> None:
        """Stops asking for samples."""


class _Times(Protocol):
    """PortAudio's times of one call, on its own clock [s]."""

    currentTime: float  # noqa: N815 - PortAudio's name
    outputBufferDacTime: float  # noqa: N815 - PortAudio's name


class _Buffer(Protocol):
    """Where samples go, (count, 1)."""

    def __setitem__(self, key: tuple[slice, int], value: Samples) -> None: ...


class PortAudio:
    """The default output of this machine."""

    def __init__(self, clock: Clock) -> None:
        """Takes the clock of all times [s]."""
        self._clock = clock
        self.latency = BUFFERED  # [s] as last measured

    def open(self, rate: int, feed: Feed) -> None:
        """Begins to ask for samples.

        Raises:
            SpeakerError: the library or the device is missing.
        """
        why = audio_fault()
        if why:
            raise SpeakerError(why)
        devices = importlib.import_module("sounddevice")

        def wanted(buffer: _Buffer, count: int, times: _Times, _: object) -> None:
            ahead = times.outputBufferDacTime - times.currentTime
            self.latency = ahead if ahead > 0.0 else float(self._stream.latency)  # some drivers do not tell
            buffer[:, 0] = feed(count, self._clock() + self.latency)

        try:
            self._stream = devices.OutputStream(
                samplerate=rate, channels=1, dtype="float32", latency=BUFFERED, callback=wanted
            )
            self._stream.start()
        except devices.PortAudioError as error:
            raise SpeakerError(f"no sound device that plays {rate} Hz: {error}") from None

    def close(self) -> None:
        """Ends that; what is not heard yet is not played."""
        self._stream.abort()
        self._stream.close()


def audio_fault() -> str:
    """Says why nothing can be played here, and what mends it; empty when it can."""
    try:
        devices = importlib.import_module("sounddevice")
    except ImportError:
        return f"sounddevice is not installed: {INSTALL}"
    except OSError:
        return f"PortAudio is not installed: {LIBRARY}"
    if not any(device["max_output_channels"] for device in devices.query_devices()):
        return "this machine has no sound device"
    return ""
