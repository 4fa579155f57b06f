import numpy as np
import pytest

from kinesic.metrics.arrival import (
    ARRIVAL_PATH_FRACTION,
    ENTRY_WINDOW,
    MIN_ARRIVAL_RADIUS,
    _find_first_entry,
    find_arrivals,
    measure_stretch,
)
from kinesic.metrics.reference import MOVING_FRACTION

from ..reference.metrics import paths

TIMES = np.arange(0.0, 2.0, 0.01)
STRAIGHT_PATH = np.stack(
    [np.clip(TIMES, 0.0, 1.0), 0 * TIMES, 0 * TIMES], axis=1
)  # [m] straight path at 1 m/s that arrives at 1 s


def test_arrival_time_is_when_the_path_enters_the_target_ball():
    assert _find_first_entry(1.0, TIMES, STRAIGHT_PATH, np.array([1.0, 0, 0]), 0.05) == pytest.approx(0.95)


def test_arrival_time_of_a_hand_is_interpolated_between_samples():
    assert _find_first_entry(1.0, TIMES, STRAIGHT_PATH, np.array([1.0, 0, 0]), 0.0333) == pytest.approx(0.9667)


def test_path_already_in_the_target_ball_arrives_at_the_window_start():
    assert _find_first_entry(1.7, TIMES, STRAIGHT_PATH, np.array([1.0, 0, 0]), 0.05) == pytest.approx(1.4)


def test_path_outside_the_target_ball_does_not_arrive():
    assert _find_first_entry(1.0, TIMES, STRAIGHT_PATH, np.array([1.0, 0.2, 0]), 0.05) is None


def test_arrival_constants_are_5_mm_5_percent_of_the_path_and_a_300_ms_window():
    assert (MIN_ARRIVAL_RADIUS, ARRIVAL_PATH_FRACTION, ENTRY_WINDOW) == (0.005, 0.05, 0.3)


def test_threshold_of_moving_hinges_is_5_percent_of_their_velocity_limit():
    assert MOVING_FRACTION == 0.05


def test_behaviours_after_a_stop_have_no_arrival_time(calm):
    plan, times = calm.plan, calm.reference.times
    stopped = times[:5]
    paths = {part: path[: len(stopped)] for part, path in calm.reference.paths.items()}
    assert find_arrivals(plan, stopped, paths) == {}


def test_length_and_peak_speed_of_a_path_section_are_measured_between_samples():
    assert measure_stretch(TIMES, STRAIGHT_PATH, 0.305, 1.5) == pytest.approx((1.0, 0.695))
    assert measure_stretch(TIMES, STRAIGHT_PATH, 1.2, 1.5) == pytest.approx((0.0, 0.0))
    assert measure_stretch(TIMES, STRAIGHT_PATH, 0.502, 0.507) == pytest.approx((1.0, 0.005))


def test_kernel_and_python_measure_equal_speeds_and_lengths_of_path_sections():
    path = np.random.default_rng(7).normal(size=STRAIGHT_PATH.shape)
    moments = [(-0.1, 0.4), (0.2, 0.2), (0.2, 0.2004), (0.305, 1.0), (1.7, 3.0), (0.31, 0.32), (0.5, 0.4)]
    result, expected = (
        [measure(TIMES, path, *edges) for edges in moments] for measure in (measure_stretch, paths.measure_stretch)
    )
    np.testing.assert_allclose(result, expected, rtol=1e-9, atol=1e-13)
