import pickle
from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import BSpline

from kinesic.motion import trajectory
from kinesic.motion.trajectory import STEP, Trajectory, spline_weights, stay

CONTROLS = np.random.default_rng(7).normal(size=(33, 2))
MOTION = Trajectory(CONTROLS, zero=0.1)
SAME = BSpline(STEP * np.arange(-3, 34), CONTROLS, 3)  # the textbook's, on the same knots


@pytest.mark.parametrize("order", range(3))
def test_it_is_the_uniform_cubic_b_spline(order):
    times = np.append(np.linspace(0.0, MOTION.duration, 401)[1:-1], [0.0, 0.1])
    expected = SAME.derivative(order)(times) if order else SAME(times)
    np.testing.assert_allclose(MOTION.sample(times)[order], expected, rtol=1e-9, atol=1e-9 / STEP**order)


def test_the_jerk_is_constant_between_knots():
    times = STEP * (np.arange(30) + 0.5)
    np.testing.assert_allclose(MOTION.jerks(times), SAME.derivative(3)(times), rtol=1e-9)
    np.testing.assert_array_equal(MOTION.jerks(times + 0.4 * STEP), MOTION.jerks(times))


def test_its_length_is_that_of_its_pieces():
    assert MOTION.duration == pytest.approx(30 * STEP)


def test_before_and_after_it_is_at_rest():
    outside = np.array([-0.5, MOTION.duration + 0.5])
    angles, speeds, accelerations = MOTION.sample(outside)
    np.testing.assert_allclose(angles, MOTION.sample(np.array([0.0, MOTION.duration]))[0])
    assert not speeds.any()
    assert not accelerations.any()
    assert not MOTION.jerks(outside).any()


def test_a_motion_that_starts_at_another_time_is_the_same():
    times, later = np.linspace(-0.1, 0.5, 62), replace(MOTION, start=2.0)
    for one, other in zip(MOTION.sample(times), later.sample(times + 2.0), strict=True):
        np.testing.assert_allclose(other, one, atol=1e-6)
    assert later.end == pytest.approx(2.0 + MOTION.duration)


@pytest.mark.parametrize("time", [-1.0, 2.0, 2.014, 2.15, 2.29, 2.3, 99.0])
def test_its_past_can_be_cut_away(time):
    whole = replace(MOTION, controls=np.concatenate([CONTROLS, CONTROLS[[-1, -1]]]), start=2.0)
    left, times = whole.since(time), np.linspace(max(time, 2.0), max(time, 2.0) + 0.4, 30)
    assert left.start <= max(time, 2.0) < left.start + STEP + 1e-9
    assert len(left.controls) >= 4
    np.testing.assert_allclose(left.sample(times)[0], whole.sample(times)[0], atol=1e-9)


def test_another_process_gets_it_without_its_derivatives():
    moved = replace(MOTION, start=2.0)
    before = len(pickle.dumps(moved))
    moved.sample(np.array([2.1]))
    assert len(pickle.dumps(moved)) == before
    again = pickle.loads(pickle.dumps(moved))
    np.testing.assert_array_equal(again.controls, CONTROLS)
    assert (again.zero, again.start) == (0.1, 2.0)


@pytest.mark.skipif(trajectory.KERNEL != "compiled", reason="NumPy warns")
def test_a_time_that_is_none_has_no_state():
    for values in MOTION.sample(np.array([0.2, np.nan, 0.3])):
        assert np.isnan(values).all(axis=1).tolist() == [False, True, False]


def test_angles_alone_are_those_of_a_sample(monkeypatch):
    monkeypatch.setattr(trajectory, "SAMPLES_PER_WINDOW", 8)
    times = np.linspace(-0.05, 0.35, 53)
    assert np.array_equal(MOTION.angles(times), MOTION.sample(times)[0])


def test_one_state_is_a_sample():
    state, sample = MOTION.at(0.123), MOTION.sample(np.array([0.123]))
    for value, row in zip((state.angles, state.speeds, state.accelerations), sample, strict=True):
        np.testing.assert_array_equal(value, row[0])


@pytest.mark.parametrize("order", range(3))
def test_weights_share_one(order):
    first, shares = spline_weights(np.array([-1.0, 0.0, 0.4, 5.0, 29.99, 30.0, 31.0]), 30, order)
    assert shares.shape == (7, 4 - order)
    np.testing.assert_allclose(shares.sum(axis=1), 1.0)
    assert first.min() == 0
    assert first.max() == 29


def test_staying_in_a_posture():
    still = stay(np.array([0.1, 0.2]))
    angles, speeds, _ = still.sample(np.array([-1.0, 0.0, 0.05, 9.0]))
    np.testing.assert_allclose(angles, np.tile([0.1, 0.2], (4, 1)))
    assert not speeds.any()
