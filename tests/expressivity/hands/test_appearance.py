"""What is seen of a stroke, by which gestures are told from one another."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.robot import SIDES
from kinesic.expressivity.hands.appearance import LEAST_WAY, distinct, look, nearest, turn_between, twins, way_between
from kinesic.expressivity.hands.poses import resting_hands
from kinesic.expressivity.lexicon.form import StrokeKey
from kinesic.expressivity.lexicon.lexicon import in_mode

UP = np.array([0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def form(lexicon):
    return lexicon.find("present").form


def changed(form, **fields):
    """The form with something else in every pose."""
    keys = [
        StrokeKey(
            {side: replace(pose, **{name: of(pose) for name, of in fields.items()}) for side, pose in key.hands.items()}
        )
        for key in form.keys
    ]
    return replace(form, keys=tuple(keys))


def raised(form, robot, height):
    """The form, higher by [m]."""
    return changed(form, position=lambda pose: sealed(pose.position + UP * height / robot.arm_length))


def test_a_gesture_is_no_other_than_itself(form, pace):
    seen = look(form, pace)
    assert way_between(seen, seen) == 0.0
    assert turn_between(seen, seen) == pytest.approx(0.0, abs=1e-7)
    assert not distinct(seen, look(form, pace))


def test_the_way_is_the_mean_over_both_hands(form, robot, pace):
    seen = look(form, pace)
    assert way_between(seen, look(raised(form, robot, 0.06), pace)) == pytest.approx(0.06 / np.sqrt(2), rel=1e-6)
    both = in_mode(form, "both")
    assert way_between(look(both, pace), look(raised(both, robot, 0.06), pace)) == pytest.approx(0.06, rel=1e-6)


def test_two_gestures_are_two_from_5_cm_on(form, robot, pace):
    both = in_mode(form, "both")
    seen = look(both, pace)
    assert not distinct(seen, look(raised(both, robot, LEAST_WAY - 0.002), pace))
    assert distinct(seen, look(raised(both, robot, LEAST_WAY + 0.002), pace))


def test_another_shape_or_another_palm_makes_another_gesture(form, pace):
    seen = look(form, pace)
    assert distinct(seen, look(changed(form, shape=lambda _: "fist"), pace))
    assert distinct(seen, look(changed(form, palm=lambda pose: sealed(-pose.palm)), pace))


def test_a_path_makes_another_gesture(lexicon, pace):
    waving = lexicon.find("wave_far").form
    still = changed(waving, path=lambda _: None)
    assert way_between(look(waving, pace), look(still, pace)) > 0.02


def test_what_is_like_an_earlier_one_does_not_count(form, robot, pace):
    looks = [
        ("a", look(form, pace)),
        ("b", look(raised(form, robot, 0.01), pace)),
        ("c", look(in_mode(form, "left"), pace)),
    ]
    assert twins(looks) == [("b", "a")]


def test_no_two_gestures_of_the_lexicon_are_alike(lexicon, pace):
    assert len(lexicon.forms) >= 150
    assert twins((form.id, look(form, pace)) for form in lexicon.forms) == []


def test_the_nearest_is_the_one_whose_hands_go_the_same_way(form, robot, pace):
    others = {"far": look(raised(form, robot, 0.3), pace), "near": look(raised(form, robot, 0.06), pace)}
    name, way = nearest(look(form, pace), others)
    assert name == "near"
    assert way == pytest.approx(0.06 / np.sqrt(2), rel=1e-6)


def test_a_hand_that_is_turned_nowhere_counts_as_it_hangs(form, pace, robot):
    open_ = look(changed(form, palm=lambda _: None, pointing=lambda _: None), pace)
    rest = resting_hands(robot)
    for s, side in enumerate(SIDES):
        np.testing.assert_allclose(open_.palms[s], np.tile(rest[side].palm, (len(open_.palms[s]), 1)))
        np.testing.assert_allclose(open_.pointing[s], np.tile(rest[side].pointing, (len(open_.pointing[s]), 1)))
