"""Tests of the first-order model of limit ratios under time warps."""

from itertools import pairwise

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import stretching
from kinesic.motion.budget import Budget
from kinesic.motion.infeasibility import measure_time_deficit
from kinesic.motion.key_time_lp import KeyTimeProblem, shift_cost
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.segments import segments
from kinesic.motion.stretching import TIME_RESERVE, stretch_until_enough
from kinesic.motion.time_warp import _gap_lengthening, _ratio_change, stretch_times
from kinesic.motion.trajectory import KNOT_INTERVAL

# limits of one hinge, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
HURRIED_ROWS = (  # key time [s], angle [rad] and sync point
    (0.0, 0.0, "start"),
    (0.3, 0.6, "ready"),
    (0.52, -0.5, "strokeStart"),
    (0.71, 0.5, "stroke"),
    (0.93, -0.4, "relax"),
    (1.5, 0.0, "end"),
)
# keys with too little time
HURRIED_KEYS = Keys.of(
    tuple(KeyPosture(t, sealed([a]), (True,), (("b", sync),)) for t, a, sync in HURRIED_ROWS), JOINT_LIMITS
)
TIME_PROBLEM = KeyTimeProblem(HURRIED_KEYS, HURRIED_KEYS.gaps, 0.6)  # problem with a lead-in of 0.6 s


def measure(times):
    moving = [segment for segment in segments(times, HURRIED_KEYS, KNOT_INTERVAL) if not segment.is_still]
    return [(segment, measure_time_deficit(segment, JOINT_LIMITS)) for segment in moving]


def test_uniform_time_warp_lengthens_key_intervals_in_proportion():
    (segment, _) = measure(HURRIED_KEYS.requested_times)[0]
    even = np.full(segment.grid.pieces + 2, 0.1)
    assert _gap_lengthening(segment) @ even == pytest.approx(0.1 * np.diff(HURRIED_KEYS.requested_times), abs=1e-9)


def test_uniform_time_warp_reduces_limit_ratios_in_proportion_to_the_derivative_order():
    (segment, result) = measure(HURRIED_KEYS.requested_times)[0]
    grid = segment.grid
    now = grid.rows(JOINT_LIMITS, 0) @ result.controls
    changed = _ratio_change(segment, result.controls, JOINT_LIMITS) @ np.ones(grid.pieces + 2)
    k = grid.pieces
    assert changed[: k + 2] == pytest.approx(-now[: k + 2])
    assert changed[k + 2 : 2 * k + 3] == pytest.approx(-2 * now[k + 2 : 2 * k + 3])
    assert changed[2 * k + 3 : 3 * k + 3] == pytest.approx(-3 * now[2 * k + 3 : 3 * k + 3], abs=1e-9)


def test_one_time_warp_step_more_than_halves_the_time_deficit():
    lacks = measure(HURRIED_KEYS.requested_times)
    assert lacks[0][1].amount > 0.1
    times = stretch_times(
        TIME_PROBLEM, HURRIED_KEYS.requested_times, lacks, limits=JOINT_LIMITS, radius=0.4, reserves=[TIME_RESERVE]
    )
    assert measure(times)[0][1].amount < 0.5 * lacks[0][1].amount


def test_repeated_time_warp_steps_reach_feasible_key_times_at_low_cost():
    times = stretch_until_enough(TIME_PROBLEM, HURRIED_KEYS.requested_times, JOINT_LIMITS, measure)
    assert measure(times)[0][1].amount <= -TIME_RESERVE / 4
    assert shift_cost(HURRIED_KEYS, times) < 0.7
    late = HURRIED_KEYS.requested_times + 0.3 * np.maximum(HURRIED_KEYS.requested_times - 0.52, 0.0)
    begun_late = stretch_until_enough(TIME_PROBLEM, late, JOINT_LIMITS, measure)
    assert shift_cost(HURRIED_KEYS, times) == pytest.approx(shift_cost(HURRIED_KEYS, begun_late), rel=0.25, abs=0.05)


def test_key_times_that_are_already_feasible_are_not_stretched():
    slow = 3.0 * HURRIED_KEYS.requested_times
    np.testing.assert_array_equal(stretch_until_enough(TIME_PROBLEM, slow, JOINT_LIMITS, measure), slow)


def test_stretching_an_unmeasurable_segment_returns_none():
    unknown = [(segment, None) for segment, _ in measure(HURRIED_KEYS.requested_times)]
    assert stretch_until_enough(TIME_PROBLEM, HURRIED_KEYS.requested_times, JOINT_LIMITS, lambda times: unknown) is None


def steps_of_search(deficits):
    """Return the largest relative stretch of each step under given deficits."""
    tried = []
    stretch_until_enough(
        TIME_PROBLEM,
        HURRIED_KEYS.requested_times,
        JOINT_LIMITS,
        lambda times: deficits(tried.append(times) or times, len(tried)),
    )
    return [float(np.abs(np.diff(times) / np.diff(HURRIED_KEYS.requested_times) - 1.0).max()) for times in tried[1:]]


def test_failing_time_stretching_ends_after_ten_steps_of_which_the_first_five_shrink():
    lacks = measure(HURRIED_KEYS.requested_times)
    steps = steps_of_search(lambda times, number: lacks)
    assert len(steps) == 10
    assert steps[0] > 0.3
    assert all(after < before / 3 for before, after in pairwise(steps[:5]))


def test_time_warp_step_after_an_unmeasurable_segment_is_smaller():
    def deficits(times, number):
        return [(segment, None if number == 2 else deficit) for segment, deficit in measure(times)]

    first, second, *_ = steps_of_search(deficits)
    assert second < first / 3


@pytest.mark.parametrize("radius", [0.02, 0.1])
def test_time_warp_step_is_limited_by_its_radius(radius):
    times = stretch_times(
        TIME_PROBLEM,
        HURRIED_KEYS.requested_times,
        measure(HURRIED_KEYS.requested_times),
        limits=JOINT_LIMITS,
        radius=radius,
        reserves=[TIME_RESERVE],
    )
    change = np.diff(times) / np.diff(HURRIED_KEYS.requested_times) - 1.0
    assert np.abs(change).max() <= radius + 1e-3
    assert np.abs(change).max() > 0.5 * radius


def test_larger_time_reserve_lengthens_stretched_segments():
    lacks = measure(HURRIED_KEYS.requested_times)
    spans = [
        np.ptp(
            stretch_times(
                TIME_PROBLEM, HURRIED_KEYS.requested_times, lacks, limits=JOINT_LIMITS, radius=0.4, reserves=[reserve]
            )
        )
        for reserve in (TIME_RESERVE, 0.02, 0.05)
    ]
    assert spans == sorted(spans)
    assert spans[0] < spans[-1]


def test_time_stretching_with_a_spent_budget_returns_none():
    budget = Budget(1)
    assert stretch_until_enough(TIME_PROBLEM, HURRIED_KEYS.requested_times, JOINT_LIMITS, measure, budget) is None
    assert budget.spent


def test_linear_warp_of_a_parabola_matches_calculus():
    """Stretch the motion t^2 by the time warp s t.

    Velocity falls by 2 s t^2, acceleration by 6 s t and jerk by 6 s.
    """
    (segment, _) = measure(HURRIED_KEYS.requested_times)[0]
    grid, share = segment.grid, 0.3
    k, h = grid.pieces, grid.step
    knots, middles = h * np.arange(k + 1), h * (np.arange(k + 2) - 0.5)
    controls = (h * (np.arange(k + 3) - 1.0)) ** 2 - h**2 / 3
    changed = _ratio_change(segment, controls, JOINT_LIMITS) @ (share * middles)
    speed, acceleration, jerk, duty = np.split(changed, np.cumsum([k + 2, k + 1, k]))
    np.testing.assert_allclose(speed, -2 * share * middles**2 / JOINT_LIMITS.speed)
    np.testing.assert_allclose(acceleration, -6 * share * knots / JOINT_LIMITS.acceleration, atol=1e-9)
    np.testing.assert_allclose(jerk, np.full(k, -6 * share) / JOINT_LIMITS.jerk, atol=1e-9)
    needed = JOINT_LIMITS.inertial * 6 * share * knots + JOINT_LIMITS.viscous * 2 * share * knots**2
    np.testing.assert_allclose(duty, -needed / grid.duty(JOINT_LIMITS)[0], rtol=1e-3, atol=1e-6)


def test_parabolic_warp_of_a_uniform_motion_matches_calculus():
    """Stretch the motion v t by the time warp s t^2.

    Acceleration falls by 2 s t v and jerk by 2 s v.
    """
    (segment, _) = measure(HURRIED_KEYS.requested_times)[0]
    grid, share, speed = segment.grid, 0.3, 2.0
    k, h = grid.pieces, grid.step
    knots, middles = h * np.arange(k + 1), h * (np.arange(k + 2) - 0.5)
    changed = _ratio_change(segment, speed * h * (np.arange(k + 3) - 1.0), JOINT_LIMITS) @ (share * middles**2)
    _, acceleration, jerk, _ = np.split(changed, np.cumsum([k + 2, k + 1, k]))
    np.testing.assert_allclose(acceleration, -2 * share * speed * knots / JOINT_LIMITS.acceleration, atol=1e-9)
    np.testing.assert_allclose(jerk, np.full(k, -2 * share * speed) / JOINT_LIMITS.jerk, rtol=1e-6)


def test_stretched_times_are_kept_if_the_exact_solution_fails(monkeypatch):
    asked = []

    def fail(problem):
        asked.append(problem.gaps)
        raise ArithmeticError("the planes contradict each other")

    monkeypatch.setattr(stretching, "solve_key_times", fail)
    deficits = measure(HURRIED_KEYS.requested_times)
    times = HURRIED_KEYS.requested_times * 1.1
    previous = stretching._Candidate(HURRIED_KEYS.requested_times, deficits, 0.0)
    np.testing.assert_array_equal(stretching._solve_exactly(TIME_PROBLEM, times, previous), times)
    for (i, j), gap in asked[0].items():
        assert times[j] - times[i] <= gap + 1e-9
        assert gap - (times[j] - times[i]) < 2 * stretching.GAP_RESOLUTION
