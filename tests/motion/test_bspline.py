import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import CALMNESS_REGULARISATION, JERK_TIME, at_knots, grid
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory

from ..reference.motion import spline_programs as reference

LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
GRID = grid(20, KNOT_INTERVAL)
CONTROLS = 0.02 * np.random.default_rng(11).normal(size=(23, 1))
MOTION = Trajectory(CONTROLS, 0.0)
TIMES = np.linspace(0.0, MOTION.duration, 8001)[:-1]


def test_limit_matrix_rows_give_the_limit_ratios():
    rows = np.abs(GRID.rows(LIMITS, 0) @ CONTROLS[:, 0])
    shares = [np.abs(share) for share in GRID.limit_ratios(CONTROLS[:, 0], LIMITS, 0)]
    np.testing.assert_allclose(rows, np.concatenate(shares[1:]))
    np.testing.assert_allclose(shares[0], np.abs(CONTROLS[:, 0]) / 2)


def test_limit_ratios_of_control_points_bound_the_motion_between_knots():
    _, speeds, accelerations = MOTION.sample(TIMES)
    duty = LIMITS.inertial * accelerations + LIMITS.viscous * speeds
    jerks = MOTION.jerks(TIMES)
    shares = [float(np.abs(share).max()) for share in GRID.limit_ratios(CONTROLS[:, 0], LIMITS, 0)][1:]
    for values, limit, share in zip((speeds, accelerations, jerks), (4, 40, 1e3), shares[:3], strict=True):
        assert np.abs(values).max() / limit <= share + 1e-9
    rise = LIMITS.viscous[0] * np.abs(jerks).max() * KNOT_INTERVAL**2 / 8  # of a parabola over its chord
    assert np.abs(duty).max() <= shares[3] * GRID.duty(LIMITS)[0] + rise + 1e-9


def test_angles_computed_at_the_knots_equal_samples_of_the_motion():
    np.testing.assert_allclose(at_knots(CONTROLS[:, 0]), MOTION.sample(GRID.knots)[0][:, 0])


def form_of(bands):
    """Return the full symmetric matrix of a banded one in upper form."""
    width = len(bands) - 1
    upper = sum(np.diag(bands[width - band, band:], band) for band in range(width + 1))
    return upper + np.triu(upper, 1).T


def test_banded_closeness_matrix_equals_the_sparse_closeness_matrix():
    np.testing.assert_array_equal(form_of(GRID.closeness_bands), reference.closeness(GRID).toarray())


def test_smoothness_cost_sums_squared_acceleration_and_jerk():
    form, x = form_of(GRID.calmness_bands), CONTROLS[:, 0]
    squares = (
        np.sum(np.diff(x, 2) ** 2)
        + np.sum((JERK_TIME / KNOT_INTERVAL * np.diff(x, 3)) ** 2)
        + CALMNESS_REGULARISATION * x @ x
    )
    assert x @ form @ x == pytest.approx(squares)


def test_range_ratio_of_a_hinge_with_equal_limits_is_finite():
    stuck = Limits(*(sealed([value]) for value in (0.5, 0.5, 4, 40, 1e3, 0.01, 0.15, 0.7)))
    assert GRID.limit_ratios(np.full(23, 0.5), stuck, 0)[0] == pytest.approx(0.0)


def test_limit_rows_have_bound_one_exactly_if_they_depend_on_inner_control_points():
    rows = reference.sparse(GRID.rows(LIMITS, 0)).toarray()
    inner = np.any(rows[:, 3:-3] != 0.0, axis=1)
    np.testing.assert_array_equal(GRID.bounds == 1.0, inner)
