"""Reader of WAV recordings that checks the header and reads in blocks."""

import os
import wave
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from kinesic.body.config import ConfigError
from kinesic.body.utterance import Samples, Sound
from kinesic.files.input_file import open_regular

MAX_DURATION = 1300  # [s] longest accepted recording
MIN_RATE = 1_000  # [Hz] lowest accepted sample rate; speech is unintelligible at lower rates
MAX_RATE = 384_000  # [Hz] highest accepted sample rate, above the rates of all recording devices
MAX_CHANNELS = 32  # largest accepted number of channels of a recording
MAX_SAMPLES = MAX_DURATION * 48_000  # largest number of samples per channel of a recording; a quarter of a gigabyte
MAX_SAMPLE_WIDTH = 4  # [bytes] largest sample size of one channel
BLOCK_SIZE = 1 << 20  # [bytes] size of each read from a recording


class RecordingError(ValueError):
    """Failure to read a recording.

    The text gives the reason.
    """


def read_wav(path: Path) -> Sound:
    """Read a WAV file of 8 to 32 bits as one channel.

    Several channels become their mean.

    Raises:
        RecordingError: the file is missing, is not a plain WAV file, or has a rate, channels or a length out of bounds.
    """
    try:
        with open_regular(path) as file, wave.open(file) as recording:
            count = _check_header(path, recording, file)
            return Sound.of(recording.getframerate(), _read_samples(recording, count))
    except ConfigError as error:
        raise RecordingError(str(error)) from None
    except OSError as error:
        raise RecordingError(f"{path}: {error.strerror}") from None
    except (
        wave.Error,
        EOFError,
        RuntimeError,
    ) as error:  # EOFError and RuntimeError: a chunk is shorter than its header declares
        raise RecordingError(
            f"{path} is not a WAV file of uncompressed samples ({str(error) or 'it is truncated'})"
        ) from None


def _check_header(path: Path, recording: wave.Wave_read, file: BinaryIO) -> int:
    """Check a WAV header and return the number of samples per channel."""
    rate, channels, width = recording.getframerate(), recording.getnchannels(), recording.getsampwidth()
    if not MIN_RATE <= rate <= MAX_RATE:
        raise RecordingError(f"{path} has {rate} samples a second; {MIN_RATE} to {MAX_RATE} are read")
    if channels > MAX_CHANNELS:
        raise RecordingError(f"{path} has {channels} channels; at most {MAX_CHANNELS} are read")
    if width > MAX_SAMPLE_WIDTH:
        raise RecordingError(f"{path} has samples of {8 * width} bits; 8, 16, 24 and 32 are read")
    count = min(recording.getnframes(), os.fstat(file.fileno()).st_size // (width * channels))
    if count > MAX_DURATION * rate:
        raise RecordingError(f"{path} lasts {count / rate:.0f} s, at most {MAX_DURATION} s are read")
    if count > MAX_SAMPLES:
        most = f"{MAX_SAMPLES / 1e6:.0f} million are read; {MAX_DURATION} s have as many at 48 kHz"
        raise RecordingError(f"{path} has {count / 1e6:.0f} million samples, at most {most}")
    return count


def _read_samples(recording: wave.Wave_read, count: int) -> Samples:
    """Read WAV samples block by block, mixed to one channel."""
    channels, width = recording.getnchannels(), recording.getsampwidth()
    samples: Samples = np.zeros(count, dtype=np.float32)
    block, begin = max(BLOCK_SIZE // (width * channels), 1), 0
    while begin < count:
        data = recording.readframes(min(block, count - begin))
        rows = len(data) // (width * channels)
        if not rows:
            break
        values = _decode(data[: rows * width * channels], width)
        samples[begin : begin + rows] = values.reshape(-1, channels).mean(axis=1)
        begin += rows
    return samples[:begin]


def _decode(data: bytes, width: int) -> NDArray[np.float64]:
    """Convert WAV sample bytes to samples in -1..1.

    8-bit samples are unsigned, and 24-bit samples are widened to 32 bits.
    """
    if width == 1:
        return np.frombuffer(data, dtype=np.uint8) / 128.0 - 1.0
    if width == 3:
        wide = np.zeros((len(data) // 3, 4), dtype=np.uint8)
        wide[:, 1:] = np.frombuffer(data, dtype=np.uint8).reshape(-1, 3)
        return wide.view("<i4")[:, 0] / 2.0**31
    return np.frombuffer(data, dtype=f"<i{width}") / 2.0 ** (8 * width - 1)
