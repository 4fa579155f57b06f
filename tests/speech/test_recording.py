"""Tests of WAV files with invalid headers, and of memory use."""

import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from kinesic.speech import recording
from kinesic.speech.recording import RecordingError, read_wav


def write_wav(
    path: Path, *, rate: int = 8000, bits: int = 16, channels: int = 1, data: int = 1600, declared: int | None = None
) -> Path:
    """Write a WAV file of zeros with any header, sparse if possible."""
    frame = channels * bits // 8
    declared = data if declared is None else declared
    head = struct.pack("<4sI4s4sIHHIIHH", b"RIFF", (36 + declared) % 2**32, b"WAVE", b"fmt ", 16, 1, channels, rate,
                       rate * frame % 2**32, frame % 2**16, bits)  # fmt: skip
    with path.open("wb") as file:
        file.write(head + struct.pack("<4sI", b"data", declared))
        file.truncate(44 + data)
    return path


@pytest.mark.parametrize("bits", [40, 48, 56, 64, 128, 65528])
def test_wav_files_of_unsupported_sample_widths_are_rejected(bits: int, tmp_path: Path):
    with pytest.raises(RecordingError, match=rf"samples of {bits} bits; 8, 16, 24 and 32 are read"):
        read_wav(write_wav(tmp_path / "wide.wav", bits=bits, data=40 * 8191))


@pytest.mark.parametrize("rate", [0, 1, 999, 384_001, 4_290_000_000])
def test_wav_files_of_unrealistic_sample_rates_are_rejected(rate: int, tmp_path: Path):
    with pytest.raises(RecordingError, match=rf"{rate} samples a second; 1000 to 384000 are read"):
        read_wav(write_wav(tmp_path / "fast.wav", rate=rate))


def test_wav_file_with_200_channels_is_rejected(tmp_path: Path):
    with pytest.raises(RecordingError, match="200 channels; at most 32"):
        read_wav(write_wav(tmp_path / "wide.wav", channels=200))


@pytest.mark.parametrize("rate", [recording.MIN_RATE, 44_100, recording.MAX_RATE])
def test_wav_files_of_the_lowest_usual_and_highest_sample_rate_are_read(rate: int, tmp_path: Path):
    assert read_wav(write_wav(tmp_path / "x.wav", rate=rate)).rate == rate


@pytest.mark.parametrize(("rate", "reason"), [(8_000, "lasts 2344 s"), (384_000, "19 million samples")])
def test_long_recordings_are_rejected_with_their_duration_or_sample_count(
    rate: int, reason: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(recording, "MAX_SAMPLES", 18_000_000)
    with pytest.raises(RecordingError, match=reason):
        read_wav(write_wav(tmp_path / "long.wav", rate=rate, bits=8, data=18_750_000))


def test_wav_length_declared_beyond_the_file_is_cut_to_the_existing_samples(tmp_path: Path):
    sound = read_wav(write_wav(tmp_path / "short.wav", data=1600, declared=2**31))
    assert len(sound.samples) == 800


def test_blockwise_wav_reading_gives_the_same_samples(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = write_wav(tmp_path / "noise.wav", bits=24, channels=3, data=9 * 1000)
    noise = np.random.default_rng(0).integers(0, 256, 9 * 1000, dtype=np.uint8).tobytes()
    path.write_bytes(path.read_bytes()[:44] + noise)
    whole = read_wav(path).samples
    monkeypatch.setattr(recording, "BLOCK_SIZE", 100)
    np.testing.assert_array_equal(read_wav(path).samples, whole)


PEAK_PROGRAM = """
import resource, sys
from pathlib import Path
from kinesic.speech.recording import RecordingError, read_wav
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
try:
    print(len(read_wav(Path(sys.argv[1])).samples))
except RecordingError as error:
    print(error)
print(1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="peak memory is in kB only on Linux")
@pytest.mark.parametrize(
    ("rate", "bits", "most"),
    [
        (4_290_000_000, 8, 10e6),
        (384_000, 8, 10e6),
        (150_000, 16, 10e6),
        pytest.param(48_000, 32, 400e6, marks=pytest.mark.soak),
    ],
)
def test_wav_file_of_300_megabytes_takes_bounded_memory(rate: int, bits: int, most: float, tmp_path: Path):
    path = write_wav(tmp_path / "large.wav", rate=rate, bits=bits, channels=bits // 8, data=300_000_000 * bits // 16)
    run = subprocess.run([sys.executable, "-c", PEAK_PROGRAM, path], capture_output=True, text=True, check=True)
    *_, peak = run.stdout.splitlines()
    assert float(peak) < most, run.stdout


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"", "it is truncated"),
        (b"RIFF", "it is truncated"),
        (b"no recording at all, but a letter", "file does not start with RIFF id"),
        (b"RIFF\x24\0\0\0WAVEdata\0\0\0\0", "data chunk before fmt chunk"),
    ],
)
def test_invalid_wav_file_is_rejected_with_the_reason(content: bytes, why: str, tmp_path: Path):
    path = tmp_path / "letter.wav"
    path.write_bytes(content)
    with pytest.raises(RecordingError, match=rf"letter\.wav is not a WAV file of uncompressed samples \({why}\)"):
        read_wav(path)
    with pytest.raises(RecordingError, match=r"none\.wav: No such file or directory"):
        read_wav(tmp_path / "none.wav")
    with pytest.raises(RecordingError, match="not a regular file"):
        read_wav(Path("/dev/null"))


@pytest.mark.parametrize("bits", [8, 16, 24, 32])
def test_zero_samples_of_every_wav_width_are_silence(bits: int, tmp_path: Path):
    path = write_wav(tmp_path / "still.wav", bits=bits, data=400 * bits // 8)
    silence = 0x80 if bits == 8 else 0
    path.write_bytes(path.read_bytes()[:44] + bytes([silence]) * (400 * bits // 8))
    sound = read_wav(path)
    assert sound.rate == 8000
    assert len(sound.samples) == 400
    assert not np.any(sound.samples)


@pytest.mark.parametrize("bits", [8, 16, 24, 32])
@pytest.mark.parametrize("block", [1, 3, 1 << 20])
def test_wav_samples_of_every_width_are_scaled_to_one(bits: int, block: int, tmp_path: Path, monkeypatch):
    monkeypatch.setattr(recording, "BLOCK_SIZE", block)
    fractions = [0.5, -0.5, 0.25, -1.0, 0.0]
    width, offset = bits // 8, 128 if bits == 8 else 0
    whole = [round(fraction * 2 ** (bits - 1)) + offset for fraction in fractions]
    data = b"".join(number.to_bytes(width, "little", signed=bits > 8) for number in whole)
    path = write_wav(tmp_path / "steps.wav", bits=bits, data=len(data))
    path.write_bytes(path.read_bytes()[:44] + data)
    np.testing.assert_allclose(read_wav(path).samples, fractions, atol=1e-6)
