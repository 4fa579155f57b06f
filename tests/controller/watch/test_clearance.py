"""Looks ahead of a robot with one hinge, whose clearance is the distance of its angle from a wall."""

import numpy as np
import pytest

from kinesic.body.dynamics import Clearance
from kinesic.controller.watch.clearance import (
    CREEP,
    EASY,
    FORESIGHT,
    LONGEST_CREEP,
    LOOK,
    MEMORY,
    RESERVE,
    SETTLED,
    TOUCH,
    ClearanceWatch,
    coming_times,
    foresee,
    look_ahead,
    pace_for,
)

LEAST = 0.01  # [m]


class Wall:
    """One metre per radian from a wall at 0."""

    def clearance(self, angles):
        return Clearance(angles[:, 0], [("arm", "wall")] * len(angles))

    def gaps(self, angles):
        return angles

    def bounds(self, angles, turns):
        return (angles - turns)[:, 0]


WALL = Wall()


def seen(watch: ClearanceWatch, *coming: float, strayed: float) -> ClearanceWatch:
    return look_ahead(watch, np.array(coming)[:, None], np.array([strayed]), WALL, least=LEAST)


def test_with_ample_room_time_runs_as_planned():
    watch = seen(ClearanceWatch(), 0.05, 0.03, strayed=0.01)
    assert watch.room == pytest.approx(0.02)
    assert (watch.pace, watch.over) == (1.0, False)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_an_error_is_expected_both_ways_at_the_nearest_posture_that_comes(way):
    watch = seen(ClearanceWatch(), 0.05, 0.02, 0.04, strayed=0.013 * way)
    assert watch.room == pytest.approx(0.007)
    assert CREEP < watch.pace < 1.0


def test_pace_falls_evenly_from_easy_to_touch():
    assert pace_for(EASY * LEAST, LEAST) == pytest.approx(1.0)
    assert pace_for((EASY + TOUCH) / 2 * LEAST, LEAST) == pytest.approx(0.5)
    assert pace_for(TOUCH * LEAST, LEAST) == CREEP == pace_for(-1.0, LEAST)
    assert pace_for(np.inf, LEAST) == 1.0


def test_an_error_is_remembered_and_then_forgotten():
    watch = seen(ClearanceWatch(), 0.02, strayed=0.02)
    for _ in range(round(MEMORY / LOOK) - 1):
        watch = seen(watch, 0.02, strayed=0.0)
    assert min(watch.room, seen(watch, 0.02, strayed=0.0).room) == pytest.approx(0.0)
    for _ in range(3):
        watch = seen(watch, 0.02, strayed=0.0)
    assert (watch.room, watch.pace) == (pytest.approx(0.02), 1.0)


def test_who_waits_in_vain_is_over_and_errors_are_forgotten_before():
    watch, looks = ClearanceWatch(), 0
    while not watch.over:
        watch, looks = seen(watch, 0.02, strayed=-0.0165), looks + 1
    assert looks == pytest.approx(LONGEST_CREEP / LOOK, abs=1)
    assert not watch.near
    assert LONGEST_CREEP > MEMORY


def test_what_has_come_into_the_reserve_is_over_at_once():
    assert RESERVE < TOUCH
    assert not seen(ClearanceWatch(), 0.02, strayed=-0.0165).over
    watch = seen(ClearanceWatch(), 0.02, strayed=-0.0175)
    assert watch.near
    assert watch.over
    assert not seen(ClearanceWatch(), 0.02, 0.0, strayed=0.0).over  # what is only to come can still be slowed down


def test_what_is_left_of_an_error_while_time_creeps_keeps_its_sign():
    watch, looks = ClearanceWatch(), 0
    while watch.pace <= CREEP or not looks:
        watch, looks = seen(watch, 0.02, strayed=0.019), looks + 1
    assert looks * LOOK == pytest.approx(SETTLED + MEMORY, abs=3 * LOOK)
    assert watch.room == pytest.approx(0.02)


def test_patience_begins_anew_when_time_goes_on():
    watch = seen(ClearanceWatch(), 0.02, strayed=0.019)
    assert watch.crept == LOOK
    watch = seen(watch, 0.05, strayed=0.0)
    assert watch.crept == 0.0


def test_a_servo_that_does_not_answer_is_no_error():
    assert seen(ClearanceWatch(), 0.02, strayed=np.nan).room == pytest.approx(0.02)


def test_looks_end_where_the_motion_does():
    np.testing.assert_allclose(coming_times(1.0, 9.0), 1.0 + np.arange(0.0, FORESIGHT + 1e-9, LOOK))
    assert coming_times(1.0, 1.1).max() == 1.1


def test_a_performance_is_judged_with_errors_of_before():
    planned = np.full((100, 1), 0.05)
    planned[60:] = 0.02
    measured = planned.copy()
    measured[50] += 0.015
    rooms = foresee(planned, measured, WALL, every=10)
    assert rooms[5] == pytest.approx(0.035)
    assert rooms[7] == pytest.approx(0.005)  # the error was before the wall came near
    np.testing.assert_allclose(rooms[:5], 0.05)
    assert rooms[0] == pytest.approx(0.05)


class RoughWall(Wall):
    """The same, whose bounds are a little lower than they could be."""

    def bounds(self, angles, turns):
        return super().bounds(angles, turns) - 0.001


def test_the_least_room_is_that_of_all_postures_with_all_errors():
    rng = np.random.default_rng(4)
    for _ in range(20):
        planned, errors = rng.uniform(0.02, 0.06, (90, 1)), rng.normal(0.0, 0.01, (90, 1))
        rooms = foresee(planned, planned + errors, RoughWall(), every=10)
        every = [
            min(planned[10 * k, 0] + way * errors[10 * j, 0] for j in range(k, -1, -2) for way in (1.0, -1.0))
            for k in range(9)
        ]
        assert rooms.min() == pytest.approx(min(every), abs=1e-15)
        assert int(rooms.argmin()) == int(np.argmin(every))
        assert np.all(rooms <= np.array(every) + 1e-15)
