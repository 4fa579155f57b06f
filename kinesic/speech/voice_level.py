"""Lip openings of a synthetic voice by the level of its vowels."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinesic.body.utterance import STRESS_MARKS, VOWEL_LETTERS, Phoneme, Sound

OPENING_SLOPE = 0.03  # [1/dB] change of the lip opening with the level
OPENING_RANGE = (0.6, 1.3)  # relative lip opening of the quietest and loudest sounds
MIN_SQUARE = 1e-9  # squared amplitude added to avoid the logarithm of zero
OPENING_DIGITS = 3  # decimals of a lip opening


def open_vowels_by_level(phonemes: Sequence[Phoneme], sound: Sound) -> tuple[Phoneme, ...]:
    """Return the sounds of an utterance with wider lips on loud vowels.

    The median vowel has opening 1. Other sounds are unchanged.

    Args:
        phonemes: sounds in order.
        sound: of the same utterance.
    """
    energy = np.concatenate([[0.0], np.cumsum(np.square(sound.samples, dtype=np.float64))])
    vowels = [k for k, phoneme in enumerate(phonemes) if _is_vowel(phoneme)]
    if not vowels:
        return tuple(phonemes)
    begins = np.array([[phonemes[k].start, phonemes[k].end] for k in vowels]) * sound.rate
    first, last = np.clip(begins.astype(np.intp), 0, len(sound.samples)).T
    levels = 10.0 * np.log10((energy[last] - energy[first]) / np.maximum(last - first, 1) + MIN_SQUARE)
    openings = np.clip(1.0 + OPENING_SLOPE * (levels - np.median(levels)), *OPENING_RANGE)
    opening_of = dict(zip(vowels, np.round(openings, OPENING_DIGITS).tolist(), strict=True))
    return tuple(
        replace(phoneme, opening=opening_of[k]) if k in opening_of else phoneme for k, phoneme in enumerate(phonemes)
    )


def _is_vowel(phoneme: Phoneme) -> bool:
    return phoneme.symbol.lstrip("".join(STRESS_MARKS))[:1].lower() in VOWEL_LETTERS
