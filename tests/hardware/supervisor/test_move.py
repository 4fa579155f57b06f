import numpy as np
import pytest

from kinesic.hardware.supervisor.move import TimedMove


def test_it_goes_from_rest_to_rest_and_no_joint_is_faster_than_the_pace():
    way = TimedMove.between(np.array([0.0, 1.0]), np.array([0.5, -1.0]), pace=0.7)
    times = np.linspace(0.0, way.duration, 2001)
    places = np.array([way.at(float(time)) for time in times])
    speeds = np.gradient(places, times, axis=0)
    assert np.abs(speeds).max() == pytest.approx(0.7, rel=1e-3)
    assert np.abs(speeds[[0, -1]]).max() < 1e-3
    assert places[0].tolist() == [0.0, 1.0]
    assert places[-1].tolist() == [0.5, -1.0]


def test_a_little_way_takes_its_least_time_and_none_takes_none():
    assert TimedMove.between(np.zeros(2), np.full(2, 0.001), pace=1.0).duration == 0.3
    still = TimedMove.between(np.ones(2), np.ones(2), pace=1.0)
    assert still.duration == 0.0
    assert still.at(0.0).tolist() == [1.0, 1.0]
