import numpy as np
import pytest
from scipy.fft import dct
from scipy.ndimage import uniform_filter1d
from scipy.signal import find_peaks as scipy_find_peaks

from kinesic.speech.recorded.peaks import average_frames, find_peaks
from kinesic.speech.recorded.spectrum import BAND_COUNT, CEPSTRUM_SIZE, COSINE_MATRIX


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("distance", [1, 6, 12])
@pytest.mark.parametrize("digits", [0, 6])
def test_peaks_of_random_sound_levels_match_scipy(seed, distance, digits):
    """Include levels rounded to integers, with plateaus and equal peaks."""
    random = np.random.default_rng(seed)
    levels = np.round(np.cumsum(random.normal(size=300)), digits)
    if digits == 0 and distance > 1:
        levels += 1e-6 * random.normal(size=300)  # the order of equal peaks is arbitrary
    expected, _ = scipy_find_peaks(levels, prominence=2.0, distance=distance)
    np.testing.assert_array_equal(find_peaks(levels, prominence=2.0, distance=distance), expected)


@pytest.mark.parametrize("levels", [np.zeros(5), np.arange(5.0), np.zeros(1), np.array([1.0, 0.0, 1.0])])
def test_sound_levels_without_inner_maximum_have_no_peak(levels):
    assert not len(find_peaks(levels, prominence=0.0))


@pytest.mark.parametrize("shape", [(3,), (40,), (40, 3)])
def test_moving_mean_of_frames_matches_scipy(shape):
    values = np.random.default_rng(1).normal(size=shape)
    np.testing.assert_allclose(average_frames(values, 5), uniform_filter1d(values, 5, axis=0), atol=1e-14)


def test_cosine_matrix_matches_the_orthonormal_dct_of_scipy():
    spectrum = np.random.default_rng(2).normal(size=(4, BAND_COUNT))
    expected = dct(spectrum, axis=1, norm="ortho")[:, :CEPSTRUM_SIZE]
    np.testing.assert_allclose(spectrum @ COSINE_MATRIX, expected, atol=1e-13)
