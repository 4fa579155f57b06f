import pickle
from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import BSpline

from kinesic.motion import trajectory
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory, spline_weights, stay

CONTROLS = np.random.default_rng(7).normal(size=(33, 2))
MOTION = Trajectory(CONTROLS, zero=0.1)
SAME = BSpline(KNOT_INTERVAL * np.arange(-3, 34), CONTROLS, 3)  # the textbook's, on the same knots


@pytest.mark.parametrize("order", range(3))
def test_trajectory_equals_a_uniform_cubic_b_spline(order):
    times = np.append(np.linspace(0.0, MOTION.duration, 401)[1:-1], [0.0, 0.1])
    expected = SAME.derivative(order)(times) if order else SAME(times)
    np.testing.assert_allclose(MOTION.sample(times)[order], expected, rtol=1e-9, atol=1e-9 / KNOT_INTERVAL**order)


def test_jerk_is_constant_between_knots():
    times = KNOT_INTERVAL * (np.arange(30) + 0.5)
    np.testing.assert_allclose(MOTION.jerks(times), SAME.derivative(3)(times), rtol=1e-9)
    np.testing.assert_array_equal(MOTION.jerks(times + 0.4 * KNOT_INTERVAL), MOTION.jerks(times))


def test_trajectory_duration_is_the_number_of_knot_intervals_times_their_length():
    assert MOTION.duration == pytest.approx(30 * KNOT_INTERVAL)


def test_trajectory_is_at_rest_before_its_start_and_after_its_end():
    outside = np.array([-0.5, MOTION.duration + 0.5])
    angles, speeds, accelerations = MOTION.sample(outside)
    np.testing.assert_allclose(angles, MOTION.sample(np.array([0.0, MOTION.duration]))[0])
    assert not speeds.any()
    assert not accelerations.any()
    assert not MOTION.jerks(outside).any()


def test_shifted_motion_has_shifted_samples():
    times, later = np.linspace(-0.1, 0.5, 62), replace(MOTION, start=2.0)
    for one, other in zip(MOTION.sample(times), later.sample(times + 2.0), strict=True):
        np.testing.assert_allclose(other, one, atol=1e-6)
    assert later.end == pytest.approx(2.0 + MOTION.duration)


@pytest.mark.parametrize("time", [-1.0, 2.0, 2.014, 2.15, 2.29, 2.3, 99.0])
def test_trajectory_since_a_time_drops_the_past(time):
    whole = replace(MOTION, controls=np.concatenate([CONTROLS, CONTROLS[[-1, -1]]]), start=2.0)
    left, times = whole.since(time), np.linspace(max(time, 2.0), max(time, 2.0) + 0.4, 30)
    assert left.start <= max(time, 2.0) < left.start + KNOT_INTERVAL + 1e-9
    assert len(left.controls) >= 4
    np.testing.assert_allclose(left.sample(times)[0], whole.sample(times)[0], atol=1e-9)


def test_pickled_trajectory_omits_cached_derivatives():
    moved = replace(MOTION, start=2.0)
    before = len(pickle.dumps(moved))
    moved.sample(np.array([2.1]))
    assert len(pickle.dumps(moved)) == before
    again = pickle.loads(pickle.dumps(moved))
    np.testing.assert_array_equal(again.controls, CONTROLS)
    assert (again.zero, again.start) == (0.1, 2.0)


def test_trajectory_state_at_a_nan_time_is_nan():
    for values in MOTION.sample(np.array([0.2, np.nan, 0.3])):
        assert np.isnan(values).all(axis=1).tolist() == [False, True, False]


def test_trajectory_angles_equal_those_of_its_samples(monkeypatch):
    monkeypatch.setattr(trajectory, "SAMPLES_PER_WINDOW", 8)
    times = np.linspace(-0.05, 0.35, 53)
    assert np.array_equal(MOTION.angles(times), MOTION.sample(times)[0])


def test_trajectory_state_at_a_time_equals_its_sample():
    state, sample = MOTION.at(0.123), MOTION.sample(np.array([0.123]))
    for value, row in zip((state.angles, state.velocities, state.accelerations), sample, strict=True):
        np.testing.assert_array_equal(value, row[0])


@pytest.mark.parametrize("order", range(3))
def test_spline_weights_sum_to_one(order):
    first, shares = spline_weights(np.array([-1.0, 0.0, 0.4, 5.0, 29.99, 30.0, 31.0]), 30, order)
    assert shares.shape == (7, 4 - order)
    np.testing.assert_allclose(shares.sum(axis=1), 1.0)
    assert first.min() == 0
    assert first.max() == 29


def test_motion_of_one_posture_stays_still():
    still = stay(np.array([0.1, 0.2]))
    angles, speeds, _ = still.sample(np.array([-1.0, 0.0, 0.05, 9.0]))
    np.testing.assert_allclose(angles, np.tile([0.1, 0.2], (4, 1)))
    assert not speeds.any()


def test_rest_starts_after_the_last_movement():
    held = np.vstack((CONTROLS, np.repeat(CONTROLS[-1:] + 1e-12, 50, axis=0)))
    motion = Trajectory(held, zero=0.0, start=2.0)
    assert motion.end - motion.rest_start == pytest.approx(48 * KNOT_INTERVAL)
    times = motion.rest_start + np.append(-0.5, np.arange(48)) * KNOT_INTERVAL
    before, *after = np.abs(motion.sample(times)[1]).max(axis=1)
    assert before > 1e-3
    assert max(after) < 1e-9
    assert stay(CONTROLS[0], 7.0, start=3.0).rest_start == 3.0
