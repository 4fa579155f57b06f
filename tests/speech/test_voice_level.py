import numpy as np

from kinesic.body.utterance import Phoneme, Sound
from kinesic.speech.voice_level import OPENING_RANGE, open_vowels_by_level

SAMPLE_RATE = 8000  # [Hz]


def tones(*amplitudes):
    """Return successive tones of 0.2 s with the given amplitudes."""
    return Sound.of(SAMPLE_RATE, np.concatenate([a * np.sin(np.arange(SAMPLE_RATE // 5)) for a in amplitudes]))


def openings(symbols, sound):
    phonemes = [Phoneme(symbol, 0.2 * k, 0.2) for k, symbol in enumerate(symbols)]
    return [phoneme.opening for phoneme in open_vowels_by_level(phonemes, sound)]


def test_loud_vowels_open_the_lips_further_than_quiet_ones():
    quiet, middle, loud = openings(["a", "\u02c8a", "a"], tones(0.1, 0.2, 0.4))
    assert quiet < middle == 1.0 < loud
    np.testing.assert_allclose([1.0 - quiet, loud - 1.0], 0.03 * 20 * np.log10(2), atol=1e-3)


def test_consonants_and_speech_without_vowels_keep_their_lip_opening():
    assert openings(["s", "a", "m"], tones(0.01, 0.2, 0.9)) == [1.0, 1.0, 1.0]
    assert openings(["s"], tones(0.5)) == [1.0]


def test_lip_openings_stay_in_their_range_also_for_silent_vowels():
    assert openings(["a", "a", "a"], tones(0.0, 0.01, 1.0)) == [OPENING_RANGE[0], 1.0, OPENING_RANGE[1]]
    assert openings(["a", "a"], Sound.of(SAMPLE_RATE, np.zeros(0))) == [1.0, 1.0]
