from math import sqrt

import numpy as np
import pytest
from scipy.optimize import linprog

from kinesic.body.arrays import sealed
from kinesic.body.dynamics import Load
from kinesic.body.limits import Limits
from kinesic.body.robot import Robot
from kinesic.motion.double_s import (
    DUTY_FRACTIONS,
    compute_rest_durations,
    compute_velocity_durations,
    least_rest_times,
    least_rest_times_of,
    least_stop,
    least_time,
)
from kinesic.motion.keys import KeyPosture, Keys


def simulated(distance, speed, acceleration, jerk):
    """Return the duration of seven constant-jerk phases, by bisection of peak velocity."""

    def phases(peak):
        top = min(acceleration, sqrt(peak * jerk))
        rise, flat = top / jerk, max(peak / top - top / jerk, 0.0)
        return rise, flat, peak * (2 * rise + flat)

    low, high = 0.0, speed
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (low, middle) if phases(middle)[2] > distance else (middle, high)
    rise, flat, covered = phases(low)
    return 2 * (2 * rise + flat) + max(distance - covered, 0.0) / low


@pytest.mark.parametrize(
    ("distance", "speed", "acceleration", "jerk"),
    [
        (2.0, 1.5, 10.0, 250.0),  # cruises
        (0.3, 2.0, 10.0, 250.0),  # reaches its acceleration
        (0.02, 2.0, 10.0, 250.0),  # just does not
        (0.001, 2.0, 10.0, 250.0),  # reaches neither
        (2.0, 1.0, 50.0, 100.0),  # cruises before it has its acceleration
        (0.01, 1.0, 50.0, 100.0),
    ],
)
def test_minimum_duration_equals_the_sum_of_seven_constant_jerk_phases(distance, speed, acceleration, jerk):
    assert least_time(distance, speed, acceleration, jerk) == pytest.approx(
        simulated(distance, speed, acceleration, jerk), rel=1e-9
    )


def test_minimum_duration_is_zero_for_zero_distance_and_independent_of_the_sign():
    assert least_time(0.0, 1.0, 2.0, 3.0) == 0.0
    assert least_time(-0.7, 1.0, 2.0, 3.0) == least_time(0.7, 1.0, 2.0, 3.0)


def test_minimum_time_without_jerk_limit_is_that_of_a_trapezoidal_profile():
    assert least_time(2.0, 1.0, 4.0, np.inf) == pytest.approx(2.0 + 1.0 / 4.0)
    assert least_time(0.1, 1.0, 4.0, np.inf) == pytest.approx(2 * sqrt(0.1 / 4.0))


def test_minimum_time_without_acceleration_limit_depends_on_jerk_and_velocity():
    assert least_time(2.0, 1.0, np.inf, 25.0) == pytest.approx(2.0 + 2 * sqrt(1 / 25))


def test_minimum_times_accept_broadcast_arrays():
    times = least_time(np.array([[0.1], [1.0]]), np.array([1.0, 2.0, 4.0]), 10.0, 200.0)
    assert times.shape == (2, 3)
    assert times[1, 2] == least_time(1.0, 4.0, 10.0, 200.0)


@pytest.fixture(scope="module")
def limits():
    robot = Robot.load()
    stall = robot.drives.stall
    return Limits.of(robot, Load(inertia=stall / 100, holding=0.2 * stall))


def test_rest_to_rest_durations_respect_motion_limits_and_duty(limits):
    turns = np.linspace(-1.0, 1.0, len(limits.speed))
    durations = least_rest_times(turns, limits)
    for k, turn in enumerate(turns):
        bounds = [
            (
                min(limits.speed[k], share * limits.duty[k] / limits.viscous[k]),
                min(limits.acceleration[k], (1 - share) * limits.duty[k] / limits.inertial[k]),
            )
            for share in DUTY_FRACTIONS
        ]
        assert durations[k] >= least_time(turn, limits.speed[k], limits.acceleration[k], limits.jerk[k]) - 1e-12
        assert durations[k] <= min(float(least_time(turn, v, a, limits.jerk[k])) for v, a in bounds) + 1e-12


def test_rest_to_rest_durations_accept_arrays_with_leading_dimensions(limits):
    turns = np.random.default_rng(1).uniform(-1, 1, (4, 3, len(limits.speed)))
    durations = least_rest_times(turns, limits)
    assert durations.shape == turns.shape
    np.testing.assert_allclose(durations[2, 1], least_rest_times(turns[2, 1], limits))


def test_minimum_times_of_single_hinge_rotations_equal_those_computed_for_all_hinges_together(robot_limits):
    chance, limits = np.random.default_rng(4), robot_limits
    hinges = chance.integers(0, len(limits.lower), 200)
    turns = chance.uniform(-2.0, 2.0, len(hinges))
    among = np.zeros((len(hinges), len(limits.lower)))
    among[np.arange(len(hinges)), hinges] = turns
    every = least_rest_times(among, limits)[np.arange(len(hinges)), hinges]
    np.testing.assert_array_equal(least_rest_times_of(hinges, turns, limits), every)


@pytest.fixture
def robot_limits():
    robot = Robot.load()
    count = len(robot.skeleton.hinges)
    return Limits.of(robot, Load(holding=np.full(count, 0.3), inertia=np.linspace(0.01, 0.1, count)))


def can_stop(speed, acceleration, most, jerk, seconds, steps=150):
    """Return whether a linear program finds a stop within a given duration."""
    step = seconds / steps
    accelerations = step * np.tril(np.ones((steps, steps)))  # after each step, of jerks that are constant in it
    gained = step * (accelerations - 0.5 * step * np.eye(steps)).sum(axis=0)
    solution = linprog(
        np.zeros(steps),
        A_ub=np.vstack([accelerations, -accelerations]),
        b_ub=np.concatenate([most - acceleration * np.ones(steps), most + acceleration * np.ones(steps)]),
        A_eq=np.vstack([accelerations[-1], gained]),
        b_eq=[-acceleration, -speed - acceleration * seconds],
        bounds=(-jerk, jerk),
    )
    return solution.status == 0


@pytest.mark.parametrize(
    ("speed", "acceleration"),
    [(1.0, 0.0), (-1.0, 0.0), (0.05, 0.0), (1.0, 8.0), (1.0, -8.0), (-0.3, 9.0), (0.0, 5.0), (0.2, -9.0)],
)
def test_stop_duration_is_minimal_and_attainable_within_2_percent(speed, acceleration):
    seconds = float(least_stop(speed, acceleration, 10.0, 250.0))
    assert can_stop(speed, acceleration, 10.0, 250.0, 1.02 * seconds)
    assert not can_stop(speed, acceleration, 10.0, 250.0, 0.98 * seconds)


def test_stop_duration_of_a_hinge_at_standstill_is_zero():
    np.testing.assert_array_equal(least_stop([0.0, 0.0], [0.0, 0.0], 10.0, 250.0), 0.0)


def keys_of(limits, *angles):
    """Return keys 0.5 s apart with the same angle for all hinges."""
    count = len(limits.speed)
    whole = (True,) * count
    return Keys.of(
        [KeyPosture(0.5 * k, sealed(np.full(count, angle)), whole) for k, angle in enumerate(angles)], limits
    )


def test_rest_and_velocity_durations_of_key_intervals_follow_from_the_limits(limits):
    keys = keys_of(limits, 0.0, 0.2, 0.05)
    resting, fastest = compute_rest_durations(keys, limits), compute_velocity_durations(keys, limits)
    assert (
        resting.keys() == fastest.keys() == {(k, pair) for k in range(len(limits.speed)) for pair in ((0, 1), (1, 2))}
    )
    for (hinge, (i, j)), seconds in fastest.items():
        turn = keys.angles[j, hinge] - keys.angles[i, hinge]
        top = min(limits.speed[hinge], limits.duty[hinge] / limits.viscous[hinge])
        assert seconds == pytest.approx(abs(turn) / top)
        least = least_rest_times(np.full(len(limits.speed), turn), limits)[hinge]
        assert resting[hinge, (i, j)] == pytest.approx(1.02 * least + 0.04)
        assert resting[hinge, (i, j)] > seconds > 0.0
