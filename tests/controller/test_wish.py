import numpy as np
import pytest

from kinesic.controller.wish import Manner, wish

TIMES = np.array([0.0, 0.5, 1.2, 1.5, 2.4])
ANGLES = np.array([[0.0, 1.0], [0.4, 1.0], [0.9, 0.2], [0.9, -0.4], [0.1, -0.4]])
ALL = np.ones_like(ANGLES, dtype=bool)
PLAIN = Manner()


def joined(manner: Manner = PLAIN, keyed=ALL, zero: float = 0.0):
    return wish(TIMES, ANGLES, keyed, manner, zero=zero)


def state(motion, time: float):
    return [values[0] for values in motion.sample(np.array([time]))]


def test_keys_are_met_exactly():
    np.testing.assert_allclose(joined().sample(TIMES)[0], ANGLES, atol=1e-12)


def test_angles_are_those_of_the_sample():
    times = np.linspace(-0.2, joined().duration + 0.2, 31)
    assert np.array_equal(joined().angles(times), joined().sample(times)[0])


def test_every_hinge_passes_its_own_keys_as_if_it_were_alone():
    keyed = ALL.copy()
    keyed[2, 1] = False
    times, both = np.linspace(0.0, 2.4, 49), joined(keyed=keyed)
    for hinge in range(2):
        alone = wish(TIMES, ANGLES[:, hinge : hinge + 1], keyed[:, hinge : hinge + 1], PLAIN)
        for one, other in zip(both.sample(times), alone.sample(times), strict=True):
            assert np.array_equal(one[:, hinge], other[:, 0])


def test_starts_and_ends_at_rest():
    for time in (0.0, joined().duration):
        _, speeds, accelerations = state(joined(), time)
        np.testing.assert_allclose(speeds, 0.0, atol=1e-9)
        np.testing.assert_allclose(accelerations, 0.0, atol=1e-7)


def test_speed_and_acceleration_are_continuous_at_keys():
    for time in TIMES[1:-1]:
        before, after = state(joined(), time - 1e-7), state(joined(), time + 1e-7)
        np.testing.assert_allclose(before[1], after[1], atol=1e-4)
        np.testing.assert_allclose(before[2], after[2], atol=1e-3)


def test_speeds_are_the_derivative_of_angles():
    times = np.linspace(0.01, joined().duration - 0.01, 97)
    step = 1e-6
    ahead, behind = joined().sample(times + step)[0], joined().sample(times - step)[0]
    np.testing.assert_allclose((ahead - behind) / (2 * step), joined().sample(times)[1], atol=1e-5)


def test_holds_do_not_move():
    times = np.linspace(1.2, 1.5, 31)
    np.testing.assert_allclose(joined().sample(times)[0][:, 0], 0.9, atol=1e-12)


def test_a_hinge_without_a_key_passes_through():
    keyed = ALL.copy()
    keyed[2, 1] = False
    motion = joined(keyed=keyed)
    assert abs(state(motion, 1.2)[0][1] - ANGLES[2, 1]) > 0.05
    np.testing.assert_allclose(state(motion, 1.5)[0][1], ANGLES[3, 1], atol=1e-12)


def test_tension_one_stops_at_each_key():
    np.testing.assert_allclose(joined(Manner(tension=1.0)).sample(TIMES)[1], 0.0, atol=1e-9)


def test_continuity_lets_keys_flow():
    stiff, fluid = joined(Manner(continuity=-1.0)), joined(Manner(continuity=0.0))
    assert abs(state(stiff, 0.5)[1][0]) < 1e-9
    assert state(fluid, 0.5)[1][0] > 0.5


def test_zero_is_the_time_of_the_blocks_start():
    assert joined(zero=0.7).zero == pytest.approx(0.7)


def test_outside_it_stands_still():
    angles, speeds, _ = state(joined(), 99.0)
    np.testing.assert_allclose(angles, ANGLES[-1])
    np.testing.assert_array_equal(speeds, 0.0)
