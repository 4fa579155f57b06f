"""Tests of the splitting of motions into segments with angle ranges."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.bspline import grid
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.segments import (
    RestPoint,
    SplineSegment,
    _find_holds,
    _split_ample_intervals,
    find_critical_segments,
    pieces,
    segments,
)
from kinesic.motion.trajectory import KNOT_INTERVAL

from ..reference.motion.spline_programs import sparse

# limits of two hinges, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value] * 2) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
NO_PATH = np.array([False])


def keys_of(*rows: tuple[float, float]) -> Keys:
    return Keys.of(tuple(KeyPosture(time, sealed([angle] * 2), (True, True)) for time, angle in rows), JOINT_LIMITS)


def segment(count: int, start: float, end: float, *keys: tuple[float, float]) -> SplineSegment:
    places, angles = np.array(keys).reshape(-1, 2).T
    return SplineSegment(0, 0, grid(count, KNOT_INTERVAL), start, end, places, angles)


@pytest.mark.parametrize(
    ("begin", "end", "knots"),
    [
        (0.0, 39.9, []),
        (0.0, 40.0, [20]),
        (60.0, 90.0, []),
        (10.4, 90.2, [50]),
        (10.0, 250.0, [130]),
        (10.4, 250.6, [110, 151]),
        (10.0, 900.0, [110, 800]),
    ],
)
def test_hold_is_split_at_its_middle_or_if_long_one_second_from_both_ends(begin, end, knots):
    rests = [*_find_holds(np.array([begin, end]), np.array([0.3, 0.3]), NO_PATH)]
    assert rests == [RestPoint(knot, 0, 0.3) for knot in knots]


@pytest.mark.parametrize(("difference", "count"), [(0.0, 1), (0.6e-9, 1), (-0.6e-9, 1), (1.6e-9, 0), (-1.6e-9, 0)])
def test_successive_keys_that_differ_by_less_than_a_nanoradian_form_a_hold(difference, count):
    places, angles = np.array([0.0, 50.0]), np.array([0.0, difference])
    assert len([*_find_holds(places, angles, NO_PATH)]) == count
    assert len([*_split_ample_intervals(places, angles, NO_PATH, np.array([9.0]))]) == 1 - count
    assert [*_find_holds(places, angles, np.array([True]))] == []


@pytest.mark.parametrize(
    ("end", "duration", "knots"),
    [(50.0, 20.0, [25]), (49.9, 20.0, []), (40.0, 3.0, [20]), (39.0, 3.0, []), (90.6, 20.0, [45])],
)
def test_key_interval_of_2_5_times_its_minimum_duration_is_split_at_its_middle(end, duration, knots):
    places, angles = np.array([0.0, end, 500.0]), np.array([0.2, -0.6, 0.0])
    rests = [*_split_ample_intervals(places, angles, np.array([False, True]), np.array([duration, 1.0]))]
    assert rests == [RestPoint(knot, 0, pytest.approx(-0.2)) for knot in knots]


@pytest.mark.parametrize(
    ("duration", "count"), [(0.0, 4), (0.03, 4), (0.0499, 5), (0.1, 10), (0.10019, 10), (0.1003, 11)]
)
def test_motion_has_at_least_four_knot_intervals_and_covers_its_keys(duration, count):
    assert pieces(np.array([3.0, 3.02, 3.0 + duration]), KNOT_INTERVAL) == count
    assert pieces(np.array([3.0, 3.0 + 2 * duration]), 2 * KNOT_INTERVAL) == count


def test_control_points_near_a_key_may_use_the_angle_ranges_of_both_adjacent_intervals():
    lower, upper = segment(30, 0.0, 0.2, (12.0, 1.0)).corridor(JOINT_LIMITS)
    assert lower == pytest.approx([-0.1] * 16 + [0.12] * 17)
    assert upper == pytest.approx([1.1] * 16 + [1.08] * 17)
    lower, upper = segment(30, 0.0, 1.2, (12.0, 1.0)).corridor(JOINT_LIMITS)
    assert upper == pytest.approx([1.1] * 12 + [1.25] * 21)
    assert lower == pytest.approx([-0.1] * 16 + [0.95] * 17)


def test_desired_motion_widens_the_range_of_control_points_up_to_the_joint_range():
    wish = np.linspace(-2.3, 2.3, 31)
    lower, upper = segment(30, 0.0, 0.0).corridor(JOINT_LIMITS, wish)
    padded = np.array([wish[0], *wish, wish[-1]])
    np.testing.assert_allclose(lower, np.maximum(np.minimum(-0.05, padded - 0.05), -2.0))
    np.testing.assert_allclose(upper, np.minimum(np.maximum(0.05, padded + 0.05), 2.0))


def test_angle_corridor_of_a_segment_uses_the_joint_range_of_its_hinge():
    limits = replace(JOINT_LIMITS, lower=sealed([-2.0, -0.04]), upper=sealed([2.0, 0.03]))
    lower, upper = replace(segment(9, 0.0, 0.0), hinge=1).corridor(limits)
    assert (lower.min(), lower.max(), upper.min(), upper.max()) == (-0.04, -0.04, 0.03, 0.03)


@pytest.mark.parametrize(
    ("angles", "count"),
    [((0.0, 1.0), 0), ((0.0, 1.0, 0.0), 1), ((0.0, 1.0, 1.0, 0.0), 1), ((0.0, 1.0, 0.5, 0.8, 0.9), 2), ((0.0, 0.0), 0)],
)
def test_holds_within_a_motion_segment_do_not_count_as_reversals(angles, count):
    start, *inner, end = angles
    assert segment(90, start, end, *((9.0 * (k + 1), angle) for k, angle in enumerate(inner))).reversals == count
    assert segment(90, -start, -end, *((9.0 * (k + 1), -a) for k, a in enumerate(inner))).reversals == count


def test_segment_lies_within_another_if_it_has_the_same_hinge_and_a_part_of_its_knots():
    outer = replace(segment(20, 0.0, 1.0), first=10)
    for first, count, is_within in ((10, 20, True), (15, 5, True), (9, 20, False), (11, 20, False), (10, 21, False)):
        inner = replace(segment(count, 0.0, 1.0), first=first)
        assert inner.within(outer) is is_within
        assert not replace(inner, hinge=1).within(outer)
    assert (outer.knots, outer.controls) == (slice(10, 31), slice(10, 33))


def test_segment_with_a_path_or_moving_ends_or_changing_angles_is_not_still():
    still = segment(20, 0.3, 0.3, (5.0, 0.3 + 0.5e-9))
    assert still.is_still
    moves = (
        replace(still, has_path=True),
        replace(still, entry=(0.3, 0.3, 0.3)),
        replace(still, exit=(0.3, 0.3, 0.3)),
        replace(still, end=0.3 + 2e-9),
        replace(still, angles=np.array([0.3 - 2e-9])),
    )
    assert not any(moving.is_still for moving in moves)


def test_equations_of_a_stop_at_any_angle_fix_its_start_and_equal_last_control_points():
    stop = SplineSegment.between(1, 6, np.array([0.1, 0.2, 0.4]))
    assert (stop.hinge, stop.start, stop.end, stop.stops_anywhere, stop.marks) == (1, 0.2, 0.2, True, ())
    ends = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    expected = np.zeros((5, 9))
    expected[:3, :3] = ends
    expected[3, [6, 7]] = expected[4, [6, 8]] = -1.0, 1.0
    np.testing.assert_array_equal(sparse(stop.fixed.matrix).toarray(), expected)
    np.testing.assert_array_equal(stop.fixed.values, [0.1, 0.2, 0.4, 0.0, 0.0])


def test_equations_of_a_segment_between_moving_ends_fix_both_ends_and_the_keys_between():
    places, angles = np.array([2.0, 3.5]), np.array([0.6, 0.7])
    entry, exit = np.array([0.1, 0.2, 0.4]), np.array([0.9, 0.8, 0.5])
    joined = SplineSegment.between(0, 6, entry, exit, places=places, angles=angles)
    assert (joined.start, joined.end, joined.stops_anywhere, joined.has_path) == (0.2, 0.8, False, False)
    matrix = sparse(joined.fixed.matrix).toarray()
    np.testing.assert_allclose(matrix[0], [0, 0, 1 / 6, 4 / 6, 1 / 6, 0, 0, 0, 0])
    np.testing.assert_allclose(matrix[1, 3:7] * 48, [1, 23, 23, 1])
    np.testing.assert_array_equal(matrix[2:], np.eye(9)[[0, 1, 2, 6, 7, 8]])
    np.testing.assert_array_equal(joined.fixed.values, [0.6, 0.7, *entry, *exit])


def test_key_in_the_last_knot_interval_becomes_a_fixed_control_point_at_rest():
    early = segment(10, 0.0, 0.4, (4.0, 0.2), (9.5, 0.4))
    matrix, values = sparse(early.fixed.matrix).toarray(), early.fixed.values
    np.testing.assert_array_equal(matrix[1], np.eye(13)[9])
    np.testing.assert_array_equal(values, [0.2, 0.4, 0.0, 0.0, 0.0, 0.4, 0.4, 0.4])


def test_keys_within_rounding_of_a_segment_end_are_merged_into_this_end():
    keys = keys_of((0.0, 0.0), (0.00019, 0.0), (0.00022, 0.0), (0.5, 1.0), (0.99979, 0.3), (0.99982, 0.3), (1.0, 0.3))
    places = keys.requested_times / KNOT_INTERVAL
    found = SplineSegment.through(keys, 1, places, RestPoint(0, -1, 0.0), RestPoint(100, 6, 0.3), KNOT_INTERVAL)
    assert found.places == pytest.approx([0.022, 50.0, 99.979])
    assert found.angles.tolist() == [0.0, 1.0, 0.3]
    assert found.marks == ((0,), (2,), (3,), (4,), (6,))
    assert (found.hinge, found.first, found.start, found.end, found.grid.pieces) == (1, 0, 0.0, 0.3, 100)


def test_key_positions_in_a_segment_are_counted_from_its_first_knot():
    keys = keys_of((0.0, 0.0), (0.4, 0.5), (1.0, 0.5), (1.3, 0.9), (1.7, 0.0))
    before, after = (item for item in segments(keys.requested_times, keys, KNOT_INTERVAL) if item.hinge == 1)
    assert (before.first, before.grid.pieces, before.places.tolist()) == (0, 70, pytest.approx([40.0]))
    assert (after.first, after.grid.pieces, after.places.tolist()) == (70, 100, pytest.approx([30.0, 60.0]))
    assert (before.marks, after.marks) == (((0,), (1,), (1, 2)), ((1, 2), (2,), (3,), (4,)))
    assert before.key_intervals == ((1, (0, 1)), (1, (1, 2)))
    later = [*segments(keys.requested_times + 5.0, keys, KNOT_INTERVAL)]
    assert [item.first for item in later] == [0, 70, 0, 70]


def test_path_between_two_keys_belongs_only_to_the_segment_of_these_keys():
    rows = ((0.0, 0.0, True), (0.2, 0.1, False), (0.4, 0.5, True), (1.0, 0.5, True), (1.3, 0.9, True))
    for turned in (False, True):
        ordered = [(1.3 - time, *rest) for time, *rest in reversed(rows)] if turned else rows
        postures = tuple(KeyPosture(t, sealed([a] * 2), (True, True), is_exact=exact) for t, a, exact in ordered)
        keys = Keys.of(postures, JOINT_LIMITS)
        found = [item.has_path for item in segments(keys.requested_times, keys, KNOT_INTERVAL) if item.hinge == 0]
        assert found == [not turned, turned]


def test_hinge_with_exactly_its_rest_to_rest_durations_has_no_critical_segment():
    keys = keys_of((0.0, 0.0), (0.25, 0.5), (0.5, 0.0), (0.75, 0.4))

    def found(*durations: float) -> list[tuple[int, int, int]]:
        rests = [np.array(durations), np.full(3, 0.25)]
        critical = find_critical_segments(keys.requested_times, keys, KNOT_INTERVAL, rests, [0, 1])
        return [(item.hinge, item.first, item.grid.pieces) for item in critical]

    assert found(0.25, 0.25, 0.25) == []
    for late in range(3):
        durations = np.full(3, 0.25)
        durations[late] += 0.001
        assert found(*durations) == [(0, 0, 75)]


@pytest.mark.parametrize(("late", "expected"), [(0, (0, 140)), (1, (0, 140)), (2, (140, 110)), (3, (140, 110))])
def test_only_the_segment_with_an_interval_below_its_rest_to_rest_duration_is_critical(late, expected):
    keys = keys_of((0.0, 0.0), (0.3, 0.5), (0.6, 0.0), (2.2, 0.8), (2.5, 0.4))
    durations = np.array([0.3, 0.3, 0.3, 0.3])
    durations[late] = 0.31 if late != 2 else 1.7
    rests = [durations, durations]
    found = [*find_critical_segments(keys.requested_times, keys, KNOT_INTERVAL, rests, [1])]
    if late == 2:
        assert [(item.first, item.grid.pieces) for item in found] == [(0, 250)]
    else:
        assert [(item.first, item.grid.pieces) for item in found] == [expected]
