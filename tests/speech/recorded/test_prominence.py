import numpy as np
import pytest

from kinesic.body.utterance import Phoneme
from kinesic.speech.recorded.prominence import find_accents, find_prominences, move_stress

WORDS = [(0.3 * k, 0.3 * k + 0.28) for k in range(6)]
NATURAL = [0.28] * 6
COUNT = 180


def measure(levels: dict[int, float], pitch: dict[int, float], natural: list[float] = NATURAL) -> np.ndarray:
    """Return prominences with changed levels [dB] and pitches [Hz] of single words."""
    level, hertz = np.full(COUNT, -20.0), np.full(COUNT, 120.0)
    for rows, values in ((level, levels), (hertz, pitch)):
        for word, value in values.items():
            rows[30 * word : 30 * word + 28] = value
    return find_prominences(WORDS, level, hertz, natural)


@pytest.mark.parametrize(
    ("levels", "pitch", "natural"),
    [({2: -10.0}, {}, NATURAL), ({}, {2: 170.0}, NATURAL), ({}, {}, [0.28, 0.28, 0.12, 0.28, 0.28, 0.28])],
)
def test_louder_higher_or_longer_word_is_prominent(
    levels: dict[int, float], pitch: dict[int, float], natural: list[float]
):
    prominences = measure(levels, pitch, natural)
    accents = find_accents(WORDS, prominences, np.ones(6, dtype=bool))
    assert accents.tolist() == [k == 2 for k in range(6)]


def test_even_words_have_no_accent_and_voiceless_frames_count_nothing():
    hertz = np.full(COUNT, np.nan)
    prominences = find_prominences(WORDS, np.full(COUNT, -20.0), hertz, NATURAL)
    assert prominences == pytest.approx(0.0)
    assert not find_accents(WORDS, prominences, np.ones(6, dtype=bool)).any()


def test_word_without_lexical_stress_needs_more_prominence():
    prominences = np.array([0.0, 1.0, 0.0, 0.0, 1.5, 0.0])
    is_stressed = np.array([True, False, True, True, False, True])
    assert find_accents(WORDS, prominences, is_stressed).tolist() == [False, False, False, False, True, False]


def test_each_phrase_has_an_accent():
    words = [(0.0, 0.3), (0.3, 0.6), (1.2, 1.5), (1.5, 1.8)]
    accents = find_accents(words, np.array([0.1, 0.6, 0.5, 0.0]), np.ones(4, dtype=bool))
    assert accents.tolist() == [False, True, True, False]


def test_stress_stays_in_accented_words_alone():
    sounds = (Phoneme("\u02c8a", 0.05, 0.1), Phoneme("\u02c8o", 0.4, 0.1), Phoneme("n", 0.5, 0.05))
    moved = move_stress(sounds, WORDS[:2], np.array([False, True]))
    assert [sound.symbol for sound in moved] == ["\u02cca", "\u02c8o", "n"]
    assert move_stress(sounds, WORDS[:2], np.array([False, False])) == sounds
