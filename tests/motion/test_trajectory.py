import numpy as np
import pytest
from scipy.interpolate import BSpline

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
