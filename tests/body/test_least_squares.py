"""Tests of bounded least squares, compared with SciPy and known minima."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from kinesic.body.least_squares import minimise_squares

INFINITE_BOUNDS = np.full(2, np.inf)  # upper bounds of two unbounded variables


def rosenbrock(values):
    x, y = values
    return np.array([10.0 * (y - x**2), 1.0 - x])


def decaying_waves(values):
    """Return residuals with four unknowns and several minima."""
    times = np.linspace(0.0, 2.0, 40)
    amplitude, frequency, decay, offset = values
    return amplitude * np.sin(frequency * times) * np.exp(-decay * times) + offset - np.cos(3.0 * times)


@pytest.mark.parametrize("start", [(-1.2, 1.0), (3.0, -2.0), (0.0, 0.0)])
def test_least_squares_minimum_without_bounds_is_found(start):
    solution = minimise_squares(
        rosenbrock, np.array(start), bounds=(-INFINITE_BOUNDS, INFINITE_BOUNDS), max_evaluations=60
    )
    np.testing.assert_allclose(solution.values, [1.0, 1.0], atol=1e-5)
    assert solution.cost == pytest.approx(0.0, abs=1e-9)
    assert not solution.values.flags.writeable


@pytest.mark.parametrize("seed", range(12))
def test_bounded_least_squares_minimum_matches_scipy(seed):
    random = np.random.default_rng(seed)
    lower, upper = random.uniform([-2.0, 0.0, -1.0, -0.5], 0.4), random.uniform(0.5, [2.0, 5.0, 1.0, 0.6])
    start = random.uniform(lower, upper)
    solution = minimise_squares(decaying_waves, start, bounds=(lower, upper), max_evaluations=200)
    assert (lower <= solution.values).all()
    assert (solution.values <= upper).all()
    polished = least_squares(
        decaying_waves, np.clip(solution.values, lower + 1e-9, upper - 1e-9), bounds=(lower, upper)
    )
    assert solution.cost <= polished.cost * (1.0 + 1e-5)


def test_bounded_minimum_lies_on_the_upper_bound_of_a_variable():
    upper = np.array([0.5, np.inf])
    solution = minimise_squares(rosenbrock, np.array([-1.2, 1.0]), bounds=(-INFINITE_BOUNDS, upper), max_evaluations=60)
    np.testing.assert_allclose(solution.values, [0.5, 0.25], atol=1e-5)


def test_least_squares_variable_with_equal_bounds_stays_fixed():
    lower, upper = np.array([0.3, -9.0]), np.array([0.3, 9.0])
    solution = minimise_squares(rosenbrock, np.array([0.3, 4.0]), bounds=(lower, upper), max_evaluations=60)
    np.testing.assert_allclose(solution.values, [0.3, 0.09], atol=1e-5)


def test_least_squares_search_from_a_lower_bound_reaches_the_unbounded_minimum():
    lower = np.array([-1.2, -9.0])
    solution = minimise_squares(rosenbrock, np.array([-1.2, -9.0]), bounds=(lower, INFINITE_BOUNDS), max_evaluations=60)
    np.testing.assert_allclose(solution.values, [1.0, 1.0], atol=1e-5)


def test_least_squares_evaluation_limit_excludes_evaluations_of_the_jacobian():
    counts = {"residuals": 0, "jacobian": 0}

    def residuals(values):
        counts["residuals"] += 1
        return rosenbrock(values)

    def jacobian(values):
        counts["jacobian"] += 1
        return np.array([[-20.0 * values[0], 10.0], [-1.0, 0.0]])

    minimise_squares(
        residuals,
        np.array([-1.2, 1.0]),
        bounds=(-INFINITE_BOUNDS, INFINITE_BOUNDS),
        max_evaluations=5,
        jacobian=jacobian,
    )
    assert counts["residuals"] == 5
    assert counts["jacobian"] <= 5


def test_least_squares_search_with_a_larger_tolerance_ends_earlier():
    def count(tolerance):
        points = []
        minimise_squares(
            lambda values: points.append(values) or rosenbrock(values),
            np.array([-1.2, 1.0]),
            bounds=(-INFINITE_BOUNDS, INFINITE_BOUNDS),
            max_evaluations=60,
            tolerance=tolerance,
        )
        return len(points)

    assert count(0.5) < count(1e-8)


def test_least_squares_search_that_cannot_reduce_the_cost_returns_its_start():
    start = np.array([1.0, 2.0])
    found = minimise_squares(
        lambda values: values,
        start,
        bounds=(np.full(2, -9.0), np.full(2, 9.0)),
        max_evaluations=200,
        jacobian=lambda values: -np.eye(2),  # points away from the minimum
    )
    assert found.values.tolist() == start.tolist()
