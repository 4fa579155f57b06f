"""Loudness and stressed syllables of streamed speech."""

import numpy as np
import pytest

from kinesic.speech.loudness import LoudnessMeter, find_stressed_syllables

RATE = 44_100


def tone(frequency: float, duration: float = 0.5) -> np.ndarray:
    return np.sin(2 * np.pi * frequency * np.arange(round(duration * RATE)) / RATE).astype(np.float32)


def levels_of(*pieces: np.ndarray) -> np.ndarray:
    meter = LoudnessMeter(RATE)
    for piece in pieces:
        meter.feed(piece)
    return meter.levels


def bumps(*centres: float, duration: float = 4.0, heights: tuple[float, ...] = ()) -> np.ndarray:
    times = np.arange(round(duration * 100)) / 100
    return sum(
        height * np.exp(-(((times - centre) / 0.05) ** 2))
        for centre, height in zip(centres, heights or len(centres) * (0.1,), strict=True)
    )


def test_level_is_high_for_sound_in_the_speech_band_and_low_outside():
    inside, low, high = (levels_of(tone(frequency))[10:-10].mean() for frequency in (1000.0, 100.0, 6000.0))
    assert inside > 0.3
    assert max(low, high) < 0.02 * inside


def test_levels_do_not_depend_on_the_division_of_a_stream():
    sound = tone(700.0) * np.linspace(0.0, 1.0, 22_050, dtype=np.float32)
    whole, divided = levels_of(sound), levels_of(sound[:100], sound[100:9000], sound[9000:])
    np.testing.assert_allclose(whole, divided, atol=1e-6)
    assert len(whole) == pytest.approx(50, abs=1)


def test_peaks_are_the_loudest_syllables_of_their_surroundings():
    levels = bumps(0.5, 0.7, 1.5, 2.5, heights=(0.1, 0.06, 0.08, 0.02))
    assert find_stressed_syllables(levels, 0) == [50, 150]
    assert find_stressed_syllables(levels, 51) == [150]


def test_peak_is_found_only_after_its_surroundings_are_complete():
    levels = bumps(1.0, duration=1.5)
    assert find_stressed_syllables(levels[:125], 0) == []
    assert find_stressed_syllables(levels[:135], 0) == [100]


def test_soft_noise_has_no_peaks():
    assert find_stressed_syllables(bumps(1.0, heights=(0.001,)), 0) == []
