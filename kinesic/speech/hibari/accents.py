"""Pitch accents: stressed vowels on which the pitch has a peak."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kinesic.body.utterance import STRESS_MARKS, VOWEL_LETTERS, Phoneme
from kinesic.speech.hibari.model import FRAME_DURATION, Floats32

MIN_VOICED_PITCH = 60.0  # [Hz] lower values are unvoiced
MIN_PROMINENCE = 1.5  # [semitones] smallest height of a pitch peak above the higher of its neighbouring valleys
PEAK_MARGIN = (0.06, 0.10)  # [s] before and after a vowel in which the vowel's pitch peak may lie


def find_pitch_accents(pitch: Floats32, phonemes: Sequence[Phoneme]) -> tuple[float, ...]:
    """Return times [s] of prominent pitch peaks on stressed vowels.

    Args:
        pitch: (frames,) [Hz], near 0 where unvoiced.
        phonemes: sounds of the phrase in order.
    """
    voiced = np.flatnonzero(pitch > MIN_VOICED_PITCH)
    if len(voiced) < 2:
        return ()
    frames = np.arange(voiced[0], voiced[-1] + 1)
    semitones = 12.0 * np.log2(np.interp(frames, voiced, pitch[voiced]))
    peaks, prominences = _find_peaks(semitones)
    times = (frames[peaks] + 0.5) * FRAME_DURATION
    accents: list[float] = []
    for vowel in (phoneme for phoneme in phonemes if _is_stressed(phoneme)):
        inside = np.flatnonzero((times > vowel.start - PEAK_MARGIN[0]) & (times < vowel.end + PEAK_MARGIN[1]))
        if len(inside):
            highest = inside[prominences[inside].argmax()]
            if not accents or times[highest] > accents[-1]:
                accents.append(float(times[highest]))
    return tuple(accents)


def _find_peaks(semitones: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the indices of pitch peaks and their prominences [semitones].

    The pitch falls to its minimum before the first and after the last frame.
    """
    padded = np.concatenate([[semitones.min()], semitones, [semitones.min()]])
    peaks: list[int] = []
    prominences: list[float] = []
    for index in np.flatnonzero((padded[1:-1] > padded[:-2]) & (padded[1:-1] >= padded[2:])) + 1:
        higher = np.flatnonzero(padded > padded[index])
        first = int(higher[higher < index].max(initial=-1)) + 1
        last = int(higher[higher > index].min(initial=len(padded)))
        prominence = float(padded[index] - max(padded[first:index].min(), padded[index + 1 : last].min()))
        if prominence >= MIN_PROMINENCE:
            peaks.append(int(index) - 1)
            prominences.append(prominence)
    return np.array(peaks, dtype=np.int64), np.array(prominences)


def _is_stressed(phoneme: Phoneme) -> bool:
    symbol = phoneme.symbol
    return symbol.startswith(STRESS_MARKS[0]) and symbol[1:2].lower() in VOWEL_LETTERS
