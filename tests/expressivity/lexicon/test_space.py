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
    SECTORS,
    extend_position,
    position,
    spread_hands,
    to_world,
    widen_key,
)

ROBOT = Robot.load()
coordinates = st.floats(-1.0, 1.5)
places = st.tuples(st.floats(0.2, 1.0), coordinates, coordinates).map(sealed)


def test_sectors_are_those_of_greta_in_order():
    for sectors in SECTORS.values():
        values = list(sectors.values())
        assert values == sorted(values) or values == sorted(values, reverse=True)
    assert position("XC", "YCC", "ZNear") == pytest.approx([0.4, 0.25, 0.25])
    assert position("XOppC", "YLowerEP", "ZFar") == pytest.approx([0.95, -0.25, -0.5])


def test_sector_names_fold_case_and_mix_with_numbers():
    assert position("xep", 0.1, "ZMIDDLE") == pytest.approx([0.65, 0.8, 0.1])


def test_an_unknown_sector_teaches_those_of_its_axis():
    with pytest.raises(ValueError, match=r"YCC is no sector of x; known: XEP, XP, XC, XCC, XOppC"):
        position("YCC", "YCC", "ZNear")


def test_the_origin_lies_at_elbow_height_between_the_shoulders():
    assert to_world(ROBOT, "l", sealed([0, 0, 0])) == pytest.approx([0.0, 0.0, 0.705])
    assert to_world(ROBOT, "r", sealed([1, 0.5, 0.25])) == pytest.approx([0.42, -0.21, 0.81])


@given(places)
def test_the_sides_are_mirror_images(place):
    left, right = to_world(ROBOT, "l", place), to_world(ROBOT, "r", place)
    assert np.array_equal(left * [1, -1, 1], right)


@pytest.mark.parametrize(
    ("spatial", "expected"),
    [(0.0, [0.4, 0.5, 0.6]), (1.0, [0.5, 1.15, 0.96]), (-1.0, [0.3, 0.15, 0.39]), (0.5, [0.45, 0.825, 0.78])],
)
def test_spatial_extent_scales_each_axis_by_its_own_rate(spatial, expected):
    assert extend_position(sealed([0.4, 0.5, 0.6]), spatial) == pytest.approx(expected)


def test_fixed_axes_stay():
    assert extend_position(sealed([0.4, 0.5, 0.6]), 1.0, (True, False, True)) == pytest.approx([0.4, 1.15, 0.6])


@given(places, st.floats(-1, 1), st.floats(-1, 1))
def test_a_wider_style_never_brings_the_hand_nearer_to_the_origin(place, one, other):
    tight, wide = sorted((one, other))
    assert np.all(np.abs(extend_position(place, tight)) <= np.abs(extend_position(place, wide)) + 1e-12)


def _wrists(key: StrokeKey) -> float:
    left, right = (to_world(ROBOT, side, key.hands[side].position) for side in ("l", "r"))
    return float(np.linalg.norm(left - right)) / ROBOT.arm_length


@given(places, places, st.floats(-1, 1))
def test_two_hands_keep_their_gap_at_any_extent(left, right, spatial):
    assert _wrists(widen_key(StrokeKey({"l": HandPose(left), "r": HandPose(right)}), spatial, ROBOT)) >= HAND_GAP - 1e-9


def test_hands_that_point_at_each_other_are_parted_further():
    near = HandPose(position(0.2, 0.2, 0.5))
    inward = HandPose(position(0.2, 0.2, 0.5), pointing=sealed([0, -1, 0]))
    assert _wrists(spread_hands(StrokeKey({"l": inward, "r": inward}))) > _wrists(
        spread_hands(StrokeKey({"l": near, "r": near}))
    )


def test_hands_that_are_clear_stay_where_they_are():
    key = StrokeKey({"l": HandPose(position(0.5, 0.2, 0.5)), "r": HandPose(position(0.5, 0.2, 0.5))})
    assert spread_hands(key) is key


def test_a_crossing_whose_outward_is_fixed_stays_crossed():
    fixed = (True, True, True)
    key = StrokeKey({"l": HandPose(position(-0.1, 0.2, 0.4), fixed), "r": HandPose(position(-0.1, 0.3, 0.4), fixed)})
    assert widen_key(key, 1.0, ROBOT).hands["l"].position == pytest.approx([0.4, -0.1, 0.2])


def test_one_hand_has_nothing_to_avoid():
    key = StrokeKey({"l": HandPose(position(0.0, 0.2, 0.5))})
    assert widen_key(key, 0.0, ROBOT).hands["l"].position == pytest.approx([0.5, 0.0, 0.2])


@given(places, st.floats(-1, 1))
def test_spatial_extent_takes_no_hand_out_of_reach(place, spatial):
    shoulder = ROBOT.skeleton.straight.origins[ROBOT.skeleton.segment("l_shoulder")] - ROBOT.gesture_origin
    wide = widen_key(StrokeKey({"l": HandPose(place)}), spatial, ROBOT).hands["l"].position
    far, before = (float(np.linalg.norm(where - shoulder / ROBOT.arm_length)) for where in (wide, place))
    assert far <= max(before, EASY_REACH) + 1e-9 or spatial < 0


@given(places)
def test_the_way_outwards_is_straight_and_has_no_jump(place):
    way = [widen_key(StrokeKey({"l": HandPose(place)}), k / 20, ROBOT).hands["l"].position for k in range(21)]
    steps = [float(np.linalg.norm(b - a)) for a, b in pairwise(way)]
    assert max(steps) <= float(np.linalg.norm(extend_position(place, 1.0) - place)) / 20 + 1e-9
