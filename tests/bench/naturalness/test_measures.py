import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.bench.naturalness.measures import RATE, count_units, measure_hand, spectral_arc_length

ARM = 0.5
SYNCS = {"start": 0.0, "ready": 1.0, "strokeStart": 1.0, "stroke": 2.0, "strokeEnd": 2.0, "relax": 2.5, "end": 3.5}


def bell(duration, rate=RATE):
    """Speed of a minimum-jerk reach of unit length."""
    share = np.arange(0.0, duration + 0.5 / rate, 1.0 / rate) / duration
    return 30 * (share**2 - 2 * share**3 + share**4) / duration


def reach(share):
    """The minimum-jerk way, 0 to 1."""
    share = np.clip(share, 0.0, 1.0)
    return 10 * share**3 - 15 * share**4 + 6 * share**5


def published_sparc(movement, fs, padlevel=4, fc=10.0, amp_th=0.05):
    """As Balasubramanian et al. (2015) define it, in the words of their paper: a sum over the cut spectrum."""
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


@given(duration=st.floats(0.3, 2.0), scale=st.floats(0.01, 100.0))
def test_a_reach_of_least_jerk_is_one_unit_and_smooth(duration, scale):
    assert count_units(scale * bell(duration)) == 1
    assert -1.6 < spectral_arc_length(scale * bell(duration)) < -1.39


@given(speeds=st.lists(st.floats(0.0, 5.0), min_size=3, max_size=200).filter(any))
def test_the_spectral_arc_length_is_that_of_the_paper(speeds):
    assert spectral_arc_length(np.array(speeds)) == pytest.approx(published_sparc(np.array(speeds), RATE), rel=1e-9)


def test_stops_make_the_spectrum_longer():
    found = [spectral_arc_length(np.concatenate([bell(0.6), np.zeros(6)] * count)) for count in (1, 2, 3, 5)]
    assert found == sorted(found, reverse=True)
    assert spectral_arc_length(np.zeros(50)) is None
    assert spectral_arc_length(np.ones(2)) is None


@given(heights=st.lists(st.floats(0.2, 1.0), min_size=1, max_size=8))
def test_each_bell_is_a_unit(heights):
    assert count_units(np.concatenate([height * bell(0.5) for height in heights])) == len(heights)


@pytest.mark.parametrize(("dip", "count"), [(0.0, 2), (0.45, 2), (0.55, 1), (0.9, 1)])
def test_two_peaks_are_two_units_if_the_speed_falls_below_half_between(dip, count):
    assert count_units(np.array([0.0, 0.5, 1.0, dip, 1.5, 0.5, 0.0])) == count


def test_small_peaks_count_neither_alone_nor_between():
    assert count_units(np.array([0.0, 0.09, 0.0, 1.0, 0.0, 0.09, 0.0])) == 1
    assert count_units(np.array([0.0, 0.11, 0.0, 1.0, 0.0])) == 2
    assert count_units(np.zeros(9)) == 0
    assert count_units(np.array([0.0, 0.6, 0.55, 1.0, 0.55, 0.6, 0.0])) == 1
    assert (
        count_units(np.array([0.0, 0.5, 0.45, 1.0, 0.4, 0.9, 0.0])) == 2
    )  # below half of the higher of two that are one


def test_a_plateau_is_one_peak():
    assert count_units(np.array([0.0, 1.0, 1.0, 1.0, 0.0])) == 1


@pytest.fixture
def gesture():
    """Forth 0.4 m in 1 s, aside 0.2 m in 1 s, held for 0.5 s, and home in 1 s."""
    times = np.arange(0.0, 3.5001, 0.01)
    forth, aside, home = reach(times), reach(times - 1.0), reach(times - 2.5)
    path = np.stack([0.4 * (forth - home), 0.2 * (aside - home), np.zeros_like(times)], axis=1)
    return times, path


def test_each_phase_has_its_speed_and_time(gesture):
    found = measure_hand(*gesture, SYNCS, ARM)
    assert found.duration == 3.5
    assert (found.stroke_time, found.hold_time, found.return_time) == (1.0, 0.5, 1.0)
    assert found.preparation_speed == pytest.approx(1.875 * 0.4 / ARM, rel=1e-3)
    assert found.stroke_speed == pytest.approx(1.875 * 0.2 / ARM, rel=1e-3)
    assert found.return_speed == pytest.approx(1.875 * np.hypot(0.4, 0.2) / ARM, rel=1e-3)
    assert found.largest_speed == found.return_speed
    assert found.stroke_to_preparation == pytest.approx(0.5, rel=1e-3)
    assert found.return_to_preparation == pytest.approx(np.hypot(1.0, 0.5), rel=1e-3)
    assert found.path == pytest.approx(0.6 + np.hypot(0.4, 0.2), rel=1e-3)
    assert found.arm_lengths == pytest.approx(found.path / ARM)
    assert found.stroke_path == pytest.approx(0.2 / ARM, rel=1e-3)
    assert found.units == 3
    assert found.units_per_second == pytest.approx(3 / 3.5)
    assert found.lead == pytest.approx(0.5, abs=0.011)


def test_flow_is_the_speed_at_the_start_of_the_stroke(gesture):
    times, path = gesture
    assert measure_hand(times, path, SYNCS, ARM).flow == pytest.approx(0.0, abs=0.01)
    early = measure_hand(times, path, SYNCS | {"strokeStart": 0.5}, ARM)
    assert early.flow == pytest.approx(1.0, rel=1e-3)
    assert measure_hand(times, path, SYNCS | {"strokeStart": 0.25}, ARM).flow == pytest.approx(
        (0.25**2 * 0.75**2) / 0.5**4, rel=1e-2
    )


def test_without_sync_points_the_whole_is_measured(gesture):
    times, path = gesture
    found = measure_hand(times, path, {"start": 0.0, "end": 3.5}, ARM)
    whole = measure_hand(times, path, SYNCS, ARM)
    assert (found.units, found.sparc, found.path) == (whole.units, whole.sparc, whole.path)
    unknown = ("stroke_time", "hold_time", "return_time", "preparation_speed", "stroke_speed", "return_speed", "flow")
    assert {getattr(found, name) for name in (*unknown, "lead", "preparation_sparc", "stroke_path")} == {None}
    assert found.stroke_to_preparation is found.return_to_preparation is None


def test_what_a_hand_does_in_30_hz_is_what_it_does_in_100(gesture):
    times, path = gesture
    coarse = np.arange(0.0, 3.5001, 1 / RATE)
    thinned = np.stack([np.interp(coarse, times, column) for column in path.T], axis=1)
    fine, found = measure_hand(times, path, SYNCS, ARM), measure_hand(coarse, thinned, SYNCS, ARM)
    assert found.units == fine.units
    assert found.sparc == pytest.approx(fine.sparc, rel=0.02)
    assert found.stroke_speed == pytest.approx(fine.stroke_speed, rel=0.02)
