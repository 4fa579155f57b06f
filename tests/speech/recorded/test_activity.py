import numpy as np
import pytest

from kinesic.speech.recorded.activity import find_runs, find_speech


def levels(*parts: tuple[int, float]) -> np.ndarray:
    return np.concatenate([np.full(count, level) for count, level in parts])


@pytest.mark.parametrize("noise", [-90.0, -40.0, -20.0])
def test_speech_is_found_in_noise_of_three_different_levels(noise: float):
    is_speech = find_speech(levels((50, noise), (100, 0.0), (60, noise), (100, -5.0), (50, noise)))
    assert find_runs(is_speech) == [(50, 150), (210, 310)]


def test_short_silences_belong_to_speech_and_clicks_do_not():
    is_speech = find_speech(levels((50, -60.0), (3, 0.0), (50, -60.0), (50, 0.0), (10, -60.0), (50, 0.0), (30, -60.0)))
    assert find_runs(is_speech) == [(103, 213)]


def test_silent_recording_has_no_speech_and_a_steady_one_is_all_speech():
    assert not find_speech(np.full(100, -90.0)).any()
    assert find_speech(np.full(100, 10.0)).all()
    assert find_speech(np.zeros(0)).shape == (0,)
