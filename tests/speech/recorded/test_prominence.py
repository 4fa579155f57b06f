import numpy as np
import pytest

from kinesic.body.utterance import Phoneme
from kinesic.speech.recorded.prominence import find_prominences, find_prominent_words, move_stress

WORD_SPANS = [(0.3 * k, 0.3 * k + 0.28) for k in range(6)]  # [s] start and end of six words
NATURAL_DURATIONS = [0.28] * 6  # [s] durations of the words in normal speech
FRAME_COUNT = 180  # number of frames of the recording


def measure(levels: dict[int, float], pitch: dict[int, float], natural: list[float] = NATURAL_DURATIONS) -> np.ndarray:
    """Return prominences with changed levels [dB] and pitches [Hz] of single words."""
    level, hertz = np.full(FRAME_COUNT, -20.0), np.full(FRAME_COUNT, 120.0)
    for rows, values in ((level, levels), (hertz, pitch)):
        for word, value in values.items():
            rows[30 * word : 30 * word + 28] = value
    return find_prominences(WORD_SPANS, level, hertz, natural)


@pytest.mark.parametrize(
    ("levels", "pitch", "natural"),
    [
        ({2: -10.0}, {}, NATURAL_DURATIONS),
        ({}, {2: 170.0}, NATURAL_DURATIONS),
        ({}, {}, [0.28, 0.28, 0.12, 0.28, 0.28, 0.28]),
    ],
)
def test_word_that_is_louder_or_higher_in_pitch_or_longer_is_prominent(
    levels: dict[int, float], pitch: dict[int, float], natural: list[float]
):
    prominences = measure(levels, pitch, natural)
    accents = find_prominent_words(WORD_SPANS, prominences, np.ones(6, dtype=bool))
    assert accents.tolist() == [k == 2 for k in range(6)]


def test_equally_loud_words_without_pitch_have_no_prominence_and_no_accent():
    hertz = np.full(FRAME_COUNT, np.nan)
    prominences = find_prominences(WORD_SPANS, np.full(FRAME_COUNT, -20.0), hertz, NATURAL_DURATIONS)
    assert prominences == pytest.approx(0.0)
    assert not find_prominent_words(WORD_SPANS, prominences, np.ones(6, dtype=bool)).any()


def test_word_without_lexical_stress_needs_more_prominence():
    prominences = np.array([0.0, 1.0, 0.0, 0.0, 1.5, 0.0])
    is_stressed = np.array([True, False, True, True, False, True])
    assert find_prominent_words(WORD_SPANS, prominences, is_stressed).tolist() == [
        False,
        False,
        False,
        False,
        True,
        False,
    ]


def test_each_of_two_phrases_has_an_accent():
    words = [(0.0, 0.3), (0.3, 0.6), (1.2, 1.5), (1.5, 1.8)]
    accents = find_prominent_words(words, np.array([0.1, 0.6, 0.5, 0.0]), np.ones(4, dtype=bool))
    assert accents.tolist() == [False, True, True, False]


def test_primary_stress_of_unaccented_words_becomes_secondary_if_another_word_is_accented():
    sounds = (Phoneme("\u02c8a", 0.05, 0.1), Phoneme("\u02c8o", 0.4, 0.1), Phoneme("n", 0.5, 0.05))
    moved = move_stress(sounds, WORD_SPANS[:2], np.array([False, True]))
    assert [sound.symbol for sound in moved] == ["\u02cca", "\u02c8o", "n"]
    assert move_stress(sounds, WORD_SPANS[:2], np.array([False, False])) == sounds


def test_prominence_is_half_the_sum_of_level_pitch_and_length_above_the_mean_of_near_words():
    words = [(0.0, 0.5), (2.0, 2.5), (4.1, 4.6)]  # the second is near both others, which are not near each other
    levels, pitch = np.full(500, -20.0), np.full(500, 100.0)
    levels[200:250], pitch[200:250] = -12.0, 200.0
    natural = [0.5, 0.25, 0.5]
    rise = 8.0 / 4.0 + 12.0 / 2.5 + np.log(2.0) / 0.35
    first, second, third = find_prominences(words, levels, pitch, natural)
    assert (first, third) == pytest.approx((-rise / 4, 0.0))
    assert second == pytest.approx(rise / 4)


def test_level_and_pitch_of_a_word_are_80th_percentiles_over_its_frames():
    levels, pitch = np.full(40, 0.0), np.full(40, 100.0)
    levels[10:20] = 10.0 * np.arange(10)
    pitch[10:20] = 100.0 * 2.0 ** (np.arange(10) / 12.0)
    pitch[15] = np.nan
    first, second = find_prominences([(0.0, 0.1), (0.1, 0.2)], levels, pitch, [0.1, 0.1])
    assert second == pytest.approx((72.0 / 4.0 + np.percentile([0, 1, 2, 3, 4, 6, 7, 8, 9], 80) / 2.5) / 4)
    assert first == pytest.approx(-second)


def test_word_shorter_than_a_frame_uses_one_frame_and_a_minimum_length():
    levels = np.array([0.0, 8.0, 0.0, 0.0])
    words, natural = [(0.0, 0.01), (0.0105, 0.0106), (0.03, 0.03)], [0.01, 0.02, 0.04]
    prominences = find_prominences(words, levels, np.full(4, np.nan), natural)
    mean = np.array([8.0 / 4.0 / 3.0, -np.log(2.0) / 0.35 / 3.0])
    expected = [np.sum([level, length] - mean) / 2 for level, length in ((0, 0), (2, 0), (0, -np.log(2.0) / 0.35))]
    assert prominences == pytest.approx(expected)


def test_words_after_the_end_of_the_recording_have_zero_prominence():
    prominences = find_prominences([(0.0, 0.1), (5.0, 5.1)], np.zeros(10), np.full(10, np.nan), [0.1, 0.1])
    assert prominences == pytest.approx([0.0, 0.0])
    assert find_prominences([], np.zeros(0), np.zeros(0), []).tolist() == []


@pytest.mark.parametrize(
    ("prominence", "stressed", "accented"),
    [(0.7, True, True), (0.69, True, False), (1.4, False, True), (1.39, False, False)],
)
def test_word_is_accented_from_prominence_0_7_if_stressed_or_1_4_if_unstressed(prominence, stressed, accented):
    words = [(0.0, 0.5), (0.5, 1.0), (1.0, 1.5)]
    accents = find_prominent_words(words, np.array([9.0, prominence, 9.0]), np.array([True, stressed, True]))
    assert accents.tolist() == [True, accented, True]


@pytest.mark.parametrize(("start", "accented"), [(0.75, True), (0.74, False)])
def test_new_phrase_begins_after_a_silence_of_0_25_seconds(start, accented):
    words = [(0.0, 0.5), (start, 1.0), (1.0, 1.5)]
    accents = find_prominent_words(words, np.array([2.0, 0.6, 0.0]), np.ones(3, dtype=bool))
    assert accents.tolist() == [True, accented, False]


@pytest.mark.parametrize(("best", "accented"), [(0.31, True), (0.29, False)])
def test_most_prominent_stressed_word_of_a_phrase_is_accented_if_0_15_above_the_mean(best, accented):
    words = [(0.0, 0.5), (0.5, 1.0)]
    assert find_prominent_words(words, np.array([0.0, best]), np.ones(2, dtype=bool)).tolist() == [False, accented]
    assert not find_prominent_words(words, np.array([0.0, best]), np.array([True, False])).any()


@pytest.mark.parametrize(
    ("start", "symbol"), [(0.291, "\u02c8a"), (0.289, "\u02cca"), (0.59, "\u02c8a"), (0.0, "\u02cca")]
)
def test_phoneme_up_to_one_frame_before_an_accented_word_keeps_its_primary_stress(start, symbol):
    (moved,) = move_stress((Phoneme("\u02c8a", start, 0.1),), [(0.1, 0.3), (0.3, 0.6)], np.array([False, True]))
    assert moved.symbol == symbol
