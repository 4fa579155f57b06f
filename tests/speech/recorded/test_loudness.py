import numpy as np
import pytest

from kinesic.body.utterance import Sound
from kinesic.speech.recorded.loudness import OPENING_RANGE, compute_openings, estimate_pitch

SAMPLE_RATE = 16_000  # [Hz]


def buzz(pitch: float) -> np.ndarray:
    """Return one second of a voice-like sound with harmonics."""
    times = np.arange(SAMPLE_RATE) / SAMPLE_RATE
    return sum(np.sin(2 * np.pi * k * pitch * times) / k for k in range(1, 8)) * 0.2


@pytest.mark.parametrize("pitch", [80.0, 120.0, 220.0, 400.0])
def test_pitch_of_voices_is_estimated_in_noise(pitch: float):
    samples = buzz(pitch) + np.random.default_rng(1).normal(0.0, 0.02, SAMPLE_RATE)
    estimate = estimate_pitch(Sound.of(SAMPLE_RATE, samples))[5:-5]
    assert np.nanmedian(estimate) == pytest.approx(pitch, rel=0.03)
    assert np.isnan(estimate).mean() < 0.1


def test_noise_and_silence_have_no_pitch():
    noise = np.random.default_rng(2).normal(0.0, 0.1, SAMPLE_RATE)
    assert np.isnan(estimate_pitch(Sound.of(SAMPLE_RATE, noise))).mean() > 0.95
    assert np.isnan(estimate_pitch(Sound.of(SAMPLE_RATE, np.zeros(SAMPLE_RATE)))).all()


def test_lip_openings_increase_with_the_sound_level_within_their_range():
    openings = compute_openings(np.array([-60.0, -25.0, -20.0, -15.0, 20.0]), np.ones(5, dtype=bool))
    assert openings[[0, 2, 4]] == pytest.approx([OPENING_RANGE[0], 1.0, OPENING_RANGE[1]])
    assert np.all(np.diff(openings) > 0.0)
