import numpy as np
import pytest

from kinesic.controller import arrival
from kinesic.controller.arrival import ENTRY_WINDOW, LEAST_BALL, SHARE, _first_entry, arrivals, measure_stretch
from kinesic.controller.performance import MOVING

TIMES = np.arange(0.0, 2.0, 0.01)
PATH = np.stack([np.clip(TIMES, 0.0, 1.0), 0 * TIMES, 0 * TIMES], axis=1)  # 1 m/s, there at 1 s


def test_entry_is_where_the_path_crosses_the_ball():
    assert _first_entry(1.0, TIMES, PATH, np.array([1.0, 0, 0]), 0.05) == pytest.approx(0.95)


def test_entry_is_interpolated_between_samples():
    assert _first_entry(1.0, TIMES, PATH, np.array([1.0, 0, 0]), 0.0333) == pytest.approx(0.9667)


def test_a_path_that_is_inside_already_enters_at_the_windows_start():
    assert _first_entry(1.7, TIMES, PATH, np.array([1.0, 0, 0]), 0.05) == pytest.approx(1.4)


def test_a_path_that_never_comes_near_does_not_arrive():
    assert _first_entry(1.0, TIMES, PATH, np.array([1.0, 0.2, 0]), 0.05) is None


def test_the_rule_is_a_ball_of_5_mm_or_5_percent_of_the_path_within_300_ms():
    assert (LEAST_BALL, SHARE, ENTRY_WINDOW) == (0.005, 0.05, 0.3)


def test_tracking_counts_hinges_faster_than_5_percent_of_their_limit():
    assert MOVING == 0.05


def test_what_was_to_begin_after_a_stop_has_no_way_to_judge(calm):
    plan, times = calm.plan, calm.reference.times
    stopped = times[:5]
    paths = {part: path[: len(stopped)] for part, path in calm.reference.paths.items()}
    assert arrivals(plan, stopped, paths) == {}


def test_a_part_of_a_path_has_a_length_and_a_largest_speed_between_samples_too():
    assert measure_stretch(TIMES, PATH, 0.305, 1.5) == pytest.approx((1.0, 0.695))
    assert measure_stretch(TIMES, PATH, 1.2, 1.5) == pytest.approx((0.0, 0.0))
    assert measure_stretch(TIMES, PATH, 0.502, 0.507) == pytest.approx((1.0, 0.005))


@pytest.mark.skipif(arrival.KERNEL != "compiled", reason="no compiled kernel")
def test_the_kernel_measures_the_same_part(monkeypatch):
    path = np.random.default_rng(7).normal(size=PATH.shape)
    moments = [(-0.1, 0.4), (0.2, 0.2), (0.2, 0.2004), (0.305, 1.0), (1.7, 3.0), (0.31, 0.32), (0.5, 0.4)]
    fast = [measure_stretch(TIMES, path, *edges) for edges in moments]
    monkeypatch.setattr(arrival, "KERNEL", "numpy")
    np.testing.assert_allclose(fast, [measure_stretch(TIMES, path, *edges) for edges in moments], rtol=1e-9, atol=1e-13)
