"""Clearance watch of a robot with one hinge at a distance from a wall."""

import numpy as np
import pytest

from kinesic.controller.watch.clearance import (
    CREEP_FRACTION,
    CREEP_PACE,
    LOOKAHEAD_TIME,
    MAX_CREEP_TIME,
    RESERVE_FRACTION,
    SETTLING_TIME,
    SLOWING_FRACTION,
    ClearanceWatch,
    choose_pace,
    look_ahead,
    lookahead_times,
)
from kinesic.metrics.clearance_forecast import ERROR_MEMORY, LOOK_PERIOD
from tests.wall import Wall

MIN_CLEARANCE = 0.01  # [m] smallest clearance that the robot requires


WALL = Wall()


def seen(watch: ClearanceWatch, *coming: float, strayed: float) -> ClearanceWatch:
    return look_ahead(watch, np.array(coming)[:, None], np.array([strayed]), WALL, min_clearance=MIN_CLEARANCE)


def test_clearance_watch_keeps_full_speed_at_ample_clearance():
    watch = seen(ClearanceWatch(), 0.05, 0.03, strayed=0.01)
    assert watch.forecast_clearance == pytest.approx(0.02)
    assert (watch.pace, watch.over) == (1.0, False)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_clearance_watch_subtracts_the_effect_of_tracking_errors_of_either_sign(way):
    watch = seen(ClearanceWatch(), 0.05, 0.02, 0.04, strayed=0.013 * way)
    assert watch.forecast_clearance == pytest.approx(0.007)
    assert CREEP_PACE < watch.pace < 1.0


def test_clearance_watch_lowers_the_time_scale_linearly_with_clearance():
    assert choose_pace(SLOWING_FRACTION * MIN_CLEARANCE, MIN_CLEARANCE) == pytest.approx(1.0)
    assert choose_pace((SLOWING_FRACTION + CREEP_FRACTION) / 2 * MIN_CLEARANCE, MIN_CLEARANCE) == pytest.approx(0.5)
    assert choose_pace(CREEP_FRACTION * MIN_CLEARANCE, MIN_CLEARANCE) == CREEP_PACE == choose_pace(-1.0, MIN_CLEARANCE)
    assert choose_pace(np.inf, MIN_CLEARANCE) == 1.0


def test_clearance_watch_forgets_a_tracking_error_after_the_memory_duration():
    watch = seen(ClearanceWatch(), 0.02, strayed=0.02)
    for _ in range(round(ERROR_MEMORY / LOOK_PERIOD) - 1):
        watch = seen(watch, 0.02, strayed=0.0)
    assert min(watch.forecast_clearance, seen(watch, 0.02, strayed=0.0).forecast_clearance) == pytest.approx(0.0)
    for _ in range(3):
        watch = seen(watch, 0.02, strayed=0.0)
    assert (watch.forecast_clearance, watch.pace) == (pytest.approx(0.02), 1.0)


def test_clearance_watch_requests_a_stop_after_the_maximum_time_at_minimum_speed():
    watch, looks = ClearanceWatch(), 0
    while not watch.over:
        watch, looks = seen(watch, 0.02, strayed=-0.0165), looks + 1
    assert looks == pytest.approx(MAX_CREEP_TIME / LOOK_PERIOD, abs=1)
    assert not watch.is_too_near
    assert MAX_CREEP_TIME > ERROR_MEMORY


def test_clearance_watch_requests_a_stop_at_once_below_the_reserve_clearance():
    assert RESERVE_FRACTION < CREEP_FRACTION
    assert not seen(ClearanceWatch(), 0.02, strayed=-0.0165).over
    watch = seen(ClearanceWatch(), 0.02, strayed=-0.0175)
    assert watch.is_too_near
    assert watch.over
    assert not seen(ClearanceWatch(), 0.02, 0.0, strayed=0.0).over  # what is only to come can still be slowed down


def test_clearance_watch_compares_only_the_latest_posture_with_the_reserve_clearance():
    watch = ClearanceWatch()
    for strayed, near in ((0.0, False), (-0.0175, True), (0.0, False), (0.0, False), (-0.0175, True)):
        watch = seen(watch, 0.02, strayed=strayed)
        assert watch.is_too_near is near


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_clearance_forecast_both_adds_and_subtracts_the_latest_tracking_error(way):
    watch = ClearanceWatch()
    for strayed, room in ((0.0, 0.05), (0.02, 0.03), (0.0, 0.05), (0.03, 0.02)):
        watch = seen(watch, 0.05, strayed=way * strayed)
        assert watch.forecast_clearance == pytest.approx(room)


def test_clearance_forecast_stops_mirroring_errors_after_settling_at_minimum_speed():
    watch, looks = ClearanceWatch(), 0
    while watch.pace <= CREEP_PACE or not looks:
        watch, looks = seen(watch, 0.02, strayed=0.019), looks + 1
    assert looks * LOOK_PERIOD == pytest.approx(SETTLING_TIME + ERROR_MEMORY, abs=3 * LOOK_PERIOD)
    assert watch.forecast_clearance == pytest.approx(0.02)


def test_clearance_watch_resets_its_time_at_minimum_speed_when_it_speeds_up():
    watch = seen(ClearanceWatch(), 0.02, strayed=0.019)
    assert watch.creep_time == LOOK_PERIOD
    watch = seen(watch, 0.05, strayed=0.0)
    assert watch.creep_time == 0.0


def test_clearance_watch_assumes_no_tracking_error_for_a_servo_without_answer():
    assert seen(ClearanceWatch(), 0.02, strayed=np.nan).forecast_clearance == pytest.approx(0.02)


def test_lookahead_of_the_clearance_watch_ends_with_the_motion():
    np.testing.assert_allclose(lookahead_times(1.0, 9.0), 1.0 + np.arange(0.0, LOOKAHEAD_TIME + 1e-9, LOOK_PERIOD))
    assert lookahead_times(1.0, 1.1).max() == 1.1


def test_robot_without_required_clearance_is_slowed_only_during_penetrations():
    assert choose_pace(0.001, 0.0) == choose_pace(0.0, 0.0) == 1.0
    assert choose_pace(-0.001, 0.0) == CREEP_PACE
