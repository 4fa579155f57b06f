import numpy as np
import pytest

from kinesic.body.utterance import Sound
from kinesic.speech.recorded.spectrum import (
    BAND_COUNT,
    CEPSTRUM_SIZE,
    _make_filters,
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


def test_sound_level_rises_by_twenty_decibels_with_ten_times_the_amplitude():
    quiet, loud = (compute_levels(compute_band_powers(tone(500.0, a)))[20] for a in (0.05, 0.5))
    assert loud - quiet == pytest.approx(20.0, abs=0.1)


def test_long_sound_has_the_same_band_powers_as_a_short_one_of_the_same_tone():
    sound = tone(500.0, seconds=60.0)
    whole = compute_band_powers(sound)
    assert len(whole) == 6000
    assert whole[4500] == pytest.approx(compute_band_powers(tone(500.0, seconds=1.0))[50], rel=1e-2, abs=1e-3)


def test_spectral_features_are_normalised_over_speech():
    powers = np.random.default_rng(1).uniform(0.1, 1.0, (200, BAND_COUNT))
    is_speech = np.arange(200) >= 50
    features = compute_features(powers, is_speech)
    assert features.shape == (200, 2 * CEPSTRUM_SIZE)
    assert features[is_speech].mean(axis=0) == pytest.approx(0.0, abs=1e-9)
    assert features[is_speech].std(axis=0) == pytest.approx(1.0, abs=1e-4)


def test_sound_shorter_than_a_frame_has_no_band_powers():
    assert compute_band_powers(Sound.of(16_000, np.zeros(10))).shape == (0, BAND_COUNT)


def mel(frequency: float) -> float:
    """Return the pitch of a frequency [Hz] by O'Shaughnessy's formula."""
    return 1127.0 * float(np.log(1.0 + frequency / 700.0))


@pytest.mark.parametrize(("highest", "edge"), [(8000.0, 7000.0), (4000.0, 4000.0)])
def test_band_filters_are_triangles_of_equal_mel_width_from_80_hz_to_7000_hz_or_nyquist(highest: float, edge: float):
    frequencies = np.linspace(0.0, highest, 4001)
    filters = _make_filters(frequencies, highest)
    step = (mel(edge) - mel(80.0)) / 27
    for band in (0, 12, 25):
        centre = mel(80.0) + (band + 1) * step
        expected = [max(0.0, 1.0 - abs(mel(frequency) - centre) / step) for frequency in frequencies]
        np.testing.assert_allclose(filters[:, band], expected, atol=1e-9)
    assert filters.shape == (4001, 26)


@pytest.mark.parametrize("rate", [8000, 16_000, 22_050])
def test_band_powers_come_from_25_ms_windows_around_each_frame(rate: int):
    samples = np.random.default_rng(4).normal(0.0, 0.1, rate // 10)
    powers = compute_band_powers(Sound.of(rate, samples))
    assert powers.shape == (10, 26)
    width = round(0.025 * rate)
    size = 256 if rate == 8000 else 512 if rate == 16_000 else 1024
    filters = _make_filters(np.fft.rfftfreq(size, 1.0 / rate), rate / 2)
    for frame in (0, 4, 9):
        begin = int(frame * 0.01 * rate) - width // 2
        places = np.arange(begin, begin + width)
        current, previous = (
            np.array([samples[k] if 0 <= k < len(samples) else 0.0 for k in places + shift]) for shift in (0, -1)
        )
        spectrum = np.fft.rfft((current - 0.97 * previous) * np.hanning(width), size)
        np.testing.assert_allclose(powers[frame], np.abs(spectrum) ** 2 @ filters, rtol=1e-5, atol=1e-9)


def test_level_of_silence_is_120_decibels_below_unit_power():
    levels = compute_levels(np.array([[0.0, 0.0], [0.25, 0.75], [50.0, 50.0]]))
    assert levels == pytest.approx([-120.0, 0.0, 20.0], abs=1e-9)


@pytest.mark.parametrize("has_speech", [True, False])
def test_spectral_features_of_a_sound_are_cepstra_above_the_noise_and_their_regression_slopes(has_speech: bool):
    powers = np.random.default_rng(5).gamma(0.5, 1.0, (60, BAND_COUNT))
    is_speech = (np.arange(60) >= 20) & has_speech
    noise = 2.0 * np.percentile(powers, 5, axis=0)
    loud = np.percentile(powers.sum(axis=1), 95) / 26
    log = np.log(np.maximum(powers - noise, 0.0) + 1e-4 * loud + 1e-12)
    angles = np.pi / 26 * (np.arange(26) + 0.5)[:, None] * np.arange(9)
    cepstra = np.sqrt(2 / 26) * (log @ np.cos(angles)) * np.where(np.arange(9) == 0, np.sqrt(0.5), 1.0)
    rows = [np.clip(np.arange(60) + shift, 0, 59) for shift in (-2, -1, 1, 2)]
    before2, before1, after1, after2 = (cepstra[row] for row in rows)
    raw = np.concatenate([cepstra, after1 - before1 + 2.0 * (after2 - before2)], axis=1)
    spoken = raw[20:] if has_speech else raw
    expected = (raw - spoken.mean(axis=0)) / (spoken.std(axis=0) + 1e-6)
    np.testing.assert_allclose(compute_features(powers, is_speech), expected, rtol=1e-6, atol=1e-9)
