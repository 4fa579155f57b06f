from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import ANCHOR, CALM, grid
from kinesic.motion.trajectory import STEP, Trajectory

LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
GRID = grid(20, STEP)
CONTROLS = 0.02 * np.random.default_rng(11).normal(size=(23, 1))
MOTION = Trajectory(CONTROLS, 0.0)
TIMES = np.linspace(0.0, MOTION.duration, 8001)[:-1]


def test_rows_are_the_shares_of_the_limits():
    rows = np.abs(GRID.rows(LIMITS, 0) @ CONTROLS[:, 0])
    shares = [np.abs(share) for share in GRID.shares(CONTROLS[:, 0], LIMITS, 0)]
    np.testing.assert_allclose(rows, np.concatenate(shares[1:]))
    np.testing.assert_allclose(shares[0], np.abs(CONTROLS[:, 0]) / 2)


def test_what_holds_on_the_control_points_holds_between_the_knots():
    _, speeds, accelerations = MOTION.sample(TIMES)
    duty = LIMITS.inertial * accelerations + LIMITS.viscous * speeds
    jerks = MOTION.jerks(TIMES)
    shares = [float(np.abs(share).max()) for share in GRID.shares(CONTROLS[:, 0], LIMITS, 0)][1:]
    for values, limit, share in zip((speeds, accelerations, jerks), (4, 40, 1e3), shares[:3], strict=True):
        assert np.abs(values).max() / limit <= share + 1e-9
    rise = LIMITS.viscous[0] * np.abs(jerks).max() * STEP**2 / 8  # of a parabola over its chord
    assert np.abs(duty).max() <= shares[3] * GRID.duty(LIMITS)[0] + rise + 1e-9


def test_angles_at_the_knots_are_those_of_the_motion():
    np.testing.assert_allclose(GRID.at_knots @ CONTROLS[:, 0], MOTION.sample(GRID.knots)[0][:, 0])


def form_of(bands):
    """The whole symmetric matrix of bands in upper form."""
    width = len(bands) - 1
    upper = sum(np.diag(bands[width - band, band:], band) for band in range(width + 1))
    return upper + np.triu(upper, 1).T


def test_bands_are_the_diagonals_of_their_form():
    np.testing.assert_array_equal(form_of(GRID.closeness_bands), GRID.closeness.toarray())


def test_calmness_is_the_sum_of_the_squares_of_acceleration_and_jerk():
    form, x = form_of(GRID.calmness_bands), CONTROLS[:, 0]
    squares = np.sum(np.diff(x, 2) ** 2) + np.sum((CALM / STEP * np.diff(x, 3)) ** 2) + ANCHOR * x @ x
    assert x @ form @ x == pytest.approx(squares)


def test_a_hinge_that_cannot_move_has_a_share():
    stuck = Limits(*(sealed([value]) for value in (0.5, 0.5, 4, 40, 1e3, 0.01, 0.15, 0.7)))
    assert GRID.shares(np.full(23, 0.5), stuck, 0)[0] == pytest.approx(0.0)


def test_rows_that_follow_from_the_ends_are_free():
    rows = GRID.rows(LIMITS, 0).toarray()
    inner = np.any(rows[:, 3:-3] != 0.0, axis=1)
    np.testing.assert_array_equal(GRID.bounds == 1.0, inner)


@pytest.mark.parametrize(
    ("row", "names"), [*enumerate((["lower", "upper"], ["speed"], ["acceleration"], ["jerk"], []))]
)
def test_what_keeps_a_share_of_the_limits_takes_no_more_of_any(row: int, names: list[str]):
    controls = CONTROLS[:, 0]
    share = np.abs(GRID.shares(controls, LIMITS, 0)[row]).max()
    most = 2.0 * GRID.largest(controls, LIMITS, 0)
    tighter = {name: getattr(LIMITS, name) * share / most for name in names}
    limits = replace(LIMITS, **(tighter or {"inertial": LIMITS.inertial * 1.1 * most / share}))
    own = GRID.largest(controls, limits, 0)
    assert own == pytest.approx(most, rel=0.2), "the tightened limit is the tightest one"
    assert not GRID.keeps(controls, limits, 0, 0.999 * own)
    assert GRID.keeps(controls, limits, 0, 1.5 * own)
