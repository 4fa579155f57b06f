import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import transition
from kinesic.motion.bspline import grid
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.motion.transition import (
    cross_over,
    delay_controls,
    extend_controls,
    join_columns,
    keep_limits,
    knot_at,
    largest_limit_ratios,
    trim_final_rest,
    widen_limits,
)

# limits of one hinge, in the order of the fields of `Limits`
LIMIT_VALUES = (-1.5, 1.5, 4.0, 59.0, 1500.0, 0.01, 0.18, 0.65)
JOINT_LIMITS = Limits(*(sealed([value]) for value in LIMIT_VALUES))  # limits of one hinge


def wave(pieces: int, size: float, period: float) -> np.ndarray:
    return size * np.sin(2 * np.pi * np.arange(pieces + 3) * KNOT_INTERVAL / period)


def share(column: np.ndarray) -> float:
    return grid(len(column) - 3, KNOT_INTERVAL).largest_limit_ratio(column, JOINT_LIMITS, 0)


@pytest.mark.parametrize("leave", [3, 20, 41])
def test_transition_between_two_motions_starts_in_the_first_and_ends_in_the_second(leave):
    own, after = wave(150, 0.4, 1.6), 0.5 + wave(150, 0.3, 2.0)
    way = cross_over(own, after, (leave, leave + 60), widen_limits(JOINT_LIMITS), 0)
    np.testing.assert_array_equal(way[: leave + 3], own[: leave + 3])
    np.testing.assert_array_equal(way[leave + 60 :], after[leave + 60 :])
    assert share(way) <= 1.001


def test_transition_without_enough_time_returns_none():
    own, after = wave(150, 0.4, 1.6), np.full(153, 1.0)
    assert cross_over(own, after, (20, 22), widen_limits(JOINT_LIMITS), 0) is None
    assert cross_over(own, after, (20, 30), widen_limits(JOINT_LIMITS), 0) is None
    assert cross_over(own, after, (20, 80), widen_limits(JOINT_LIMITS), 0) is not None


def test_transition_between_motions_equal_at_its_start_is_the_target_motion():
    own = wave(150, 0.4, 1.6)
    after = own.copy()
    after[100:] = after[99]
    np.testing.assert_array_equal(cross_over(own, after, (40, 41), widen_limits(JOINT_LIMITS), 0), after)


def test_transition_passes_keys_of_the_target_motion():
    own, after = np.zeros(153), 0.5 + wave(150, 0.3, 2.0)
    places = np.array([62.4, 80.0])
    way = cross_over(own, after, (10, 100), widen_limits(JOINT_LIMITS), 0, passing=places)
    reached, wanted = (
        Trajectory(sealed(item[:, None]), 0.0).sample(places * KNOT_INTERVAL)[0] for item in (way, after)
    )
    np.testing.assert_allclose(reached, wanted, atol=1e-9)


def test_limit_correction_changes_a_motion_only_near_its_violation():
    wish = wave(300, 0.2, 1.5)
    wish[150:] += 0.03  # a jump
    assert share(wish) > 10
    column = keep_limits(wish, 0, 300, widen_limits(JOINT_LIMITS), 0)
    assert share(column) <= 1.001
    np.testing.assert_array_equal(column[:100], wish[:100])
    np.testing.assert_array_equal(column[-100:], wish[-100:])
    assert np.abs(column - wish).max() < 0.03


def test_limit_correction_leaves_motion_within_limits_unchanged():
    wish = wave(300, 0.2, 1.5)
    assert keep_limits(wish, 0, 300, JOINT_LIMITS, 0) is wish


def test_largest_limit_ratios_are_computed_per_hinge():
    both = np.stack([wave(100, 0.2, 1.5), wave(100, 0.4, 1.5)], axis=1)
    limits = Limits(*(sealed([value, value]) for value in LIMIT_VALUES))
    one, other = largest_limit_ratios(both, limits)
    assert one == pytest.approx(share(np.ascontiguousarray(both[:, 0])))
    assert other > one


def test_delayed_motion_is_shifted_by_whole_knots():
    motion = np.arange(12.0).reshape(6, 2)
    np.testing.assert_array_equal(delay_controls(motion, 2)[:3], motion[[0, 0, 0]])
    np.testing.assert_array_equal(delay_controls(motion, 2)[2:], motion)
    for knots in (1, 2):
        np.testing.assert_array_equal(delay_controls(motion, -knots), motion[knots:])
    np.testing.assert_array_equal(delay_controls(motion, -50), motion[3:], "three stay at least")
    np.testing.assert_array_equal(extend_controls(motion, 9)[6:], motion[[-1, -1, -1]])
    assert extend_controls(motion, 4) is motion


def test_control_points_of_the_final_rest_of_a_motion_are_trimmed_to_four():
    motion = np.vstack([np.arange(8.0)[:, None], np.full((50, 1), 9.0)])
    np.testing.assert_array_equal(trim_final_rest(motion), motion[:11])
    assert len(trim_final_rest(np.ones((40, 2)))) == 4


def test_knot_number_of_a_time_is_clipped_at_zero_and_unlimited_above():
    assert [knot_at(time) for time in (-1.0, 0.0, 0.0101, 0.02, 99.0)] == [0, 0, 2, 2, 9900]


def test_transition_offset_fades_without_overshoot():
    after = wave(150, 0.3, 2.0)
    way = cross_over(after + 0.2, after, (20, 90), widen_limits(JOINT_LIMITS), 0)
    away = way - after
    assert np.all(np.diff(away) <= 1e-9)
    assert away.min() >= -1e-9
    assert away[:23] == pytest.approx(0.2)
    assert away[90:] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("pieces", "is_found"), [(2, False), (3, True)])
def test_transition_of_a_tiny_offset_needs_at_least_three_knot_intervals(pieces, is_found):
    after = np.zeros(60)
    assert (cross_over(after + 1e-6, after, (20, 20 + pieces), widen_limits(JOINT_LIMITS), 0) is not None) is is_found


def test_infeasible_limit_correction_returns_none():
    wish = np.zeros(103)
    wish[50:] = 1.0
    assert keep_limits(wish, 40, 60, widen_limits(JOINT_LIMITS), 0) is None
    assert keep_limits(wish, 0, 100, widen_limits(JOINT_LIMITS), 0) is not None


@pytest.mark.parametrize("at", [4, 50, 96])
def test_limit_correction_changes_only_control_points_between_the_given_knots(at):
    wish = wave(100, 0.1, 1.5)
    wish[at] += 0.004
    first, last = max(0, at - 20), min(100, at + 20)
    column = keep_limits(wish, first, last, widen_limits(JOINT_LIMITS), 0)
    assert share(column) <= 1.001
    np.testing.assert_array_equal(column[: first + 3], wish[: first + 3])
    np.testing.assert_array_equal(column[last:], wish[last:])


def test_limit_correction_ignores_violations_outside_the_given_knots():
    wish = wave(100, 0.1, 1.5)
    wish[10] += 0.004
    assert keep_limits(wish, 30, 90, widen_limits(JOINT_LIMITS), 0) is wish


@pytest.mark.parametrize("place", [0, -1])
def test_largest_limit_ratio_includes_violations_at_the_motion_ends(place):
    column = np.zeros((60, 1))
    column[place] = 0.01
    (largest_limit_ratio,) = largest_limit_ratios(column, JOINT_LIMITS)
    assert largest_limit_ratio == pytest.approx(share(np.ascontiguousarray(column[:, 0])))
    assert largest_limit_ratio > 1.0


def test_hinge_motions_are_joined_as_columns_unless_one_is_missing():
    one, other = np.arange(5.0), np.ones(5)
    np.testing.assert_array_equal(join_columns([one, other]), np.stack([one, other], axis=1))
    assert join_columns([one, None, other]) is None
    assert join_columns([]) is None


def test_limits_widened_for_rounding_exceed_the_originals_by_at_most_0_1_percent():
    wide = widen_limits(JOINT_LIMITS)
    for name in ("speed", "acceleration", "jerk", "duty"):
        assert 1.0 < getattr(wide, name)[0] / getattr(JOINT_LIMITS, name)[0] <= 1.001
    assert (wide.lower, wide.upper) == (JOINT_LIMITS.lower, JOINT_LIMITS.upper)


def test_transition_offset_fades_as_a_quintic():
    leave, pieces = 20, 60
    angle, velocity, bend = 0.05, 0.003, -0.0002  # [rad], per knot interval and its square
    after = wave(150, 0.2, 2.0)
    steps = np.arange(len(after)) - leave - 1.0
    own = after + angle + velocity * steps + bend * steps**2 / 2 - bend / 6
    loose = Limits(*(sealed([100.0 * value]) for value in LIMIT_VALUES))
    way = cross_over(own, after, (leave, leave + pieces), loose, 0)
    u = np.linspace(0.0, 1.0, pieces + 1)
    faded = (1 - u) ** 3 * (
        angle * (1 + 3 * u + 6 * u**2) + velocity * pieces * (u + 3 * u**2) + bend * pieces**2 * u**2 / 2
    )
    away = (way - after)[leave : leave + pieces + 3]
    np.testing.assert_allclose((away[:-2] + 4 * away[1:-1] + away[2:]) / 6, faded, atol=1e-4)


def test_single_control_point_beyond_a_limit_is_corrected():
    jerks = np.zeros(100)
    jerks[90] = 1600.0 * KNOT_INTERVAL**3
    wish = np.concatenate([np.zeros(3), jerks])
    for _ in range(3):
        wish = np.cumsum(wish)
    ratios = grid(100, KNOT_INTERVAL).limit_ratios(wish, JOINT_LIMITS, 0)
    assert [int((np.abs(ratio) > 1.0).sum()) for ratio in ratios] == [0, 0, 0, 1, 0]
    column = keep_limits(wish, 0, 100, JOINT_LIMITS, 0)
    assert share(column) <= 1.001
    assert share(wish) == pytest.approx(1600.0 / 1500.0)


def test_limit_correction_is_tried_15_and_40_knots_around_the_violations_and_then_everywhere(monkeypatch):
    wish = np.zeros(303)
    wish[150:] = 1.0
    tried = []
    monkeypatch.setattr(transition, "_correct_between", lambda column, low, high, *given: tried.append((low, high)))
    assert keep_limits(wish, 5, 280, JOINT_LIMITS, 0) is None
    assert [(low - tried[0][0], high - tried[0][1]) for low, high in tried[:2]] == [(0, 0), (-25, 25)]
    assert tried[0][0] + 15 < 150 <= tried[0][1] - 15 + 3
    assert tried[2:] == [(5, 280)]
    tried.clear()
    assert keep_limits(wish, 145, 155, JOINT_LIMITS, 0) is None
    assert tried == [(145, 155)], "there is no wider range"
