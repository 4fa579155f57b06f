import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.double_s import compute_rest_durations
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.segments import SplineSegment, find_critical_segments, pieces, segments
from kinesic.motion.trajectory import KNOT_INTERVAL

# limits of two hinges, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value] * 2) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
# key time [s] and angles of both hinges [rad]; the first hinge holds from 0.5 to 1.3 s
KEY_ROWS = ((0.0, 0.0, 1.0), (0.5, 0.7, 1.0), (1.3, 0.7, 1.0), (1.805, 0.2, 0.4), (2.2, 0.0, 1.0))
# keys of both hinges
MOTION_KEYS = Keys.of(tuple(KeyPosture(time, sealed(angles), (True, True)) for time, *angles in KEY_ROWS), JOINT_LIMITS)


def cut(hinge: int):
    return [
        segment
        for segment in segments(MOTION_KEYS.requested_times, MOTION_KEYS, KNOT_INTERVAL)
        if segment.hinge == hinge
    ]


def test_motion_is_split_into_segments_in_the_middle_of_a_hold():
    first, second = cut(0)
    assert (first.first, second.first) == (0, 90)
    assert (first.start, first.end, second.start, second.end) == (0.0, 0.7, 0.7, 0.0)
    assert first.pairs == ((0, 1), (1, 2))
    assert second.pairs == ((1, 2), (2, 3), (3, 4))
    assert second.places == pytest.approx([40.0, 90.5])


@pytest.mark.parametrize(
    ("places", "exit", "is_early"),
    [
        ([], None, False),
        ([10.0], None, False),
        ([29.0], None, False),
        ([10.0, 29.5], None, True),
        ([29.5], [0.2, 0.3, 0.4], False),
    ],
)
def test_segment_rests_early_if_its_last_key_is_within_its_last_knot_interval(places, exit, is_early):
    segment = SplineSegment.between(
        0,
        30,
        np.zeros(3),
        None if exit is None else np.array(exit),
        places=np.array(places),
        angles=np.full(len(places), 0.2),
    )
    assert segment.rests_early is is_early


@pytest.mark.parametrize("exit", [None, [0.2, 0.3, 0.4]])
def test_running_motion_may_use_its_whole_range_to_stop_or_to_join_another(exit):
    ended = None if exit is None else np.array(exit)
    segment = SplineSegment.between(1, 30, np.array([0.1, 0.2, 0.3]), ended)
    lowest, highest = segment.corridor(JOINT_LIMITS)
    assert lowest.shape == highest.shape == (segment.grid.size,)
    assert set(lowest.tolist()) == {JOINT_LIMITS.lower[1]}
    assert set(highest.tolist()) == {JOINT_LIMITS.upper[1]}


def test_segments_of_a_hinge_cover_its_whole_motion():
    for hinge in (0, 1):
        result = cut(hinge)
        assert [s.knots.stop - 1 for s in result] == [
            *(s.first for s in result[1:]),
            pieces(MOTION_KEYS.requested_times, KNOT_INTERVAL),
        ]


def tight(times, hinges=(0, 1)) -> list:
    ways = compute_rest_durations(MOTION_KEYS, JOINT_LIMITS)
    rests = [np.array([rest for (hinge, _), rest in ways.items() if hinge == own]) for own in (0, 1)]
    return [*find_critical_segments(np.asarray(times), MOTION_KEYS, KNOT_INTERVAL, rests, hinges)]


def test_segments_with_ample_time_are_excluded_from_the_search():
    assert tight(MOTION_KEYS.requested_times * 3.0) == []
    hurried = tight(MOTION_KEYS.requested_times * 0.6)
    assert {item.hinge for item in hurried} == {0, 1}
    assert {item.hinge for item in tight(MOTION_KEYS.requested_times * 0.6, [1])} == {1}


def test_key_interval_with_ample_time_is_split_into_segments_at_its_middle():
    times = MOTION_KEYS.requested_times + np.array(
        [0.0, 0.0, 0.0, 3.0, 2.8]
    )  # a long way from 0.7 to 0.2, and a hurried one to 0
    (last,) = [item for item in tight(times) if item.hinge == 0]
    assert last.start == pytest.approx(0.45)
    assert (last.end, last.first) == (0.0, 305)
    assert last.pairs == ((2, 3), (3, 4))
    (whole,) = [
        segment for segment in segments(times, MOTION_KEYS, KNOT_INTERVAL) if segment.hinge == 0 and segment.first == 90
    ]
    assert last.within(whole)
    assert not whole.within(last)


def test_motion_segment_with_equal_key_angles_is_still():
    assert [item.is_still for item in cut(1)] == [True, True, False]


def test_motion_may_overshoot_a_key_by_a_tenth_of_the_key_distance_but_always_by_a_minimum():
    still, moving = cut(1)[0], cut(0)[0]
    for segment, lowest, highest in ((still, 0.95, 1.05), (moving, -0.07, 0.77)):
        lower, upper = segment.corridor(JOINT_LIMITS)
        assert (lower.min(), upper.max()) == pytest.approx((lowest, highest))
    lower, upper = still.corridor(JOINT_LIMITS, np.full(still.grid.pieces + 1, 1.5))
    assert (lower.min(), upper.max()) == pytest.approx((0.95, 1.55))


def test_equality_constraints_of_a_segment_fix_key_angles_and_rest_at_its_ends():
    way = cut(0)[1]
    matrix, values = way.fixed.matrix, way.fixed.values
    assert matrix.shape == (8, way.grid.size)
    np.testing.assert_allclose(matrix @ np.ones(way.grid.size), 1.0)
    np.testing.assert_allclose(values, [0.7, 0.2, 0.7, 0.7, 0.7, 0.0, 0.0, 0.0])


def test_last_key_between_two_knots_belongs_to_the_segment():
    times = MOTION_KEYS.requested_times + np.array([0, 0, 0, 0, 0.004])
    last = [segment for segment in segments(times, MOTION_KEYS, KNOT_INTERVAL) if segment.hinge == 0][-1]
    assert last.places[-1] == pytest.approx(130.4)
    assert last.pairs[-1] == (4, 4)


def test_path_between_equal_angles_is_not_a_hold():
    rows = ((0.0, 0.0, True), (0.5, 0.7, True), (0.9, 0.9, False), (1.3, 0.7, True), (2.0, 0.0, True))
    keys = Keys.of(
        tuple(KeyPosture(t, sealed([a] * 2), (True, True), is_exact=is_exact) for t, a, is_exact in rows), JOINT_LIMITS
    )
    assert keys.exact_rows == ([0, 1, 3, 4], [0, 1, 3, 4])
    assert keys.has_path(0).tolist() == [False, True, False]
    assert [
        (segment.hinge, segment.first, segment.has_path)
        for segment in segments(keys.requested_times, keys, KNOT_INTERVAL)
    ] == [
        (0, 0, True),
        (1, 0, True),
    ]


def test_motion_with_a_long_hold_has_two_short_segments_around_a_segment_at_rest():
    rows = ((0.0, 0.0), (0.5, 0.7), (300.0, 0.7), (300.5, 0.0))
    keys = Keys.of(tuple(KeyPosture(t, sealed([a] * 2), (True, True)) for t, a in rows), JOINT_LIMITS)
    before, still, after = [
        segment for segment in segments(keys.requested_times, keys, KNOT_INTERVAL) if segment.hinge == 0
    ]
    assert (before.is_still, still.is_still, after.is_still) == (False, True, False)
    assert before.grid.pieces < 200
    assert after.grid.pieces < 200
    assert still.pairs == ((1, 2),)
