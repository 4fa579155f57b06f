import numpy as np
import pytest

from kinesic.body.arrays import Floats
from kinesic.ik.box_lm import Box, descend

FULL_MOBILITY = np.ones(3)  # mobility 1 of each variable


def _line(angles: Floats) -> tuple[Floats, Floats]:
    """Return residual and Jacobian of the equation sum(variables) = 2."""
    return np.array([2.0 - angles.sum()]), np.ones((1, 3))


def test_least_squares_compensates_for_a_bounded_variable_with_others():
    box = Box(np.zeros(3), np.array([0.1, 5.0, 5.0]), np.zeros(3), FULL_MOBILITY)
    descent = descend(_line, np.zeros(3), box, tolerance=1e-9)
    assert descent.miss < 1e-9
    assert descent.angles[0] == 0.1
    assert descent.angles[1] == pytest.approx(descent.angles[2])


def test_least_squares_variable_without_mobility_keeps_its_value():
    box = Box(-5 * FULL_MOBILITY, 5 * FULL_MOBILITY, FULL_MOBILITY, np.array([0.0, 1.0, 1.0]))
    descent = descend(_line, np.zeros(3), box, tolerance=1e-9)
    assert descent.angles[0] == 0.0
    assert descent.miss < 1e-9


def test_least_squares_variable_with_low_mobility_moves_less():
    box = Box(-5 * FULL_MOBILITY, 5 * FULL_MOBILITY, np.zeros(3), np.array([0.1, 1.0, 1.0]))
    descent = descend(_line, np.zeros(3), box, tolerance=1e-9)
    assert descent.miss < 1e-9
    assert 0.0 < descent.angles[0] < 0.2 * descent.angles[1]


def test_preferred_posture_of_a_least_squares_solution_acts_only_in_the_null_space():
    home = np.array([2.0, 1.0, -1.0])
    box = Box(-5 * FULL_MOBILITY, 5 * FULL_MOBILITY, home, FULL_MOBILITY)
    near, far = np.array([2.5, 0.0, 0.0]), np.array([5.0, -5.0, 5.0])
    for start in (near, far):
        descent = descend(_line, start, box, tolerance=1e-9)
        assert descent.miss < 1e-9
        assert np.linalg.norm(descent.angles - home) < np.linalg.norm(start - home)


def test_infeasible_least_squares_problem_ends_at_the_best_point():
    box = Box(np.zeros(3), 0.5 * FULL_MOBILITY, np.zeros(3), FULL_MOBILITY)
    descent = descend(_line, np.zeros(3), box, tolerance=1e-9)
    assert descent.miss == pytest.approx(0.5, abs=1e-6)
    assert descent.rounds <= 40
