from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.arrays import sealed
from kinesic.body.robot import Robot
from kinesic.expressivity.lexicon.form import HandPose, StrokeKey
from kinesic.expressivity.lexicon.space import (
    EASY_REACH,
    HAND_GAP,
    SECTOR_CENTRES,
    extend_position,
    position,
    spread_hands,
    to_world,
    widen_key,
)

DEFAULT_ROBOT = Robot.load()
coordinates = st.floats(-1.0, 1.5)
places = st.tuples(st.floats(0.2, 1.0), coordinates, coordinates).map(sealed)


def test_gesture_space_sectors_are_ordered_as_in_greta():
    for sectors in SECTOR_CENTRES.values():
        values = list(sectors.values())
        assert values == sorted(values) or values == sorted(values, reverse=True)
    assert position("XC", "YCC", "ZNear") == pytest.approx([0.4, 0.25, 0.25])
    assert position("XOppC", "YLowerEP", "ZFar") == pytest.approx([0.95, -0.25, -0.5])


def test_gesture_space_sector_names_ignore_case_and_mix_with_numbers():
    assert position("xep", 0.1, "ZMIDDLE") == pytest.approx([0.65, 0.8, 0.1])


def test_unknown_gesture_space_sector_error_lists_valid_sectors():
    with pytest.raises(ValueError, match=r"YCC is no sector of x; known: XEP, XP, XC, XCC, XOppC"):
        position("YCC", "YCC", "ZNear")


def test_gesture_space_origin_is_at_elbow_height_between_the_shoulders():
    assert to_world(DEFAULT_ROBOT, "l", sealed([0, 0, 0])) == pytest.approx([0.0, 0.0, 0.705])
    assert to_world(DEFAULT_ROBOT, "r", sealed([1, 0.5, 0.25])) == pytest.approx([0.42, -0.21, 0.81])


@given(places)
def test_left_and_right_gesture_space_positions_are_mirrored(place):
    left, right = to_world(DEFAULT_ROBOT, "l", place), to_world(DEFAULT_ROBOT, "r", place)
    assert np.array_equal(left * [1, -1, 1], right)


@pytest.mark.parametrize(
    ("spatial", "expected"),
    [(0.0, [0.4, 0.5, 0.6]), (1.0, [0.5, 1.15, 0.96]), (-1.0, [0.3, 0.15, 0.39]), (0.5, [0.45, 0.825, 0.78])],
)
def test_spatial_extent_scales_each_axis_by_its_own_rate(spatial, expected):
    assert extend_position(sealed([0.4, 0.5, 0.6]), spatial) == pytest.approx(expected)


def test_position_axes_marked_as_fixed_are_not_scaled_by_spatial_extent():
    assert extend_position(sealed([0.4, 0.5, 0.6]), 1.0, (True, False, True)) == pytest.approx([0.4, 1.15, 0.6])


@given(places, st.floats(-1, 1), st.floats(-1, 1))
def test_larger_spatial_extent_never_moves_the_hand_towards_the_gesture_space_origin(place, one, other):
    tight, wide = sorted((one, other))
    assert np.all(np.abs(extend_position(place, tight)) <= np.abs(extend_position(place, wide)) + 1e-12)


def _wrists(key: StrokeKey) -> float:
    left, right = (to_world(DEFAULT_ROBOT, side, key.hands[side].position) for side in ("l", "r"))
    return float(np.linalg.norm(left - right)) / DEFAULT_ROBOT.arm_length


@given(places, places, st.floats(-1, 1))
def test_two_hands_of_a_gesture_keep_their_minimum_gap_at_any_spatial_extent(left, right, spatial):
    assert (
        _wrists(widen_key(StrokeKey({"l": HandPose(left), "r": HandPose(right)}), spatial, DEFAULT_ROBOT))
        >= HAND_GAP - 1e-9
    )


def test_hands_pointing_at_each_other_are_spread_more_than_parallel_hands():
    near = HandPose(position(0.2, 0.2, 0.5))
    inward = HandPose(position(0.2, 0.2, 0.5), pointing=sealed([0, -1, 0]))
    assert _wrists(spread_hands(StrokeKey({"l": inward, "r": inward}))) > _wrists(
        spread_hands(StrokeKey({"l": near, "r": near}))
    )


def test_spatial_extent_does_not_spread_hands_that_are_far_apart():
    key = StrokeKey({"l": HandPose(position(0.5, 0.2, 0.5)), "r": HandPose(position(0.5, 0.2, 0.5))})
    assert spread_hands(key) is key


def test_spatial_extent_keeps_hands_crossed_if_their_lateral_axis_is_fixed():
    fixed = (True, True, True)
    key = StrokeKey({"l": HandPose(position(-0.1, 0.2, 0.4), fixed), "r": HandPose(position(-0.1, 0.3, 0.4), fixed)})
    assert widen_key(key, 1.0, DEFAULT_ROBOT).hands["l"].position == pytest.approx([0.4, -0.1, 0.2])


def test_hand_of_a_one_handed_gesture_is_not_moved_outward():
    key = StrokeKey({"l": HandPose(position(0.0, 0.2, 0.5))})
    assert widen_key(key, 0.0, DEFAULT_ROBOT).hands["l"].position == pytest.approx([0.5, 0.0, 0.2])


@given(places, st.floats(-1, 1))
def test_spatial_extent_keeps_hands_within_easy_reach(place, spatial):
    shoulder = (
        DEFAULT_ROBOT.skeleton.zero_frames.origins[DEFAULT_ROBOT.skeleton.segment("l_shoulder")]
        - DEFAULT_ROBOT.gesture_origin
    )
    wide = widen_key(StrokeKey({"l": HandPose(place)}), spatial, DEFAULT_ROBOT).hands["l"].position
    far, before = (float(np.linalg.norm(where - shoulder / DEFAULT_ROBOT.arm_length)) for where in (wide, place))
    assert far <= max(before, EASY_REACH) + 1e-9 or spatial < 0


@given(places)
def test_hand_position_changes_continuously_with_spatial_extent(place):
    way = [widen_key(StrokeKey({"l": HandPose(place)}), k / 20, DEFAULT_ROBOT).hands["l"].position for k in range(21)]
    steps = [float(np.linalg.norm(b - a)) for a, b in pairwise(way)]
    assert max(steps) <= float(np.linalg.norm(extend_position(place, 1.0) - place)) / 20 + 1e-9
