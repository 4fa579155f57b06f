import pickle
from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import BSpline

from kinesic.motion import trajectory
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory, spline_weights, stay

CONTROL_ANGLES = np.random.default_rng(7).normal(size=(33, 2))  # [rad] random control points of two hinges
RANDOM_MOTION = Trajectory(CONTROL_ANGLES, zero=0.1)  # motion with block time zero at 0.1 s
# SciPy's spline with the same knots and control points
REFERENCE_SPLINE = BSpline(KNOT_INTERVAL * np.arange(-3, 34), CONTROL_ANGLES, 3)


@pytest.mark.parametrize("order", range(3))
def test_trajectory_equals_a_uniform_cubic_b_spline(order):
    times = np.append(np.linspace(0.0, RANDOM_MOTION.duration, 401)[1:-1], [0.0, 0.1])
    expected = REFERENCE_SPLINE.derivative(order)(times) if order else REFERENCE_SPLINE(times)
    np.testing.assert_allclose(
        RANDOM_MOTION.sample(times)[order], expected, rtol=1e-9, atol=1e-9 / KNOT_INTERVAL**order
    )


def test_jerk_of_a_trajectory_is_constant_between_knots():
    times = KNOT_INTERVAL * (np.arange(30) + 0.5)
    np.testing.assert_allclose(RANDOM_MOTION.jerks(times), REFERENCE_SPLINE.derivative(3)(times), rtol=1e-9)
    np.testing.assert_array_equal(RANDOM_MOTION.jerks(times + 0.4 * KNOT_INTERVAL), RANDOM_MOTION.jerks(times))


def test_trajectory_duration_is_the_number_of_knot_intervals_times_their_length():
    assert RANDOM_MOTION.duration == pytest.approx(30 * KNOT_INTERVAL)


def test_trajectory_is_at_rest_before_its_start_and_after_its_end():
    outside = np.array([-0.5, RANDOM_MOTION.duration + 0.5])
    angles, speeds, accelerations = RANDOM_MOTION.sample(outside)
    np.testing.assert_allclose(angles, RANDOM_MOTION.sample(np.array([0.0, RANDOM_MOTION.duration]))[0])
    assert not speeds.any()
    assert not accelerations.any()
    assert not RANDOM_MOTION.jerks(outside).any()


def test_shifted_motion_has_shifted_samples():
    times, later = np.linspace(-0.1, 0.5, 62), replace(RANDOM_MOTION, start=2.0)
    for one, other in zip(RANDOM_MOTION.sample(times), later.sample(times + 2.0), strict=True):
        np.testing.assert_allclose(other, one, atol=1e-6)
    assert later.end == pytest.approx(2.0 + RANDOM_MOTION.duration)


@pytest.mark.parametrize("time", [-1.0, 2.0, 2.014, 2.15, 2.29, 2.3, 99.0])
def test_trajectory_since_a_time_drops_the_past(time):
    whole = replace(RANDOM_MOTION, controls=np.concatenate([CONTROL_ANGLES, CONTROL_ANGLES[[-1, -1]]]), start=2.0)
    left, times = whole.since(time), np.linspace(max(time, 2.0), max(time, 2.0) + 0.4, 30)
    assert left.start <= max(time, 2.0) < left.start + KNOT_INTERVAL + 1e-9
    assert len(left.controls) >= 4
    np.testing.assert_allclose(left.sample(times)[0], whole.sample(times)[0], atol=1e-9)


def test_pickled_trajectory_omits_cached_derivatives():
    moved = replace(RANDOM_MOTION, start=2.0)
    before = len(pickle.dumps(moved))
    moved.sample(np.array([2.1]))
    assert len(pickle.dumps(moved)) == before
    again = pickle.loads(pickle.dumps(moved))
    np.testing.assert_array_equal(again.controls, CONTROL_ANGLES)
    assert (again.zero, again.start) == (0.1, 2.0)


def test_trajectory_state_at_a_nan_time_is_nan():
    for values in RANDOM_MOTION.sample(np.array([0.2, np.nan, 0.3])):
        assert np.isnan(values).all(axis=1).tolist() == [False, True, False]


def test_trajectory_angles_equal_those_of_its_samples(monkeypatch):
    monkeypatch.setattr(trajectory, "SAMPLES_PER_WINDOW", 8)
    times = np.linspace(-0.05, 0.35, 53)
    assert np.array_equal(RANDOM_MOTION.angles(times), RANDOM_MOTION.sample(times)[0])


def test_trajectory_state_at_a_time_equals_its_sample():
    state, sample = RANDOM_MOTION.at(0.123), RANDOM_MOTION.sample(np.array([0.123]))
    for value, row in zip((state.angles, state.velocities, state.accelerations), sample, strict=True):
        np.testing.assert_array_equal(value, row[0])


@pytest.mark.parametrize("order", range(3))
def test_weights_of_the_b_spline_sum_to_one(order):
    first, shares = spline_weights(np.array([-1.0, 0.0, 0.4, 5.0, 29.99, 30.0, 31.0]), 30, order)
    assert shares.shape == (7, 4 - order)
    np.testing.assert_allclose(shares.sum(axis=1), 1.0)
    assert first.min() == 0
    assert first.max() == 29


def test_trajectory_of_one_posture_has_constant_angles_and_no_velocity():
    still = stay(np.array([0.1, 0.2]))
    angles, speeds, _ = still.sample(np.array([-1.0, 0.0, 0.05, 9.0]))
    np.testing.assert_allclose(angles, np.tile([0.1, 0.2], (4, 1)))
    assert not speeds.any()


def test_final_rest_of_a_trajectory_starts_after_its_last_movement():
    held = np.vstack((CONTROL_ANGLES, np.repeat(CONTROL_ANGLES[-1:] + 1e-12, 50, axis=0)))
    motion = Trajectory(held, zero=0.0, start=2.0)
    assert motion.end - motion.rest_start == pytest.approx(48 * KNOT_INTERVAL)
    times = motion.rest_start + np.append(-0.5, np.arange(48)) * KNOT_INTERVAL
    before, *after = np.abs(motion.sample(times)[1]).max(axis=1)
    assert before > 1e-3
    assert max(after) < 1e-9
    assert stay(CONTROL_ANGLES[0], 7.0, start=3.0).rest_start == 3.0


@pytest.mark.parametrize("order", range(3))
def test_spline_weights_of_a_derivative_give_the_derivative_of_the_spline(order):
    places = np.array([0.0, 0.4, 5.0, 7.75, 29.0, 29.99, 30.0 - 1e-9])
    first, weights = spline_weights(places, 30, order)
    points = (np.diff(CONTROL_ANGLES, order, axis=0) / KNOT_INTERVAL**order)[first[:, None] + np.arange(4 - order)]
    expected = REFERENCE_SPLINE.derivative(order)(places * KNOT_INTERVAL)
    np.testing.assert_allclose(np.einsum("mw,mwn->mn", weights, points), expected, rtol=1e-7)


def test_spline_weights_beyond_the_ends_are_those_of_the_ends():
    for outside, end in ((-3.0, 0.0), (33.0, 30.0)):
        for order in range(3):
            one, other = spline_weights(np.array([outside]), 30, order), spline_weights(np.array([end]), 30, order)
            np.testing.assert_array_equal(one[0], other[0])
            np.testing.assert_array_equal(one[1], other[1])
    assert spline_weights(np.array([30.0]), 30)[1][0] == pytest.approx([0.0, 1 / 6, 4 / 6, 1 / 6])


def test_jerks_of_a_delayed_trajectory_are_zero_before_its_start_and_after_its_end():
    later = replace(RANDOM_MOTION, start=2.0)
    steps = np.diff(CONTROL_ANGLES, 3, axis=0) / KNOT_INTERVAL**3
    inside = later.jerks(2.0 + KNOT_INTERVAL * np.array([0.0, 0.5, 29.5])), later.jerks(np.array([later.end]))
    np.testing.assert_allclose(np.concatenate(inside), steps[[0, 0, 29, 29]])
    assert not later.jerks(np.array([2.0 - 1e-6, later.end + 1e-6, 1.0, 4.0])).any()


def test_motion_that_moves_until_its_end_has_no_rest_before_it():
    angles, speeds, accelerations = RANDOM_MOTION.sample(np.array([0.0, RANDOM_MOTION.duration]))
    np.testing.assert_allclose(angles[1], REFERENCE_SPLINE(RANDOM_MOTION.duration - 1e-12))
    assert speeds.all()
    assert accelerations.all()
    for values in RANDOM_MOTION.sample(np.array([-1e-9, RANDOM_MOTION.duration + 1e-9]))[1:]:
        assert not values.any()


@pytest.mark.parametrize(("before", "dropped"), [(5e-9, 3), (1.5e-8, 2), (1e-6, 2), (-1e-6, 3)])
def test_truncation_at_a_knot_drops_the_finished_interval_despite_rounding_errors(before, dropped):
    left = RANDOM_MOTION.since(3 * KNOT_INTERVAL - before)
    np.testing.assert_array_equal(left.controls, CONTROL_ANGLES[dropped:])
    assert (left.start, left.zero) == (pytest.approx(dropped * KNOT_INTERVAL), 0.1)


def test_last_interval_of_a_motion_remains_until_the_last_knot():
    np.testing.assert_array_equal(RANDOM_MOTION.since(0.295).controls, CONTROL_ANGLES[-4:])
    np.testing.assert_array_equal(RANDOM_MOTION.since(0.305).controls, np.repeat(CONTROL_ANGLES[-1:], 4, axis=0))
    assert RANDOM_MOTION.since(-1.0).start == 0.0


@pytest.mark.parametrize(("distance", "moving"), [(0.7e-9, 0), (1.5e-9, 6), (-1.5e-9, 6)])
def test_deviation_of_more_than_a_nanoradian_from_the_last_posture_is_movement(distance, moving):
    controls = np.zeros((20, 2))
    controls[5, 1] = distance
    assert Trajectory(controls, zero=0.0, start=1.0).rest_start == pytest.approx(1.0 + moving * KNOT_INTERVAL)


def test_motion_of_one_posture_lasts_0_1_s_by_default():
    still = stay(np.array([0.1, 0.2]))
    assert (still.duration, still.start, still.zero) == (pytest.approx(0.1), 0.0, 0.0)
    longer = stay(np.array([0.1, 0.2]), 0.25, start=3.0)
    assert (longer.duration, longer.end) == (pytest.approx(0.25), pytest.approx(3.25))
