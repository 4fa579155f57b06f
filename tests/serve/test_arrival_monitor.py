import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.motion.trajectory import Trajectory, stay
from kinesic.serve.arrival_monitor import ArrivalMonitor

MOVING_HINGES = np.array([True, False])  # flags of the hinges that move: the first of two
TIMES = np.arange(0.0, 2.0, 0.01)


def moving(start):
    """Return a motion of one hinge from 0 to 1 rad in one second."""
    controls = np.zeros((203, 2))
    controls[:, 0] = np.clip(np.linspace(-0.01, 2.01, 203), 0.0, 1.0)
    return Trajectory(controls, 0.0, start)


def seen(motion, late, until):
    gauge = ArrivalMonitor()
    for time in TIMES[until > TIMES]:
        gauge.add(time + motion.start, motion.sample(np.array([motion.start + time - late]))[0][0])
    return gauge


@settings(deadline=None, max_examples=40)
@given(st.floats(-0.03, 0.08), st.floats(-5.0, 5.0))
def test_arrival_delay_of_hinges_at_a_sync_point_is_measured(late, start):
    motion = moving(start)
    result = seen(motion, late, 1.0).lateness(start + 0.8, MOVING_HINGES, motion)
    assert result == pytest.approx(late, abs=1e-3)


def test_arrival_delay_of_hinges_that_have_not_arrived_is_none():
    motion = moving(0.0)
    assert seen(motion, 0.05, 0.81).lateness(0.8, MOVING_HINGES, motion) is None
    assert ArrivalMonitor().lateness(0.8, MOVING_HINGES, motion) is None


def test_arrival_delay_of_resting_hinges_is_nan():
    motion = moving(0.0)
    assert np.isnan(seen(motion, 0.0, 1.0).lateness(0.8, ~MOVING_HINGES, motion))
    still = stay(np.zeros(2), 2.0)
    assert np.isnan(seen(still, 0.0, 1.0).lateness(0.8, MOVING_HINGES, still))


def test_arrival_delay_at_a_sync_point_long_after_the_motion_is_nan():
    motion = moving(0.0)
    assert np.isnan(seen(motion, 0.0, 1.9).lateness(1.8, MOVING_HINGES, motion))


def test_arrival_monitor_ignores_nan_and_unordered_measurements():
    motion = moving(0.0)
    gauge = seen(motion, 0.02, 0.8)
    gauge.add(0.805, np.array([np.nan, 0.0]))
    gauge.add(0.5, np.array([9.0, 0.0]))
    for time in (0.81, 0.82, 0.83, 0.9):
        gauge.add(time, motion.sample(np.array([time - 0.02]))[0][0])
    assert gauge.lateness(0.8, MOVING_HINGES, motion) == pytest.approx(0.02, abs=1e-3)


def test_arrival_delay_of_hinges_that_oscillate_by_0_2_degrees_is_nan():
    controls = np.zeros((203, 2))
    controls[:, 0] = 0.004 * np.sin(np.arange(203) * np.pi / 2)
    trembling = Trajectory(controls, 0.0)
    assert np.isnan(seen(trembling, 0.0, 1.0).lateness(0.8, MOVING_HINGES, trembling))


def test_hinges_one_degree_away_from_the_planned_angle_have_not_arrived():
    controls = np.zeros((203, 2))
    controls[:, 0] = np.radians(4.0) * np.clip((np.arange(203) - 60) / 15, 0.0, 1.0)
    motion = Trajectory(controls, 0.0)
    monitor = ArrivalMonitor()
    for time in TIMES[TIMES < 1.0]:
        monitor.add(time, motion.sample(np.array([time]))[0][0] * 0.75)
    assert monitor.lateness(0.8, MOVING_HINGES, motion) is None


@pytest.mark.parametrize(("travel", "is_judged"), [(1.2, False), (1.9, False), (2.1, True), (8.0, True)])
def test_arrival_delay_is_measured_only_for_a_travel_above_two_degrees(travel, is_judged):
    controls = np.zeros((203, 2))
    controls[:, 0] = np.radians(travel) * np.clip((np.arange(203) - 61) / 15, 0.0, 1.0)
    motion = Trajectory(controls, 0.0)
    lateness = seen(motion, 0.02, 1.0).lateness(0.8, MOVING_HINGES, motion)
    assert lateness == pytest.approx(0.02 if is_judged else np.nan, abs=2e-3, nan_ok=True)


def test_arrival_monitor_drops_measurements_older_than_its_history():
    monitor = ArrivalMonitor()
    for time in (0.0, 0.5, 1.0, 1.25):
        monitor.add(time, np.zeros(2))
    assert list(monitor._times) == [0.5, 1.0, 1.25]
    assert len(monitor._angles) == 3
