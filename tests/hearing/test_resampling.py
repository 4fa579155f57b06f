"""Conversion of streamed sound between sample rates."""

import numpy as np
import pytest

from kinesic.hearing.resampling import StreamResampler

NEW_RATE = 16_000  # [Hz] sample rate after resampling
TONE = 440.0  # [Hz] frequency of the test tone


def converted(rate: int, sizes: tuple[int, ...], tone: float = TONE) -> np.ndarray:
    """Resample one second of a tone in pieces.

    The sizes of the pieces repeat.
    """
    sound = np.sin(2 * np.pi * tone * np.arange(rate) / rate).astype(np.float32)
    resampler, parts, begin, number = StreamResampler(rate, NEW_RATE), [], 0, 0
    while begin < len(sound):
        size = sizes[number % len(sizes)]
        parts.append(resampler.feed(sound[begin : begin + size]))
        begin, number = begin + size, number + 1
    return np.concatenate(parts)


@pytest.mark.parametrize("rate", [8_000, 11_025, 16_000, 24_000, 44_100, 48_000])
def test_resampled_tone_keeps_its_pitch_phase_and_amplitude(rate):
    result = converted(rate, (1, 160, 7, 960))
    assert abs(len(result) - NEW_RATE) < 40
    expected = np.sin(2 * np.pi * TONE * np.arange(len(result)) / NEW_RATE)
    assert np.abs(result - expected)[60:-60].max() < 2e-3


def test_resampled_sound_does_not_depend_on_the_number_of_samples_per_call():
    np.testing.assert_allclose(converted(44_100, (441,)), converted(44_100, (1, 3, 1000, 50)), atol=1e-6)


def test_resampling_removes_frequencies_above_half_the_new_rate():
    assert np.abs(converted(48_000, (480,), tone=12_000.0)[200:]).max() < 0.01


@pytest.mark.parametrize("rate", [0, -1, 3_999, 192_001])
def test_sample_rate_outside_the_range_of_microphones_is_refused(rate):
    with pytest.raises(ValueError, match="from 4000 to 192000 Hz"):
        StreamResampler(rate, NEW_RATE)


@pytest.mark.parametrize("rate", [4_000, 192_000])
def test_lowest_and_highest_sample_rate_of_microphones_is_resampled(rate):
    assert 0.98 * NEW_RATE < len(converted(rate, (rate // 10,))) <= NEW_RATE


def test_first_piece_of_a_sound_is_resampled_equally_for_any_size():
    sound = np.sin(2 * np.pi * TONE * np.arange(4000) / 44_100).astype(np.float32)
    whole = StreamResampler(44_100, NEW_RATE).feed(sound)
    for size in range(120):
        resampler = StreamResampler(44_100, NEW_RATE)
        pieces = np.concatenate([resampler.feed(sound[:size]), resampler.feed(sound[size:])])
        np.testing.assert_allclose(pieces, whole, atol=1e-6)
