"""Tests of bottlenecks, binding limits and gradients of a time deficit."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import infeasibility
from kinesic.motion.bspline import grid
from kinesic.motion.infeasibility import (
    Infeasibility,
    _find_binding_limits,
    estimate_limit_ratio,
    find_bottlenecks,
    find_limiting_intervals,
    find_velocity_bottlenecks,
    make_cutting_planes,
    measure_time_deficit,
)
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.segments import SplineSegment
from kinesic.motion.trajectory import KNOT_INTERVAL

# limits of one hinge, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
# limits of two hinges, in the order of the fields of `Limits`
PAIR_LIMITS = Limits(
    *map(sealed, ([-2, -2], [2, 2], [4, 4], [40, 40], [1e3, 1e3], [0.01] * 2, [0.15, 0.2], [0.7, 0.7]))
)


def segment(pieces: int, end: float, *keys: tuple[float, float], **options) -> SplineSegment:
    places, angles = np.array(keys).reshape(-1, 2).T
    return SplineSegment(0, 0, grid(pieces, KNOT_INTERVAL), 0.0, end, places, angles, **options)


# segment of 40 knot intervals with two inner keys (knot, angle [rad])
CURVED_SEGMENT = segment(40, 1.6, (17.3, 0.7), (30.0, 1.2), marks=((0,), (1, 2), (3,), (3, 4)))


def deficit_of(amount: float, *binding: str | None) -> Infeasibility:
    return Infeasibility(amount, np.zeros(len(binding) + 1), binding, np.zeros(3))


def test_key_intervals_with_a_binding_limit_limit_the_time_of_a_segment():
    found = find_limiting_intervals(CURVED_SEGMENT, deficit_of(0.1, "speed", None, "jerk"))
    assert [*found] == [(0, (0, 1)), (0, (3, 4))]
    assert CURVED_SEGMENT.pairs == ((0, 1), (1, 3), (3, 4))
    every = [(0, (0, 1)), (0, (1, 3)), (0, (3, 4))]
    assert [*find_limiting_intervals(CURVED_SEGMENT, None)] == every
    assert [*find_limiting_intervals(CURVED_SEGMENT, deficit_of(0.1, None, None, None))] == every


def test_interval_of_a_segment_that_begins_and_ends_at_the_same_key_is_no_bottleneck():
    late = replace(CURVED_SEGMENT, marks=((0,), (1, 2), (3,), (3,)))
    deficit = deficit_of(0.1, "speed", None, "jerk")
    assert [*find_limiting_intervals(late, deficit)] == [(0, (0, 1))]
    assert [pair for pair, _ in find_bottlenecks(late, deficit)] == [(0, 1)]


def test_bottleneck_ratio_is_the_exponential_of_the_time_deficit():
    found = dict(find_bottlenecks(replace(CURVED_SEGMENT, hinge=3), deficit_of(0.3, "speed", None, "duty")))
    assert {pair: (item.hinge, item.quantity) for pair, item in found.items()} == {
        (0, 1): (3, "speed"),
        (3, 4): (3, "duty"),
    }
    assert {item.ratio for item in found.values()} == {np.exp(0.3)}
    assert find_bottlenecks(CURVED_SEGMENT, None) == []


def keys_of(*times: float) -> Keys:
    return Keys.of(tuple(KeyPosture(t, sealed([0.0] * 2), (True, True)) for t in times), PAIR_LIMITS)


def test_key_intervals_shorter_than_at_full_velocity_are_velocity_bottlenecks():
    keys = keys_of(0.0, 0.5, 0.51, 1.0)
    durations = {
        (0, (0, 1)): 0.75,
        (1, (0, 1)): 0.6,
        (0, (1, 2)): 0.05,
        (1, (1, 2)): 0.015,
        (0, (2, 3)): 0.49,
        (1, (2, 3)): 0.4900015,
    }
    found = [
        (pair, item.hinge, item.quantity, pytest.approx(item.ratio))
        for pair, item in find_velocity_bottlenecks(keys, PAIR_LIMITS, durations)
    ]
    assert found == [
        ((0, 1), 0, "speed", 1.5),
        ((0, 1), 1, "duty", 1.2),
        ((1, 2), 0, "speed", 2.5),
        ((2, 3), 1, "duty", 0.4900015 / 0.49),
    ]
    slower = {(0, (2, 3)): 0.49 + 0.7e-6}
    assert [*find_velocity_bottlenecks(keys, PAIR_LIMITS, slower)] == [], "rounding is no bottleneck"


def test_velocity_is_the_bottleneck_if_the_duty_allows_the_same_velocity():
    equal = replace(PAIR_LIMITS, viscous=sealed([0.25, 0.15]), duty=sealed([1.0, 0.5]))
    found = [item.quantity for _, item in find_velocity_bottlenecks(keys_of(0, 1), equal, {(0, (0, 1)): 2.0})]
    found += [item.quantity for _, item in find_velocity_bottlenecks(keys_of(0, 1), equal, {(1, (0, 1)): 2.0})]
    assert found == ["speed", "duty"]


def test_binding_limit_of_a_key_interval_has_the_largest_sum_of_multipliers():
    gaps, kinds = np.array([0, 0, 0, 1, 1, 2, 2]), np.array([0, 1, 1, 2, 3, 3, 0])
    multipliers = np.array([0.3, 0.2, 0.2, 0.13, 0.1, 0.05, 0.02])
    assert _find_binding_limits(gaps, kinds, multipliers, 4) == ("acceleration", "jerk", "duty", None)
    multipliers[5] = 0.045
    assert _find_binding_limits(gaps, kinds, multipliers, 3) == ("acceleration", "jerk", None)
    doubled = _find_binding_limits(gaps, kinds, 2 * multipliers, 3)
    assert doubled == ("acceleration", "jerk", None)


def test_time_deficit_needs_a_slope_above_0_1_per_second_for_a_single_cutting_plane():
    times = np.array([0.0, 1.0, 1.2, 2.0, 2.3])
    for steepest, sign, count in ((0.11, 1, 1), (0.11, -1, 1), (0.099, 1, 2), (0.0, 1, 2)):
        slopes = sign * np.array([-steepest, 0.0, steepest, 0.0])
        deficit = Infeasibility(0.1, slopes, ("speed", None, "jerk"), np.zeros(3))
        planes = make_cutting_planes(CURVED_SEGMENT, deficit, times)
        assert len(planes) == count
        for plane in planes:
            assert plane.slopes @ times > plane.bound
            assert plane.slopes.sum() == pytest.approx(0.0)


def test_motion_segment_without_movement_exceeds_no_limit():
    assert estimate_limit_ratio(segment(20, 0.0), JOINT_LIMITS) == 0.0


@pytest.mark.parametrize("place", [17.3, 19.0, 23.6])
def test_slopes_of_a_time_deficit_at_its_keys_equal_finite_differences(place):
    more = 0.02
    base = measure_time_deficit(segment(50, 1.6, (place, 0.7), (38.0, 1.3), marks=CURVED_SEGMENT.marks), JOINT_LIMITS)
    for k, keys in enumerate((((place + more, 0.7), (38.0, 1.3)), ((place, 0.7), (38.0 + more, 1.3)))):
        moved = measure_time_deficit(segment(50, 1.6, *keys, marks=CURVED_SEGMENT.marks), JOINT_LIMITS)
        slope = (moved.amount - base.amount) / (more * KNOT_INTERVAL)
        assert base.slopes[k + 1] == pytest.approx(slope, rel=0.05, abs=0.02)
    assert base.slopes.sum() == pytest.approx(0.0, abs=1e-9)
    assert base.controls.shape == (53,)
    assert base.programs == 1


def test_mirrored_segment_has_the_same_time_deficit_and_gradient():
    one = measure_time_deficit(segment(40, 1.6, (17.3, 0.7), marks=((0,), (1,), (2,))), JOINT_LIMITS)
    other = measure_time_deficit(segment(40, -1.6, (17.3, -0.7), marks=((0,), (1,), (2,))), JOINT_LIMITS)
    assert other.amount == pytest.approx(one.amount, abs=1e-6)
    np.testing.assert_allclose(other.slopes, one.slopes, atol=1e-3)
    assert other.binding == one.binding


def test_segment_reversed_in_time_has_the_same_time_deficit_and_the_opposite_gradient():
    back = SplineSegment(0, 0, grid(40, KNOT_INTERVAL), 1.6, 0.0, np.array([23.0]), np.array([0.7]))
    light = replace(JOINT_LIMITS, viscous=sealed([0.0]))
    one, other = (measure_time_deficit(way, light) for way in (segment(40, 1.6, (17.0, 0.7)), back))
    assert other.amount == pytest.approx(one.amount, abs=1e-6)
    np.testing.assert_allclose(other.slopes, -one.slopes[::-1], atol=1e-2)


def test_time_deficit_below_the_target_is_a_bound_without_slopes_and_binding_limits():
    way = segment(80, 1.6, (40.0, 0.8), marks=((0,), (1,), (2,)))
    bound, exact = (measure_time_deficit(way, JOINT_LIMITS, target=target) for target in (-0.01, None))
    assert exact.amount < bound.amount <= -0.01
    assert bound.slopes.tolist() == [0.0, 0.0, 0.0]
    assert bound.binding == (None, None)


def relaxed(amount: float, multipliers: list[float], binding, *, is_bound: bool = False):
    """Return the relaxation of a motion with constant velocity 1 rad/s."""
    controls = (np.arange(43) - 1.0) * KNOT_INTERVAL
    return infeasibility._LogRelaxation(controls, amount, np.array(multipliers), binding, is_bound)


# segment with keys on a straight line over time
STRAIGHT_SEGMENT = segment(40, 0.4, (10.0, 0.1), (25.0, 0.25), marks=((0,), (1,), (2,), (3,)))


def measured_with(monkeypatch, relaxation, differences=(7.0, 9.0), **options):
    """Measure a time deficit from a given relaxation and given finite differences."""
    monkeypatch.setattr(infeasibility, "_relax", lambda *given: relaxation)
    monkeypatch.setattr(infeasibility, "_compute_difference", lambda way, limits, key, amount: differences[key])
    return measure_time_deficit(STRAIGHT_SEGMENT, JOINT_LIMITS, **options)


def test_slope_of_a_time_deficit_is_multiplier_times_velocity_with_zero_sum_over_all_keys(monkeypatch):
    given = relaxed(0.1, [3.0, -2.8, 0, 0, 0, 0, 0, 0], ("speed", None, "jerk"))
    found = measured_with(monkeypatch, given)
    np.testing.assert_allclose(found.slopes, [0.0, 3.0 - 0.2 * 3.0 / 5.8, -2.8 - 0.2 * 2.8 / 5.8, 0.0], atol=1e-9)
    assert (found.amount, found.binding, found.programs) == (0.1, ("speed", None, "jerk"), 1)


@pytest.mark.parametrize(
    ("multipliers", "programs"),
    [([3.0, -2.5], 1), ([3.0, -2.4], 3), ([0.51, -0.51], 1), ([0.49, -0.49], 3), ([-0.51, 0.51], 1)],
)
def test_time_deficit_slopes_that_are_zero_or_unbalanced_are_replaced_by_finite_differences(
    monkeypatch, multipliers, programs
):
    given = relaxed(-0.009, [*multipliers, 0, 0, 0, 0, 0, 0], ("speed", None, "jerk"))
    found = measured_with(monkeypatch, given, differences=(7.0, -7.0))
    assert found.programs == programs
    if programs > 1:
        np.testing.assert_allclose(found.slopes, [0.0, 7.0, -7.0, 0.0])
    assert measured_with(monkeypatch, replace(given, amount=-0.011)).programs == 1


def test_finite_differences_are_computed_only_for_keys_next_to_a_binding_limit(monkeypatch):
    given = relaxed(0.1, [0.1, 0.1, 0, 0, 0, 0, 0, 0], (None, None, "jerk"))
    found = measured_with(monkeypatch, given, differences=(100.0, 0.1))
    assert found.programs == 2
    np.testing.assert_allclose(np.abs(found.slopes), 0.0, atol=0.1)


@pytest.mark.parametrize(("most", "is_measured"), [(120, True), (119, False), (40, False)])
def test_time_deficit_is_unknown_if_its_finite_differences_exceed_the_work_limit(monkeypatch, most, is_measured):
    given = relaxed(0.1, [0.1, 0.1, 0, 0, 0, 0, 0, 0], ("speed", None, "jerk"))
    assert (measured_with(monkeypatch, given, max_work=most) is not None) is is_measured


@pytest.mark.parametrize(("after", "step"), [(21.0, -1.0), (23.0, -1.0), (23.1, 1.0), (40.0, 1.0)])
def test_finite_difference_moves_a_key_by_one_knot_and_backwards_if_the_next_key_is_near(monkeypatch, after, step):
    seen = []
    monkeypatch.setattr(infeasibility, "_relax", lambda way, limits: seen.append(way.places) or relaxed(0.3, [], ()))
    way = segment(60, 0.4, (10.0, 0.1), (20.0, 0.2), (after, 0.3))
    slope = infeasibility._compute_difference(way, JOINT_LIMITS, 1, 0.1)
    np.testing.assert_allclose(seen[0], [10.0, 20.0 + step, after])
    assert slope == pytest.approx(step * 0.2 / KNOT_INTERVAL)
    monkeypatch.setattr(infeasibility, "_relax", lambda way, limits: None)
    assert infeasibility._compute_difference(way, JOINT_LIMITS, 1, 0.1) == 0.0
