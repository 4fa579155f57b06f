"""Tests of spline programs whose limits are just kept or just exceeded."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import at_knots, grid
from kinesic.motion.easing import minimum_jerk
from kinesic.motion.segments import SplineSegment
from kinesic.motion.spline_program import (
    CLOSENESS_STENCILS,
    _linear_part,
    can_pass,
    nearest_motion,
    nearest_within_limits,
    nearest_without_limits,
    relax_limits,
    smoothest,
)
from kinesic.motion.trajectory import KNOT_INTERVAL

# limits of one hinge, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
KNOT_INTERVALS = 60  # number of knot intervals of each segment
# [rad] desired angles at the knots: minimum jerk over 0.5 rad
DESIRED_ANGLES = 0.5 * minimum_jerk(np.linspace(0.0, 1.0, KNOT_INTERVALS + 1))


def segment(end: float = 0.5) -> SplineSegment:
    return SplineSegment(0, 0, grid(KNOT_INTERVALS, KNOT_INTERVAL), 0.0, end, np.array([]), np.array([]))


def with_speed(speed: float) -> Limits:
    return replace(JOINT_LIMITS, speed=sealed([speed]))


def top_speed(controls: Floats) -> float:
    return float(np.abs(np.diff(controls)).max() / KNOT_INTERVAL)


@pytest.mark.parametrize(("share", "is_kept"), [(1.0 - 1e-10, True), (1.0 + 1e-3, True), (1.0 - 1e-4, False)])
def test_unlimited_motion_is_changed_only_if_it_exceeds_a_limit(share, is_kept):
    free = nearest_without_limits(segment(), DESIRED_ANGLES)
    limited = nearest_motion(segment(), DESIRED_ANGLES, with_speed(share * top_speed(free)))
    assert np.array_equal(limited, free) is is_kept
    assert top_speed(limited) <= share * top_speed(free) * (1.0 + 1e-6)


def test_limit_excess_above_1e_9_is_corrected():
    free = nearest_without_limits(segment(), DESIRED_ANGLES)
    for excess, is_kept in ((0.5e-9, True), (1.6e-9, False)):
        limits = with_speed(top_speed(free) / (1.0 + excess))
        assert np.array_equal(nearest_motion(segment(), DESIRED_ANGLES, limits), free) is is_kept


def test_unlimited_motion_minimises_distance_plus_weighted_squared_acceleration():
    way, random = segment(), np.random.default_rng(2)
    wish = DESIRED_ANGLES + random.normal(0.0, 0.01, KNOT_INTERVALS + 1)

    def cost(controls: Floats) -> float:
        accelerations = np.diff(controls, 2) / KNOT_INTERVAL**2
        return float(np.sum((at_knots(controls) - wish) ** 2) + 1e-9 * np.sum(accelerations**2))

    best = nearest_without_limits(way, wish)
    for _ in range(20):
        change = np.zeros(KNOT_INTERVALS + 3)
        change[3:-3] = random.normal(0.0, 1e-3, KNOT_INTERVALS - 3)
        assert cost(best) < min(cost(best + change), cost(best - change))
        assert cost(best + change) == pytest.approx(cost(best - change), rel=1e-6)


def test_linear_cost_of_a_spline_program_is_the_scalar_product_with_the_desired_motion():
    random = np.random.default_rng(3)
    wish, controls = random.normal(size=KNOT_INTERVALS + 1), random.normal(size=KNOT_INTERVALS + 3)
    assert _linear_part(segment(), wish) @ controls == pytest.approx(wish @ at_knots(controls))


def test_closeness_stencils_give_angle_and_weighted_acceleration_at_a_knot():
    assert CLOSENESS_STENCILS[0] == pytest.approx([1 / 6, 4 / 6, 1 / 6])
    assert CLOSENESS_STENCILS[1] ** 2 == pytest.approx(np.array([1e-1, 4e-1, 1e-1]))
    assert np.sign(CLOSENESS_STENCILS[1]).tolist() == [1, -1, 1]


def test_smoothest_motion_minimises_squared_acceleration_and_weighted_squared_jerk():
    way, random = segment(), np.random.default_rng(6)

    def cost(controls: Floats) -> float:
        accelerations, jerks = np.diff(controls, 2), np.diff(controls, 3) / KNOT_INTERVAL
        return float(np.sum(accelerations**2) + np.sum((0.05 * jerks) ** 2))

    best = smoothest(way)
    np.testing.assert_allclose(best[[0, 1, 2, -3, -2, -1]], [0, 0, 0, 0.5, 0.5, 0.5], atol=1e-9)
    for _ in range(20):
        change = np.zeros(KNOT_INTERVALS + 3)
        change[3:-3] = random.normal(0.0, 1e-3, KNOT_INTERVALS - 3)
        assert cost(best + change) == pytest.approx(cost(best - change), rel=1e-3)


def test_hinge_with_equal_key_angles_stays_constant_for_any_desired_motion():
    np.testing.assert_array_equal(nearest_without_limits(segment(0.0), DESIRED_ANGLES), np.zeros(KNOT_INTERVALS + 3))
    assert not np.array_equal(
        nearest_without_limits(replace(segment(0.0), has_path=True), DESIRED_ANGLES), np.zeros(KNOT_INTERVALS + 3)
    )


def test_segment_is_feasible_if_and_only_if_its_limits_need_no_relaxation():
    way = segment(1.2)
    free = relax_limits(way, JOINT_LIMITS, easy=-0.2, desired=2.4 * DESIRED_ANGLES).amount
    answers = []
    for scale in (0.4, 0.6, 0.7, 0.8, 0.9, 1.0, 1.5):
        limits = JOINT_LIMITS.scaled(scale)
        needed = relax_limits(way, limits, easy=-0.2, desired=2.4 * DESIRED_ANGLES).amount
        answers.append(can_pass(way, 2.4 * DESIRED_ANGLES, limits))
        assert answers[-1] == (needed <= 1e-6)
        assert answers[-1] == (nearest_within_limits(way, 2.4 * DESIRED_ANGLES, limits) is not None)
    assert free < 0.0
    assert answers[0] is False
    assert answers[-1] is True


@pytest.mark.parametrize("easy", [-0.05, -0.2])
def test_relaxation_of_ample_limits_ends_at_the_given_minimum(easy):
    way = SplineSegment(0, 0, grid(400, KNOT_INTERVAL), 0.0, 0.1, np.array([]), np.array([]))
    assert relax_limits(way, JOINT_LIMITS, easy=easy).amount == pytest.approx(easy, abs=1e-5)


def test_relaxation_search_ends_early_at_a_given_target():
    way = segment(1.2)
    exact = relax_limits(way, JOINT_LIMITS, easy=-0.2)
    early = relax_limits(way, JOINT_LIMITS, easy=-0.2, target=exact.amount + 0.1)
    assert exact.amount < early.amount <= exact.amount + 0.1
    same = relax_limits(way, JOINT_LIMITS, easy=-0.2, target=exact.amount - 0.1)
    assert same.amount == pytest.approx(exact.amount, abs=1e-6)
    assert exact.controls.shape == (KNOT_INTERVALS + 3,)
