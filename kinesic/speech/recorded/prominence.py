"""Accents of recorded speech, from loudness, pitch and length of words."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.utterance import STRESS_MARKS, Phoneme
from kinesic.speech.recorded.spectrum import FRAME_PERIOD

CONTEXT_TIME = 2.0  # [s] time before and after a word to which it is compared
LEVEL_UNIT = 4.0  # [dB] rise of the level that adds 0.5 to the prominence
PITCH_UNIT = 2.5  # [semitones] rise of the pitch that adds 0.5 to the prominence
LENGTH_UNIT = 0.35  # log duration ratio that adds 0.5 to the prominence
MIN_PROMINENCE = 0.7  # prominence from which a stressed word carries an accent; unstressed words need twice as much
PHRASE_GAP = 0.25  # [s] silence after which a new phrase begins
PEAK_PERCENTILE = 80  # percentile of the frames of a word that counts as its level and pitch
MIN_RISE = 0.15  # smallest prominence above the phrase mean of the only accent of a phrase


def find_prominences(
    words: Sequence[tuple[float, float]], levels: Floats, pitch: Floats, natural: Sequence[float]
) -> Floats:
    """Return the prominence of each word relative to neighbouring words, shape (words,).

    Args:
        words: start and end of each word [s].
        levels: level of each frame [dB].
        pitch: of each frame [Hz], NaN without voice.
        natural: duration of each word in a neutral rendition [s].
    """
    if not words:
        return np.zeros(0)
    times = np.array(words)
    semitones = 12.0 * np.log2(pitch)
    peaks = np.array([_peaks(levels, semitones, word) for word in words])
    stretch = np.log(np.maximum(times[:, 1] - times[:, 0], 0.02) / np.maximum(np.array(natural), 0.02))
    measures = np.column_stack([peaks[:, 0] / LEVEL_UNIT, peaks[:, 1] / PITCH_UNIT, stretch / LENGTH_UNIT])
    middles = times.mean(axis=1)
    result = np.zeros(len(words))
    for k, middle in enumerate(middles):
        near = np.abs(middles - middle) <= CONTEXT_TIME
        above = measures[k] - _mean(measures[near])
        result[k] = float(np.nansum(above)) / 2.0
    return result


def find_prominent_words(words: Sequence[tuple[float, float]], prominences: Floats, is_stressed: Flags) -> Flags:
    """Return the mask of accented words, shape (words,).

    A phrase without an accent gets one on its most prominent stressed word, if that exceeds the mean prominence of the
    phrase by `MIN_RISE`.

    Args:
        words: start and end of each word [s].
        prominences: of each word.
        is_stressed: words that a neutral voice stresses; others need twice the prominence.
    """
    needed = np.where(is_stressed, MIN_PROMINENCE, 2.0 * MIN_PROMINENCE)
    accents: Flags = prominences >= needed
    begin = 0
    for k in range(1, len(words) + 1):
        if k == len(words) or words[k][0] - words[k - 1][1] >= PHRASE_GAP:
            phrase = slice(begin, k)
            candidates = np.where(is_stressed[phrase], prominences[phrase], -np.inf)
            best = int(np.argmax(candidates))
            if not accents[phrase].any() and candidates[best] - prominences[phrase].mean() >= MIN_RISE:
                accents[begin + best] = True
            begin = k
    return accents


def move_stress(
    phonemes: Sequence[Phoneme], words: Sequence[tuple[float, float]], accents: Flags
) -> tuple[Phoneme, ...]:
    """Return sounds with primary stress only in accented words.

    Elsewhere primary stress becomes secondary. Without any accent, the sounds stay unchanged.
    """
    if not accents.any():
        return tuple(phonemes)
    starts = [start for start, _ in words]
    moved: list[Phoneme] = []
    for sound in phonemes:
        word = int(np.searchsorted(starts, sound.start + FRAME_PERIOD)) - 1
        if sound.symbol.startswith(STRESS_MARKS[0]) and not (word >= 0 and accents[word]):
            sound = replace(sound, symbol=STRESS_MARKS[1] + sound.symbol[1:])  # noqa: PLW2901 - a weaker copy
        moved.append(sound)
    return tuple(moved)


def _peaks(levels: Floats, semitones: Floats, word: tuple[float, float]) -> tuple[float, float]:
    """Return peak level [dB] and pitch [semitones] of a word."""
    frames = slice(int(word[0] / FRAME_PERIOD), max(int(word[1] / FRAME_PERIOD), int(word[0] / FRAME_PERIOD) + 1))
    voiced = semitones[frames][~np.isnan(semitones[frames])]
    level = float(np.percentile(levels[frames], PEAK_PERCENTILE)) if len(levels[frames]) else np.nan
    return level, float(np.percentile(voiced, PEAK_PERCENTILE)) if len(voiced) else np.nan


def _mean(measures: Floats) -> Floats:
    """Return the mean of each column without NaN, 0 without numbers."""
    is_number = ~np.isnan(measures)
    counts = np.maximum(is_number.sum(axis=0), 1)
    mean: Floats = np.where(is_number, measures, 0.0).sum(axis=0) / counts
    return mean
