from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import CALMNESS_REGULARISATION, JERK_TIME, at_knots, grid
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory

from ..reference.motion import spline_programs as reference

# limits of one hinge, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
KNOT_GRID = grid(20, KNOT_INTERVAL)  # grid of 20 knot intervals
CONTROL_ANGLES = 0.02 * np.random.default_rng(11).normal(size=(23, 1))  # [rad] random control points of one hinge
RANDOM_MOTION = Trajectory(CONTROL_ANGLES, 0.0)  # motion through the control points
SAMPLE_TIMES = np.linspace(0.0, RANDOM_MOTION.duration, 8001)[:-1]  # [s] 400 sample times per knot interval


def test_product_of_limit_matrix_and_control_points_gives_the_limit_ratios():
    rows = np.abs(KNOT_GRID.rows(JOINT_LIMITS, 0) @ CONTROL_ANGLES[:, 0])
    shares = [np.abs(share) for share in KNOT_GRID.limit_ratios(CONTROL_ANGLES[:, 0], JOINT_LIMITS, 0)]
    np.testing.assert_allclose(rows, np.concatenate(shares[1:]))
    np.testing.assert_allclose(shares[0], np.abs(CONTROL_ANGLES[:, 0]) / 2)


def test_limit_ratios_of_control_points_bound_the_motion_between_knots():
    _, speeds, accelerations = RANDOM_MOTION.sample(SAMPLE_TIMES)
    duty = JOINT_LIMITS.inertial * accelerations + JOINT_LIMITS.viscous * speeds
    jerks = RANDOM_MOTION.jerks(SAMPLE_TIMES)
    shares = [float(np.abs(share).max()) for share in KNOT_GRID.limit_ratios(CONTROL_ANGLES[:, 0], JOINT_LIMITS, 0)][1:]
    for values, limit, share in zip((speeds, accelerations, jerks), (4, 40, 1e3), shares[:3], strict=True):
        assert np.abs(values).max() / limit <= share + 1e-9
    rise = JOINT_LIMITS.viscous[0] * np.abs(jerks).max() * KNOT_INTERVAL**2 / 8  # of a parabola over its chord
    assert np.abs(duty).max() <= shares[3] * KNOT_GRID.duty(JOINT_LIMITS)[0] + rise + 1e-9


def test_angles_computed_at_the_knots_equal_samples_of_the_motion():
    np.testing.assert_allclose(at_knots(CONTROL_ANGLES[:, 0]), RANDOM_MOTION.sample(KNOT_GRID.knots)[0][:, 0])


def form_of(bands):
    """Return the full symmetric matrix of a banded one in upper form."""
    width = len(bands) - 1
    upper = sum(np.diag(bands[width - band, band:], band) for band in range(width + 1))
    return upper + np.triu(upper, 1).T


def test_banded_closeness_matrix_equals_the_sparse_closeness_matrix():
    np.testing.assert_array_equal(form_of(KNOT_GRID.closeness_bands), reference.closeness(KNOT_GRID).toarray())


def test_smoothness_cost_sums_squared_acceleration_and_jerk():
    form, x = form_of(KNOT_GRID.calmness_bands), CONTROL_ANGLES[:, 0]
    squares = (
        np.sum(np.diff(x, 2) ** 2)
        + np.sum((JERK_TIME / KNOT_INTERVAL * np.diff(x, 3)) ** 2)
        + CALMNESS_REGULARISATION * x @ x
    )
    assert x @ form @ x == pytest.approx(squares)


def test_range_ratio_of_a_hinge_with_equal_lower_and_upper_limit_is_zero():
    stuck = Limits(*(sealed([value]) for value in (0.5, 0.5, 4, 40, 1e3, 0.01, 0.15, 0.7)))
    assert KNOT_GRID.limit_ratios(np.full(23, 0.5), stuck, 0)[0] == pytest.approx(0.0)


def test_limit_rows_have_bound_one_exactly_if_they_depend_on_inner_control_points():
    rows = reference.sparse(KNOT_GRID.rows(JOINT_LIMITS, 0)).toarray()
    inner = np.any(rows[:, 3:-3] != 0.0, axis=1)
    np.testing.assert_array_equal(KNOT_GRID.bounds == 1.0, inner)


# limits of two hinges, in the order of the fields of `Limits`
LIMIT_ROWS = ([-1, -2], [3, 0.5], [4, 2], [40, 90], [1e3, 700], [0.01, 0.02], [0.15, 0.05], [0.7, 0.4])
PAIR_LIMITS = Limits(*map(sealed, LIMIT_ROWS))  # limits of two hinges


def test_knots_control_points_and_limit_rows_are_counted_from_the_knot_intervals():
    small = grid(5, 0.02)
    np.testing.assert_allclose(small.knots, [0.0, 0.02, 0.04, 0.06, 0.08, 0.1])
    assert (small.size, small.counts) == (8, (7, 6, 5, 6))
    assert len(small.bounds) == len(small.powers) == sum(small.counts)
    assert grid(5, 0.02) is small, "the same grid is kept"


def test_limit_rows_of_only_fixed_control_points_have_twice_the_bound():
    groups = np.split(grid(6, KNOT_INTERVAL).bounds, np.cumsum(grid(6, KNOT_INTERVAL).counts)[:-1])
    assert [group.tolist() for group in groups] == [
        [2, 2, 1, 1, 1, 1, 2, 2],
        [2, 1, 1, 1, 1, 1, 2],
        [1] * 6,
        [2, 1, 1, 1, 1, 1, 2],
    ]


def test_limit_rows_list_position_kind_and_time_exponent_of_their_limits():
    free = grid(3, KNOT_INTERVAL).free_rows
    assert free.kinds.tolist() == [0, 1, 1, 2, 2, 2, 3, 3]
    assert free.places == pytest.approx([1.5, 1, 2, 0, 1.5, 3, 1, 2])
    assert free.powers.tolist() == [1, 2, 2, 3, 3, 3, 2, 2]


@pytest.mark.parametrize("stretch", [0.5, 3.0])
def test_limit_ratios_scale_with_the_time_exponent_of_each_limit(stretch):
    light = replace(JOINT_LIMITS, viscous=sealed([0.0]))
    usual, slow = (
        [*g.limit_ratios(CONTROL_ANGLES[:, 0], light, 0)] for g in (KNOT_GRID, grid(20, stretch * KNOT_INTERVAL))
    )
    np.testing.assert_allclose(slow[0], usual[0])
    powers = np.split(KNOT_GRID.powers, np.cumsum(KNOT_GRID.counts)[:-1])
    for one, other, power in zip(usual[1:], slow[1:], powers, strict=True):
        np.testing.assert_allclose(other * stretch**power, one)


def test_limit_ratios_of_several_hinges_equal_those_of_single_hinges():
    controls = np.random.default_rng(4).normal(size=(3, 12))
    own, hinges = grid(9, KNOT_INTERVAL), np.array([1, 0, 1])
    together = own.limit_ratios(controls, PAIR_LIMITS, hinges)
    for row, hinge in enumerate(hinges.tolist()):
        alone = own.limit_ratios(controls[row], PAIR_LIMITS, hinge)
        for one, many in zip(alone, together, strict=True):
            np.testing.assert_allclose(many[row], one)
        rows = own.rows(PAIR_LIMITS, hinge) @ controls[row]
        np.testing.assert_allclose(rows, np.concatenate(alone[1:]))
        assert own.largest_limit_ratio(controls[row], PAIR_LIMITS, hinge) == max(np.abs(part).max() for part in alone)


def test_range_ratio_is_one_at_the_upper_limit_and_minus_one_at_the_lower():
    for hinge in (0, 1):
        ends = np.array(
            [
                PAIR_LIMITS.lower[hinge],
                PAIR_LIMITS.upper[hinge],
                (PAIR_LIMITS.lower[hinge] + PAIR_LIMITS.upper[hinge]) / 2,
                0,
            ]
        )
        assert grid(1, KNOT_INTERVAL).limit_ratios(ends, PAIR_LIMITS, hinge)[0][:3] == pytest.approx([-1.0, 1.0, 0.0])


def test_largest_limit_ratio_counts_motion_in_both_directions():
    for controls in (CONTROL_ANGLES[:, 0], -CONTROL_ANGLES[:, 0]):
        jerks = np.diff(controls, 3) / KNOT_INTERVAL**3 / 1e3
        assert KNOT_GRID.largest_limit_ratio(controls, JOINT_LIMITS, 0) == pytest.approx(np.abs(jerks).max())


def test_fixed_hinge_has_an_assumed_range_of_one_nanoradian():
    stuck = replace(JOINT_LIMITS, lower=sealed([0.5]), upper=sealed([0.5]))
    assert KNOT_GRID.limit_ratios(np.full(23, 0.5 + 1e-9), stuck, 0)[0] == pytest.approx(2.0, rel=1e-6)


def test_duty_bound_at_the_knots_allows_for_the_parabola_between_them():
    assert grid(9, KNOT_INTERVAL).duty(PAIR_LIMITS) == pytest.approx(
        [0.7 - 0.15 * 0.1 / 8, 0.4 - 0.05 * 0.07 / 8], rel=1e-12
    )
    acceleration, jerk, velocity = -9.0, 1e3, 0.1
    times = np.linspace(0.0, KNOT_INTERVAL, 101)
    duty = 0.15 * (velocity + acceleration * times - jerk * times**2 / 2) + 0.01 * (acceleration - jerk * times)
    chord = np.interp(times, times[[0, -1]], duty[[0, -1]])
    assert np.max(duty - chord) == pytest.approx(0.7 - grid(9, KNOT_INTERVAL).duty(PAIR_LIMITS)[0])


def test_smoothness_costs_of_jerk_and_acceleration_are_equal_for_a_wave_of_20_radians_per_second():
    long = grid(2000, 1e-3)
    wave = np.sin(20.0 * 1e-3 * np.arange(long.size))
    cost = wave @ form_of(long.calmness_bands) @ wave
    assert cost == pytest.approx(2.0 * np.sum(np.diff(wave, 2) ** 2), rel=2e-2)


def test_smoothness_cost_of_a_constant_posture_is_almost_zero():
    posture = np.ones(KNOT_GRID.size)
    assert posture @ form_of(KNOT_GRID.calmness_bands) @ posture == pytest.approx(1e-10 * KNOT_GRID.size, rel=1e-3)


def test_closeness_cost_sums_squared_angles_and_a_little_squared_acceleration_at_the_knots():
    x = CONTROL_ANGLES[:, 0]
    cost = np.sum(at_knots(x) ** 2) + 1e-9 * np.sum((np.diff(x, 2) / KNOT_INTERVAL**2) ** 2)
    assert x @ form_of(KNOT_GRID.closeness_bands) @ x == pytest.approx(cost)
