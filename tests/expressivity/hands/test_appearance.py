"""Tests of the visible difference between gestures."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.robot import SIDES
from kinesic.expressivity.hands.appearance import (
    MIN_PATH_DISTANCE,
    distinct,
    look,
    nearest,
    orientation_angle,
    path_distance,
    twins,
)
from kinesic.expressivity.hands.poses import resting_hands
from kinesic.expressivity.lexicon.form import StrokeKey
from kinesic.expressivity.lexicon.lexicon import in_mode

UP_AXIS = np.array([0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def form(lexicon):
    return lexicon.find("present").form


def changed(form, **fields):
    """Return the form with fields of every pose replaced."""
    keys = [
        StrokeKey(
            {side: replace(pose, **{name: of(pose) for name, of in fields.items()}) for side, pose in key.hands.items()}
        )
        for key in form.keys
    ]
    return replace(form, keys=tuple(keys))


def raised(form, robot, height):
    """Return the form raised by a height [m]."""
    return changed(form, position=lambda pose: sealed(pose.position + UP_AXIS * height / robot.arm_length))


def test_visual_distance_of_a_gesture_from_itself_is_zero(form, pace):
    seen = look(form, pace)
    assert path_distance(seen, seen) == 0.0
    assert orientation_angle(seen, seen) == pytest.approx(0.0, abs=1e-7)
    assert not distinct(seen, look(form, pace))


def test_path_distance_is_the_root_mean_square_over_both_hands(form, robot, pace):
    seen = look(form, pace)
    assert path_distance(seen, look(raised(form, robot, 0.06), pace)) == pytest.approx(0.06 / np.sqrt(2), rel=1e-6)
    both = in_mode(form, "both")
    assert path_distance(look(both, pace), look(raised(both, robot, 0.06), pace)) == pytest.approx(0.06, rel=1e-6)


def test_gestures_are_distinct_if_their_hand_paths_differ_by_the_minimum_path_distance(form, robot, pace):
    both = in_mode(form, "both")
    seen = look(both, pace)
    assert not distinct(seen, look(raised(both, robot, MIN_PATH_DISTANCE - 0.002), pace))
    assert distinct(seen, look(raised(both, robot, MIN_PATH_DISTANCE + 0.002), pace))


def test_different_hand_shape_or_palm_direction_makes_gestures_distinct(form, pace):
    seen = look(form, pace)
    assert distinct(seen, look(changed(form, shape=lambda _: "fist"), pace))
    assert distinct(seen, look(changed(form, palm=lambda pose: sealed(-pose.palm)), pace))


def test_waving_and_motionless_hands_have_a_path_distance_over_2_cm(lexicon, pace):
    waving = lexicon.find("wave_far").form
    still = changed(waving, path=lambda _: None)
    assert path_distance(look(waving, pace), look(still, pace)) > 0.02


def test_duplicate_of_an_earlier_gesture_is_listed(form, robot, pace):
    looks = [
        ("a", look(form, pace)),
        ("b", look(raised(form, robot, 0.01), pace)),
        ("c", look(in_mode(form, "left"), pace)),
    ]
    assert twins(looks) == [("b", "a")]


def test_lexicon_has_no_duplicate_gestures(lexicon, pace):
    assert len(lexicon.forms) >= 150
    assert twins((form.id, look(form, pace)) for form in lexicon.forms) == []


def test_nearest_gesture_has_the_smallest_path_distance(form, robot, pace):
    others = {"far": look(raised(form, robot, 0.3), pace), "near": look(raised(form, robot, 0.06), pace)}
    name, distance = nearest(look(form, pace), others)
    assert name == "near"
    assert distance == pytest.approx(0.06 / np.sqrt(2), rel=1e-6)


def test_hand_without_given_orientation_is_compared_like_a_hanging_hand(form, pace, robot):
    open_ = look(changed(form, palm=lambda _: None, pointing=lambda _: None), pace)
    rest = resting_hands(robot)
    for s, side in enumerate(SIDES):
        np.testing.assert_allclose(open_.palms[s], np.tile(rest[side].palm, (len(open_.palms[s]), 1)))
        np.testing.assert_allclose(open_.pointing[s], np.tile(rest[side].pointing, (len(open_.pointing[s]), 1)))
