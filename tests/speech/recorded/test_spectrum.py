import numpy as np
import pytest

from kinesic.body.utterance import Sound
from kinesic.speech.recorded.spectrum import (
    BAND_COUNT,
    CEPSTRUM_SIZE,
    compute_band_powers,
    compute_features,
    compute_levels,
)


def tone(frequency: float, amplitude: float = 0.5, rate: int = 16_000, seconds: float = 0.5) -> Sound:
    return Sound.of(rate, amplitude * np.sin(2 * np.pi * frequency * np.arange(round(rate * seconds)) / rate))


def test_tone_is_loudest_in_the_band_of_its_frequency():
    low, high = (int(compute_band_powers(tone(f))[20].argmax()) for f in (300.0, 3000.0))
    assert low < BAND_COUNT / 3 < BAND_COUNT / 2 < high
    assert int(compute_band_powers(tone(3000.0, rate=44_100))[20].argmax()) == high


def test_level_rises_by_twenty_decibels_with_ten_times_the_amplitude():
    quiet, loud = (compute_levels(compute_band_powers(tone(500.0, a)))[20] for a in (0.05, 0.5))
    assert loud - quiet == pytest.approx(20.0, abs=0.1)


def test_long_sounds_have_the_same_powers_as_their_parts():
    sound = tone(500.0, seconds=60.0)
    whole = compute_band_powers(sound)
    assert len(whole) == 6000
    assert whole[4500] == pytest.approx(compute_band_powers(tone(500.0, seconds=1.0))[50], rel=1e-2, abs=1e-3)


def test_features_are_normalised_over_speech():
    powers = np.random.default_rng(1).uniform(0.1, 1.0, (200, BAND_COUNT))
    is_speech = np.arange(200) >= 50
    features = compute_features(powers, is_speech)
    assert features.shape == (200, 2 * CEPSTRUM_SIZE)
    assert features[is_speech].mean(axis=0) == pytest.approx(0.0, abs=1e-9)
    assert features[is_speech].std(axis=0) == pytest.approx(1.0, abs=1e-4)


def test_sound_shorter_than_a_frame_has_no_powers():
    assert compute_band_powers(Sound.of(16_000, np.zeros(10))).shape == (0, BAND_COUNT)
