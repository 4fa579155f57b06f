"""Access to the loudspeaker by PortAudio, and the interface of sound outputs."""

import importlib
from collections.abc import Callable
from typing import Protocol

from kinesic.body.utterance import Samples
from kinesic.extras import install_extra

BUFFER_DURATION = 0.1  # [s] duration of sound handed over in advance, so that a busy machine does not stutter
LIBRARY_COMMAND = "apt-get install libportaudio2"  # command that installs PortAudio on Debian and Ubuntu

Clock = Callable[[], float]
Feed = Callable[[int, float], Samples]  # (number of samples, clock time at which the first is heard) -> the samples


class SpeakerError(RuntimeError):
    """Failure to play sound.

    The text gives the reason and a remedy.
    """


class Device(Protocol):
    """Interface of a sound output that requests samples as it plays."""

    @property
    def latency(self) -> float:
        """Last measured delay [s] from requesting samples to hearing them."""

    def open(self, rate: int, feed: Feed) -> None:
        """Open the sound output for one channel at a rate [Hz].

        Raises:
            SpeakerError: no device is available.
        """

    def close(self) -> None:
        """Close the sound output."""


class _Times(Protocol):
    """Times in a PortAudio callback, on PortAudio's clock [s]."""

    currentTime: float  # noqa: N815 - PortAudio's name
    outputBufferDacTime: float  # noqa: N815 - PortAudio's name


class _Buffer(Protocol):
    """PortAudio's buffer for samples, shape (count, 1)."""

    def __setitem__(self, key: tuple[slice, int], value: Samples) -> None: ...


class PortAudio:
    """The default sound output of the machine."""

    def __init__(self, clock: Clock) -> None:
        """Create a closed sound output whose playback times [s] follow a clock."""
        self._clock = clock
        self.latency = BUFFER_DURATION  # [s] as last measured

    def open(self, rate: int, feed: Feed) -> None:
        """Open PortAudio's output, which requests samples by a callback.

        Raises:
            SpeakerError: the library or the device is missing.
        """
        why = audio_fault()
        if why:
            raise SpeakerError(why)
        devices = importlib.import_module("sounddevice")

        def deliver(buffer: _Buffer, count: int, times: _Times, _: object) -> None:
            ahead = times.outputBufferDacTime - times.currentTime
            self.latency = ahead if ahead > 0.0 else float(self._stream.latency)  # some drivers do not report the time
            buffer[:, 0] = feed(count, self._clock() + self.latency)

        try:
            self._stream = devices.OutputStream(
                samplerate=rate, channels=1, dtype="float32", latency=BUFFER_DURATION, callback=deliver
            )
            self._stream.start()
        except devices.PortAudioError as error:
            raise SpeakerError(f"no sound device that plays {rate} Hz: {error}") from None

    def close(self) -> None:
        """Stop PortAudio's output at once.

        Samples not yet heard are dropped.
        """
        self._stream.abort()
        self._stream.close()


def audio_fault() -> str:
    """Return why sound cannot be played, with a remedy.

    The result is empty if it can.
    """
    try:
        devices = importlib.import_module("sounddevice")
    except ImportError:
        return f"sounddevice is not installed: {install_extra('speech')}"
    except OSError:
        return f"PortAudio is not installed: {LIBRARY_COMMAND}"
    if not any(device["max_output_channels"] for device in devices.query_devices()):
        return "this machine has no sound device"
    return ""
