import numpy as np
import pytest

from kinesic.controller.trajectory import Manner, held, spline

TIMES = np.array([0.0, 0.5, 1.2, 1.5, 2.4])
ANGLES = np.array([[0.0, 1.0], [0.4, 1.0], [0.9, 0.2], [0.9, -0.4], [0.1, -0.4]])
ALL = np.ones_like(ANGLES, dtype=bool)
FULL = np.ones_like(ANGLES)


PLAIN = Manner()


def joined(manner: Manner = PLAIN, keyed=ALL, zero: float = 0.0):
    return spline(TIMES, ANGLES, keyed, manner, FULL, zero=zero)


def test_keys_are_met_exactly():
    trajectory = joined()
    np.testing.assert_allclose(trajectory.sample(TIMES)[0], ANGLES, atol=1e-12)


def test_starts_and_ends_at_rest():
    trajectory = joined()
    for time in (0.0, trajectory.duration):
        state = trajectory.at(time)
        np.testing.assert_allclose(state.speeds, 0.0, atol=1e-9)
        np.testing.assert_allclose(state.accelerations, 0.0, atol=1e-7)


def test_speed_and_acceleration_are_continuous_at_keys():
    trajectory = joined()
    for time in TIMES[1:-1]:
        before, after = trajectory.at(time - 1e-7), trajectory.at(time + 1e-7)
        np.testing.assert_allclose(before.speeds, after.speeds, atol=1e-4)
        np.testing.assert_allclose(before.accelerations, after.accelerations, atol=1e-3)


def test_speeds_are_the_derivative_of_angles():
    trajectory = joined()
    times = np.linspace(0.01, trajectory.duration - 0.01, 97)
    step = 1e-6
    ahead, behind = trajectory.sample(times + step)[0], trajectory.sample(times - step)[0]
    np.testing.assert_allclose((ahead - behind) / (2 * step), trajectory.sample(times)[1], atol=1e-5)


def test_holds_do_not_move():
    times = np.linspace(1.2, 1.5, 31)
    np.testing.assert_allclose(joined().sample(times)[0][:, 0], 0.9, atol=1e-12)


def test_a_hinge_without_a_key_passes_through():
    keyed = ALL.copy()
    keyed[2, 1] = False
    trajectory = joined(keyed=keyed)
    assert abs(trajectory.at(1.2).angles[1] - ANGLES[2, 1]) > 0.05
    np.testing.assert_allclose(trajectory.at(1.5).angles[1], ANGLES[3, 1], atol=1e-12)


def test_tension_one_stops_at_each_key():
    trajectory = joined(Manner(tension=1.0))
    np.testing.assert_allclose(trajectory.sample(TIMES)[1], 0.0, atol=1e-9)


def test_continuity_lets_keys_flow():
    stiff, fluid = joined(Manner(continuity=-1.0)), joined(Manner(continuity=0.0))
    assert abs(stiff.at(0.5).speeds[0]) < 1e-9
    assert fluid.at(0.5).speeds[0] > 0.5


def test_zero_is_the_time_of_the_blocks_start():
    assert joined(zero=0.7).zero == pytest.approx(0.7)


def test_outside_it_stands_still():
    state = joined().at(99.0)
    np.testing.assert_allclose(state.angles, ANGLES[-1])
    np.testing.assert_array_equal(state.speeds, 0.0)


def test_held_stays():
    trajectory = held(np.array([0.1, 0.2]))
    np.testing.assert_allclose(trajectory.at(0.05).angles, [0.1, 0.2])
    np.testing.assert_array_equal(trajectory.at(0.05).speeds, 0.0)
