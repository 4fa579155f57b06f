"""Loudness and pitch of recorded speech."""

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.utterance import Sound
from kinesic.speech.recorded.spectrum import FRAME_PERIOD
from kinesic.speech.voice_level import OPENING_RANGE, OPENING_SLOPE

PITCH_WINDOW = 0.04  # [s] length of sound in one pitch estimate
LOWEST_PITCH = 60.0  # [Hz] lowest pitch of a voice
HIGHEST_PITCH = 450.0  # [Hz] highest pitch of a voice
MIN_PERIODICITY = 0.5  # normalised autocorrelation above which a frame is voiced
OCTAVE_COST = 0.01  # normalised autocorrelation by which a period twice as long must be better, to avoid octave errors
BLOCK_FRAMES = 4096  # frames whose pitch is estimated at once
MIN_ENERGY = 1e-9  # energy added to avoid division by zero


def estimate_pitch(sound: Sound) -> Floats:
    """Return the pitch (n,) [Hz] of each frame, NaN without voice.

    A frame's pitch is the best lag of its autocorrelation.
    """
    window = round(PITCH_WINDOW * sound.rate)
    count = int(len(sound.samples) / (FRAME_PERIOD * sound.rate))
    padded = np.concatenate([np.zeros(window // 2), sound.samples, np.zeros(window)])
    shortest, longest = int(sound.rate / HIGHEST_PITCH), min(int(sound.rate / LOWEST_PITCH), window - 1)
    size = 1 << (2 * window - 1).bit_length()
    taper = np.hanning(window)
    weights = np.fft.irfft(np.abs(np.fft.rfft(taper, size)) ** 2, size)[: longest + 1]
    lags = np.arange(shortest, longest + 1)
    pitch = np.full(count, np.nan)
    for first in range(0, count, BLOCK_FRAMES):
        frames = np.arange(first, min(first + BLOCK_FRAMES, count))
        begins = (frames * FRAME_PERIOD * sound.rate).astype(int)
        pieces = padded[begins[:, None] + np.arange(window)]
        pieces = (pieces - pieces.mean(axis=1, keepdims=True)) * taper
        correlations = np.fft.irfft(np.abs(np.fft.rfft(pieces, size)) ** 2, size)[:, : longest + 1]
        periodicity = correlations / (correlations[:, :1] + MIN_ENERGY) * (weights[0] / np.maximum(weights, MIN_ENERGY))
        scores = periodicity[:, shortest:] - OCTAVE_COST * np.log2(lags / shortest)
        best = np.argmax(scores, axis=1)
        is_voiced = periodicity[np.arange(len(frames)), shortest + best] > MIN_PERIODICITY
        pitch[frames[is_voiced]] = sound.rate / lags[best[is_voiced]]
    return pitch


def compute_openings(levels: Floats, is_speech: Flags) -> Floats:
    """Return the relative lip opening (n,) from the level [dB].

    The median level of speech has opening 1.
    """
    middle = float(np.median(levels[is_speech])) if is_speech.any() else 0.0
    openings: Floats = np.clip(1.0 + OPENING_SLOPE * (levels - middle), *OPENING_RANGE)
    return openings
