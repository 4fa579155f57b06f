from math import inf, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.hardware.virtual.profile import Profile, by_speed, by_time, still_profile

PLACES = st.floats(-6.0, 6.0)


def sampled(profile: Profile) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    times = np.linspace(0.0, profile.duration, 2001)
    places, speeds = np.transpose([profile.at(time) for time in times])
    return times, places, speeds


def test_the_four_forms():
    assert by_speed(0.0, 0.0, 1.0, limit=inf, acceleration=1.0).form == "step"
    assert by_speed(0.0, 0.0, 1.0, limit=2.0, acceleration=inf).form == "rectangle"
    assert by_speed(0.0, 0.0, 1.0, limit=2.0, acceleration=1.0).form == "triangle"
    assert by_speed(0.0, 0.0, 9.0, limit=2.0, acceleration=1.0).form == "trapezoid"
    assert by_time(0.0, 1.0, duration=1.0, rise=0.0).form == "rectangle"
    assert by_time(0.0, 1.0, duration=1.0, rise=0.7).form == "triangle"
    assert by_time(0.0, 1.0, duration=1.0, rise=0.2).form == "trapezoid"
    assert by_time(0.0, 1.0, duration=0.0, rise=0.2).form == "step"


def test_times_from_rest_are_those_of_the_textbook():
    assert by_speed(0.0, 0.0, 9.0, limit=2.0, acceleration=1.0).duration == pytest.approx(9 / 2 + 2 / 1)
    assert by_speed(0.0, 0.0, 1.0, limit=2.0, acceleration=1.0).duration == pytest.approx(2 * sqrt(1.0))
    assert by_speed(0.0, 0.0, -3.0, limit=2.0, acceleration=inf).duration == 1.5
    assert by_time(0.0, 5.0, duration=1.25, rise=0.3).duration == 1.25


def test_a_step_is_at_its_goal_at_once():
    assert by_speed(0.0, 0.0, 1.0, limit=inf, acceleration=1.0).at(0.0) == (1.0, 0.0)
    assert still_profile(0.3).at(0.0) == (0.3, 0.0)


@given(PLACES, st.floats(-3.0, 3.0), PLACES, st.floats(0.1, 5.0), st.floats(0.5, 50.0))
def test_it_keeps_its_limits_and_arrives(start: float, speed: float, goal: float, limit: float, acceleration: float):
    profile = by_speed(start, speed, goal, limit=limit, acceleration=acceleration)
    times, places, speeds = sampled(profile)
    assert places[0] == pytest.approx(start, abs=1e-9)
    assert places[-1] == pytest.approx(goal, abs=1e-6)
    assert np.abs(speeds).max() <= max(limit, abs(speed)) + 1e-9
    if profile.duration > 1e-3:
        assert np.abs(np.diff(speeds) / np.diff(times)).max() <= acceleration * (1 + 1e-6) + 1e-6
        assert np.abs(np.diff(places) / np.diff(times)).max() <= max(limit, abs(speed)) + 1e-6


@given(PLACES, PLACES, st.floats(0.05, 5.0), st.floats(0.0, 5.0))
def test_by_time_it_takes_as_long_as_asked(start: float, goal: float, duration: float, rise: float):
    profile = by_time(start, goal, duration=duration, rise=rise)
    assert profile.duration == pytest.approx(duration)
    _, places, _ = sampled(profile)
    assert places[-1] == goal
    assert (np.diff(places) * np.sign(goal - start) >= -1e-9).all()
    assert places[1000] == pytest.approx((start + goal) / 2, abs=1e-6)
