"""Sources of streamed sound, such as a microphone or a pipe."""

import importlib
from pathlib import Path
from typing import BinaryIO, Protocol

import numpy as np

from kinesic.body.utterance import Samples
from kinesic.extras import install_extra
from kinesic.hearing.voice_activity import VOICE_RATE

DEFAULT_MICROPHONE = "default"  # name of the machine's default microphone
SAMPLE_SIZE = 2  # [bytes] size of a sample in a file or pipe
NO_PORTAUDIO = "PortAudio is not installed: apt-get install libportaudio2"


class MicrophoneError(RuntimeError):
    """Failure to open a microphone or a file with samples.

    The text gives the reason and a remedy.
    """


class SampleSource(Protocol):
    """Stream of samples of one channel."""

    rate: int  # [Hz]

    def read(self, count: int) -> Samples:
        """Wait for samples (count,) in -1..1, or fewer at the end."""

    def close(self) -> None:
        """Close the source."""


class SampleFile:
    """File or pipe of 16-bit little-endian mono samples at 16 kHz."""

    rate = VOICE_RATE

    def __init__(self, path: Path) -> None:
        """Create the source, which the first `read` opens.

        Opening a pipe waits until a program writes into it.

        Raises:
            MicrophoneError: the file does not exist.
        """
        if not path.exists():
            raise MicrophoneError(f"there is no file or pipe {path}: make a pipe by `mkfifo {path}`")
        self._path = path
        self._file: BinaryIO | None = None

    def read(self, count: int) -> Samples:
        """Read samples (count,), or fewer at the end of the file."""
        if self._file is None:
            self._file = self._path.open("rb")
        data = self._file.read(SAMPLE_SIZE * count)
        return np.frombuffer(data[: len(data) // SAMPLE_SIZE * SAMPLE_SIZE], "<i2").astype(np.float32) / 32768.0

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            self._file.close()


class Microphone:
    """Microphone of the machine, by PortAudio."""

    def __init__(self, name: str, rate: int) -> None:
        """Open a microphone by its name, or the default one.

        Raises:
            MicrophoneError: the library or the microphone is missing.
        """
        self.rate = rate
        try:
            devices = importlib.import_module("sounddevice")
        except ImportError:
            raise MicrophoneError(f"sounddevice is not installed: {install_extra('hear')}") from None
        except OSError:
            raise MicrophoneError(NO_PORTAUDIO) from None
        try:
            self._stream = devices.InputStream(
                samplerate=rate, channels=1, dtype="float32", device=None if name == DEFAULT_MICROPHONE else name
            )
            self._stream.start()
        except (devices.PortAudioError, ValueError) as error:
            raise MicrophoneError(f"no microphone {name} that records {rate} Hz: {error}") from None

    def read(self, count: int) -> Samples:
        """Wait for the next samples (count,) of the microphone."""
        samples, _ = self._stream.read(count)
        return np.asarray(samples[:, 0], np.float32)

    def close(self) -> None:
        """Close the microphone."""
        self._stream.abort()
        self._stream.close()


def open_source(name: str, rate: int) -> SampleSource:
    """Open a microphone by name, or a file or pipe by path.

    Args:
        name: path, `default`, or a part of the name of a microphone.
        rate: rate of a microphone [Hz].

    Raises:
        MicrophoneError: it cannot be opened.
    """
    return SampleFile(Path(name)) if "/" in name or Path(name).exists() else Microphone(name, rate)
