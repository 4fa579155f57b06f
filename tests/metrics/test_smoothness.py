import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.metrics.smoothness import CUTOFF_FREQUENCY, dimensionless_jerk, spectral_arc_length, visible_jerk

SAMPLE_PERIOD = 0.005  # [s] time between two samples


def reach(duration=1.0, length=0.4):
    """Return a straight minimum-jerk reach with rests before and after."""
    s = np.clip((np.arange(0.0, duration + 0.6, SAMPLE_PERIOD) - 0.3) / duration, 0.0, 1.0)
    return np.outer(s**3 * (10 - 15 * s + 6 * s**2), [length, 0.0, 0.0])


def measure_arc_length(path, *, period):
    return spectral_arc_length(np.linalg.norm(np.diff(path, axis=0), axis=1) / period, period=period)


def trembling(path):
    return path + np.outer(0.004 * np.sin(2 * np.pi * 6 * SAMPLE_PERIOD * np.arange(len(path))), [0.0, 0.0, 1.0])


def published_sparc(movement, fs, padlevel=4, fc=10.0, amp_th=0.05):
    """Compute SPARC by the definition of Balasubramanian et al. (2015)."""
    nfft = int(2 ** (np.ceil(np.log2(len(movement))) + padlevel))
    f = np.linspace(0, fs, nfft, endpoint=False)
    mf = np.absolute(np.fft.fft(movement, nfft))
    mf = mf / np.max(mf)
    chosen = [k for k in range(nfft) if f[k] <= fc]
    loud = [k for k in chosen if mf[k] >= amp_th]
    f, mf = f[loud[0] : loud[-1] + 1], mf[loud[0] : loud[-1] + 1]
    total = 0.0
    for k in range(1, len(f)):
        total += np.sqrt(((f[k] - f[k - 1]) / (f[-1] - f[0])) ** 2 + (mf[k] - mf[k - 1]) ** 2)
    return -total


def test_minimum_jerk_reach_has_the_analytic_dimensionless_jerk():
    """720 / 1.875^2 = 204.8, reduced because samples below 5 % of the peak speed are cut off."""
    result = dimensionless_jerk(reach(), period=SAMPLE_PERIOD)
    s = np.linspace(0.0, 1.0, 10001)
    moving = s[30 * s**2 * (1 - s) ** 2 > 0.05 * 1.875]
    assert result == pytest.approx(204.8 * (moving[-1] - moving[0]) ** 3, rel=0.03)


@pytest.mark.parametrize("figure", [dimensionless_jerk, measure_arc_length])
def test_scaled_path_has_the_same_smoothness_and_scaled_time_the_same_dimensionless_jerk(figure):
    path = reach()
    assert figure(10 * path, period=SAMPLE_PERIOD) == pytest.approx(figure(path, period=SAMPLE_PERIOD))
    assert dimensionless_jerk(path, period=2 * SAMPLE_PERIOD) == pytest.approx(
        dimensionless_jerk(path, period=SAMPLE_PERIOD)
    )


def test_minimum_jerk_reach_has_the_published_spectral_arc_length():
    assert measure_arc_length(reach(), period=SAMPLE_PERIOD) == pytest.approx(-1.41, abs=0.02)


@given(speeds=st.lists(st.floats(0.0, 5.0), min_size=3, max_size=200).filter(any))
def test_spectral_arc_length_equals_the_published_definition(speeds):
    assert spectral_arc_length(np.array(speeds), period=1 / 30) == pytest.approx(
        published_sparc(np.array(speeds), 30.0), rel=1e-9
    )


def test_more_stops_make_the_spectral_arc_length_more_negative():
    fractions = np.linspace(0.0, 1.0, 19)
    reach_speeds = fractions**2 * (1.0 - fractions) ** 2
    measured = [
        spectral_arc_length(np.concatenate([reach_speeds, np.zeros(6)] * count), period=1 / 30)
        for count in (1, 2, 3, 5)
    ]
    assert measured == sorted(measured, reverse=True)


def test_spectral_arc_length_needs_motion_and_three_samples():
    assert spectral_arc_length(np.zeros(50), period=1 / 30) is None
    assert spectral_arc_length(np.ones(2), period=1 / 30) is None
    assert spectral_arc_length(np.array([0.0, 1.0, 0.0]), period=1 / 30) is not None


def test_path_with_two_strokes_or_tremor_is_less_smooth_than_a_single_reach():
    once = reach()
    twice = np.concatenate([once, once[-1] + once])
    for figure, sign in ((dimensionless_jerk, 1), (measure_arc_length, -1)):
        smooth, two, rough = (sign * figure(path, period=SAMPLE_PERIOD) for path in (once, twice, trembling(once)))
        assert smooth < two
        assert smooth < rough


@pytest.mark.parametrize("path", [np.zeros((300, 3)), np.zeros((2, 3)), np.zeros((1, 3))])
def test_motionless_path_has_no_smoothness(path):
    assert dimensionless_jerk(path, period=SAMPLE_PERIOD) is None
    assert measure_arc_length(path, period=SAMPLE_PERIOD) is None


def test_visible_jerk_is_low_pass_filtered_with_half_power_at_the_cutoff():
    """The mean square jerk of a sine is half of (amplitude x angular frequency cubed)^2."""
    times = SAMPLE_PERIOD * np.arange(4000)

    def seen(frequency, amplitude):
        path = np.outer(amplitude * np.sin(2 * np.pi * frequency * times), [0.0, 0.6, 0.8])
        return visible_jerk(path, period=SAMPLE_PERIOD) / (0.5 * (amplitude * (2 * np.pi * frequency) ** 3) ** 2)

    assert seen(1.0, 0.2) == pytest.approx(1.0, rel=0.03)
    assert seen(CUTOFF_FREQUENCY, 0.001) == pytest.approx(0.5, rel=0.1)
    assert seen(40.0, 0.0001) < 0.001
