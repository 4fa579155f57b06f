import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.bench.naturalness.measures import PROFILE_PERIOD, PROFILE_RATE, count_units, measure_hand
from kinesic.metrics.smoothness import spectral_arc_length

ARM_LENGTH = 0.5  # [m] arm length
SYNC_TIMES = {"start": 0.0, "ready": 1.0, "strokeStart": 1.0, "stroke": 2.0, "strokeEnd": 2.0, "relax": 2.5, "end": 3.5}


def bell_profile(duration, rate=PROFILE_RATE):
    """Return the speed profile of a minimum-jerk reach of unit length."""
    fractions = np.arange(0.0, duration + 0.5 / rate, 1.0 / rate) / duration
    return 30 * (fractions**2 - 2 * fractions**3 + fractions**4) / duration


def reach_path(fraction):
    """Return the minimum-jerk path from 0 to 1."""
    fraction = np.clip(fraction, 0.0, 1.0)
    return 10 * fraction**3 - 15 * fraction**4 + 6 * fraction**5


@given(duration=st.floats(0.3, 2.0), scale=st.floats(0.01, 100.0))
def test_minimum_jerk_reach_is_one_smooth_movement_unit(duration, scale):
    assert count_units(scale * bell_profile(duration)) == 1
    assert -1.6 < spectral_arc_length(scale * bell_profile(duration), period=PROFILE_PERIOD) < -1.39


@given(heights=st.lists(st.floats(0.2, 1.0), min_size=1, max_size=8))
def test_each_bell_shaped_speed_peak_is_a_movement_unit(heights):
    assert count_units(np.concatenate([height * bell_profile(0.5) for height in heights])) == len(heights)


@pytest.mark.parametrize(("dip", "count"), [(0.0, 2), (0.45, 2), (0.55, 1), (0.9, 1)])
def test_speed_peaks_are_separate_movement_units_if_speed_halves_between_them(dip, count):
    assert count_units(np.array([0.0, 0.5, 1.0, dip, 1.5, 0.5, 0.0])) == count


def test_speed_peaks_below_a_tenth_of_the_maximum_are_no_movement_units():
    assert count_units(np.array([0.0, 0.09, 0.0, 1.0, 0.0, 0.09, 0.0])) == 1
    assert count_units(np.array([0.0, 0.11, 0.0, 1.0, 0.0])) == 2
    assert count_units(np.zeros(9)) == 0
    assert count_units(np.array([0.0, 0.6, 0.55, 1.0, 0.55, 0.6, 0.0])) == 1
    assert (
        count_units(np.array([0.0, 0.5, 0.45, 1.0, 0.4, 0.9, 0.0])) == 2
    )  # falls below half of the higher of two peaks that count as one


def test_speed_plateau_is_one_movement_unit():
    assert count_units(np.array([0.0, 1.0, 1.0, 1.0, 0.0])) == 1


@pytest.fixture
def gesture():
    """Return times and path: 0.4 m forward, 0.2 m sideways, hold, return."""
    times = np.arange(0.0, 3.5001, 0.01)
    forth, sideways, home = reach_path(times), reach_path(times - 1.0), reach_path(times - 2.5)
    path = np.stack([0.4 * (forth - home), 0.2 * (sideways - home), np.zeros_like(times)], axis=1)
    return times, path


def test_speed_and_duration_of_each_gesture_phase_are_measured(gesture):
    measured = measure_hand(*gesture, SYNC_TIMES, ARM_LENGTH)
    assert measured.duration == 3.5
    assert (measured.stroke_time, measured.hold_time, measured.return_time) == (1.0, 0.5, 1.0)
    assert measured.preparation_speed == pytest.approx(1.875 * 0.4 / ARM_LENGTH, rel=1e-3)
    assert measured.stroke_speed == pytest.approx(1.875 * 0.2 / ARM_LENGTH, rel=1e-3)
    assert measured.return_speed == pytest.approx(1.875 * np.hypot(0.4, 0.2) / ARM_LENGTH, rel=1e-3)
    assert measured.largest_speed == measured.return_speed
    assert measured.stroke_to_preparation == pytest.approx(0.5, rel=1e-3)
    assert measured.return_to_preparation == pytest.approx(np.hypot(1.0, 0.5), rel=1e-3)
    assert measured.path == pytest.approx(0.6 + np.hypot(0.4, 0.2), rel=1e-3)
    assert measured.arm_lengths == pytest.approx(measured.path / ARM_LENGTH)
    assert measured.stroke_path == pytest.approx(0.2 / ARM_LENGTH, rel=1e-3)
    assert measured.units == 3
    assert measured.units_per_second == pytest.approx(3 / 3.5)
    assert measured.lead == pytest.approx(0.5, abs=0.011)


def test_hand_speed_at_stroke_start_is_measured_as_flow(gesture):
    times, path = gesture
    assert measure_hand(times, path, SYNC_TIMES, ARM_LENGTH).flow == pytest.approx(0.0, abs=0.01)
    early = measure_hand(times, path, SYNC_TIMES | {"strokeStart": 0.5}, ARM_LENGTH)
    assert early.flow == pytest.approx(1.0, rel=1e-3)
    assert measure_hand(times, path, SYNC_TIMES | {"strokeStart": 0.25}, ARM_LENGTH).flow == pytest.approx(
        (0.25**2 * 0.75**2) / 0.5**4, rel=1e-2
    )


def test_missing_sync_points_remove_only_the_phase_measures_of_a_gesture(gesture):
    times, path = gesture
    measured = measure_hand(times, path, {"start": 0.0, "end": 3.5}, ARM_LENGTH)
    whole = measure_hand(times, path, SYNC_TIMES, ARM_LENGTH)
    assert (measured.units, measured.sparc, measured.path) == (whole.units, whole.sparc, whole.path)
    unknown = ("stroke_time", "hold_time", "return_time", "preparation_speed", "stroke_speed", "return_speed", "flow")
    assert {getattr(measured, name) for name in (*unknown, "lead", "preparation_sparc", "stroke_path")} == {None}
    assert measured.stroke_to_preparation is measured.return_to_preparation is None


def test_hand_motion_measures_agree_at_30_and_100_hz(gesture):
    times, path = gesture
    coarse = np.arange(0.0, 3.5001, 1 / PROFILE_RATE)
    thinned = np.stack([np.interp(coarse, times, column) for column in path.T], axis=1)
    fine, measured = (
        measure_hand(times, path, SYNC_TIMES, ARM_LENGTH),
        measure_hand(coarse, thinned, SYNC_TIMES, ARM_LENGTH),
    )
    assert measured.units == fine.units
    assert measured.sparc == pytest.approx(fine.sparc, rel=0.02)
    assert measured.stroke_speed == pytest.approx(fine.stroke_speed, rel=0.02)
