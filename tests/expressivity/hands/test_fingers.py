"""Shapes of the hand in time and as angles of drives."""

from itertools import pairwise

import numpy as np
import pytest

from kinesic.body.limits import Limits
from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.hands.fingers import (
    LAG,
    finger_joints,
    finger_keys,
    lacking_shapes,
    shape_angles,
)
from kinesic.expressivity.hands.phases import arrange_hands
from kinesic.expressivity.hands.poses import pointing_poses, poses
from kinesic.expressivity.hands.strokes import Stroke
from kinesic.expressivity.lexicon.hand_shapes import hand_shapes
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.pace import Pace
from kinesic.expressivity.style.style import NEUTRAL

ROBOT, PLAIN = Robot.load("upper36"), Robot.load("upper22")
LEXICON = Lexicon.load()
SYNCS = {"start": 1.0, "ready": 1.7, "strokeStart": 1.7, "stroke": 2.2, "strokeEnd": 2.7, "relax": 3.2, "end": 4.2}


def pace(robot):
    """Of servos that are all alike."""
    count = np.ones(len(robot.skeleton.hinges))
    limits = Limits.box(
        lower=robot.skeleton.lower,
        upper=robot.skeleton.upper,
        speed=6.0 * count,
        acceleration=150.0 * count,
        jerk=4000.0 * count,
    )
    return Pace(robot, limits)


PACE = pace(ROBOT)


def keys_of(work, times=SYNCS, own=PACE):
    hands = arrange_hands([Stroke("g", times, (work,))], own)
    return finger_keys(hands.hands, hands.works, own)


def keys_of_gesture(id, times=SYNCS):
    return keys_of(poses(LEXICON.forms_by_id[id], ROBOT, NEUTRAL), times)


def drives(side):
    return [ROBOT.skeleton.names[joint][2:] for joint in finger_joints(ROBOT, side)]


@pytest.mark.parametrize("name", list(hand_shapes()))
def test_a_shape_is_within_the_ranges_and_both_hands_make_it_alike(name):
    left, right = (shape_angles(hand_shapes()[name], ROBOT, side) for side in SIDES)
    joints = list(finger_joints(ROBOT, "l"))
    assert np.all(left >= ROBOT.skeleton.lower[joints])
    assert np.all(left <= ROBOT.skeleton.upper[joints])
    np.testing.assert_array_equal(left, right)
    assert drives("l") == drives("r")


def test_no_two_shapes_are_alike_and_each_finger_goes_its_own_way():
    rows = {name: dict(zip(drives("l"), shape_angles(s, ROBOT, "l"), strict=True)) for name, s in hand_shapes().items()}
    values = [tuple(row.values()) for row in rows.values()]
    assert len(set(values)) == len(values)
    horns, two, phone = (rows[name] for name in ("horns", "two", "phone"))
    assert horns["pinky_flexion1"] == horns["index_flexion1"] == 0.0 < horns["middle_flexion1"]
    assert two["index_abduct"] > 0.2 > two["middle_flexion1"]
    assert phone["thumb_abduct"] == phone["thumb_flexion1"] == 0.0 < phone["index_flexion1"]
    assert rows["crossed"]["index_abduct"] < 0.0


def test_a_relaxed_hand_rests_and_is_never_flat():
    rest = shape_angles(hand_shapes()["relaxed"], ROBOT, "l")
    np.testing.assert_array_equal(rest, ROBOT.skeleton.rest[list(finger_joints(ROBOT, "l"))])
    bent = [angle for name, angle in zip(drives("l"), rest, strict=True) if "flexion" in name and "thumb" not in name]
    assert np.all(np.degrees(bent) >= 20.0)
    assert np.all(np.degrees(bent) <= 35.0)


def test_a_shape_begins_after_the_wrist_and_is_complete_when_the_stroke_begins():
    fist = shape_angles(hand_shapes()["fist"], ROBOT, "r")
    (side, keys) = next(iter(keys_of_gesture("count_one").items()))
    assert side == "r"
    np.testing.assert_array_equal(keys[0].angles, ROBOT.skeleton.rest[list(finger_joints(ROBOT, "r"))])
    assert SYNCS["start"] + LAG <= keys[0].time < keys[1].time <= SYNCS["strokeStart"]
    np.testing.assert_array_equal(keys[1].angles, fist)
    assert keys[-1].time > keys[-2].time >= SYNCS["relax"] + LAG - 1e-9
    np.testing.assert_array_equal(keys[-1].angles, keys[0].angles)


def test_in_a_hurry_fingers_leave_before_the_wrist():
    hurried = SYNCS | {"start": 1.6}
    (keys,) = keys_of_gesture("count_one", hurried).values()
    assert keys[1].time <= hurried["strokeStart"]
    assert keys[1].time - keys[0].time > 0.1


def test_who_points_stretches_the_forefinger():
    (keys,) = keys_of(pointing_poses(np.array([2.0, -0.5, 1.0]), "r", ROBOT)).values()
    np.testing.assert_array_equal(keys[1].angles, shape_angles(hand_shapes()["index"], ROBOT, "r"))


@pytest.mark.parametrize(
    ("gesture", "moves"), [("air_quotes", "index"), ("typing", "ring"), ("walk_fingers", "middle")]
)
def test_fingers_move_while_the_stroke_lasts(gesture, moves):
    times = SYNCS | {"strokeEnd": 3.4, "relax": 3.5, "end": 4.5}
    for side, keys in keys_of_gesture(gesture, times).items():
        column = drives(side).index(f"{moves}_flexion1")
        during = [key.angles[column] for key in keys if times["strokeStart"] < key.time < times["strokeEnd"]]
        turns = np.diff(np.sign(np.diff(during)[np.abs(np.diff(during)) > 1e-6]))
        assert np.sum(turns != 0) >= 3, gesture
        assert all(b.time - a.time > 0.015 for a, b in pairwise(keys))


def test_a_hand_without_fingers_has_no_keys_and_lacks_all_shapes_that_need_them():
    work = poses(LEXICON.forms_by_id["count_two"], PLAIN, NEUTRAL)
    assert keys_of(work, own=pace(PLAIN)) == {}
    assert lacking_shapes(("flat", "fist", "FORM_OPEN", "tentacle"), PLAIN) == ("fist", "tentacle")
    assert lacking_shapes(hand_shapes(), ROBOT) == ()
    assert lacking_shapes(("tentacle",), ROBOT) == ("tentacle",)
