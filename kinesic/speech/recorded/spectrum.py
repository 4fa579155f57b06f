"""Short-time spectra of a sound: powers of mel bands, and cepstral features."""

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.utterance import Sound

FRAME_PERIOD = 0.01  # [s] from one spectrum to the next
WINDOW_DURATION = 0.025  # [s] length of sound in one spectrum
BAND_COUNT = 26  # number of mel bands
LOWEST_FREQUENCY = 80.0  # [Hz] lower edge of the mel bands
HIGHEST_FREQUENCY = 7000.0  # [Hz] upper edge of the mel bands
PRE_EMPHASIS = 0.97  # factor of the preceding sample that is subtracted from each sample
BLOCK_FRAMES = 4096  # frames whose spectra are computed at once
NOISE_PERCENTILE = 5  # percentile of a band's powers that counts as background noise
NOISE_FACTOR = 2.0  # multiple of the noise that is subtracted from a band's power
FLOOR_RATIO = 1e-4  # smallest power of a band / mean power of a band in loud frames
LOUD_PERCENTILE = 95  # percentile of the frames' powers that counts as loud
CEPSTRUM_SIZE = 9  # number of cepstral coefficients
MIN_POWER = 1e-12  # power added to avoid the logarithm of zero
# Orthonormal discrete cosine transform (type II) of log band powers, (`BAND_COUNT`, `CEPSTRUM_SIZE`).
COSINE_MATRIX = np.sqrt(2.0 / BAND_COUNT) * np.cos(
    np.pi / BAND_COUNT * np.outer(np.arange(BAND_COUNT) + 0.5, np.arange(CEPSTRUM_SIZE))
)
COSINE_MATRIX[:, 0] /= np.sqrt(2.0)


def compute_band_powers(sound: Sound) -> Floats:
    """Return the powers (n, `BAND_COUNT`) of mel bands per `FRAME_PERIOD`."""
    window = max(round(WINDOW_DURATION * sound.rate), 2)
    count = int(len(sound.samples) / (FRAME_PERIOD * sound.rate))
    padded = np.concatenate([np.zeros(window // 2 + 1), sound.samples, np.zeros(window + 1)])
    emphasised = padded[1:] - PRE_EMPHASIS * padded[:-1]
    size = 1 << (window - 1).bit_length()
    filters = _make_filters(np.asarray(np.fft.rfftfreq(size, 1.0 / sound.rate), dtype=np.float64), sound.rate / 2)
    taper = np.hanning(window)
    powers = np.zeros((count, BAND_COUNT))
    for first in range(0, count, BLOCK_FRAMES):
        frames = np.arange(first, min(first + BLOCK_FRAMES, count))
        begins = (frames * FRAME_PERIOD * sound.rate).astype(int)
        pieces = emphasised[begins[:, None] + np.arange(window)] * taper
        powers[frames] = np.abs(np.fft.rfft(pieces, size)) ** 2 @ filters
    return powers


def compute_levels(powers: Floats) -> Floats:
    """Return the level [dB] of each frame, shape (n,)."""
    levels: Floats = 10.0 * np.log10(powers.sum(axis=1) + MIN_POWER)
    return levels


def compute_features(powers: Floats, is_speech: Flags) -> Floats:
    """Return cepstra and their slopes, shape (n, 2 `CEPSTRUM_SIZE`).

    Constant noise is subtracted. Over the frames of speech, each feature has mean 0 and deviation 1.

    Args:
        powers: of mel bands, at least one frame.
        is_speech: frames with speech.
    """
    noise = NOISE_FACTOR * np.percentile(powers, NOISE_PERCENTILE, axis=0)
    loud = float(np.percentile(powers.sum(axis=1), LOUD_PERCENTILE)) / BAND_COUNT
    spectrum = np.log(np.maximum(powers - noise, 0.0) + FLOOR_RATIO * loud + MIN_POWER)
    cepstra = spectrum @ COSINE_MATRIX
    around = np.pad(cepstra, ((2, 2), (0, 0)), mode="edge")
    slopes = around[3:-1] - around[1:-3] + 2.0 * (around[4:] - around[:-4])
    features = np.concatenate([cepstra, slopes], axis=1)
    spoken = features[is_speech] if is_speech.any() else features
    normalised: Floats = (features - spoken.mean(axis=0)) / (spoken.std(axis=0) + 1e-6)
    return normalised


def _make_filters(frequencies: Floats, highest: float) -> Floats:
    """Return triangular mel filters, shape (frequencies, `BAND_COUNT`)."""
    edges = _to_mel(np.array([LOWEST_FREQUENCY, min(HIGHEST_FREQUENCY, highest)]))
    centres, step = np.linspace(edges[0], edges[1], BAND_COUNT + 2, retstep=True)
    scale = _to_mel(frequencies)[:, None]
    filters: Floats = np.maximum(0.0, np.minimum((scale - centres[:-2]) / step, (centres[2:] - scale) / step))
    return filters


def _to_mel(frequencies: Floats) -> Floats:
    mel: Floats = 1127.0 * np.log1p(frequencies / 700.0)
    return mel
