"""Tests of hand shapes over time, and as drive angles."""

from itertools import pairwise

import numpy as np
import pytest

from kinesic.body.limits import Limits
from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.hands.fingers import (
    FINGER_DELAY,
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
from kinesic.expressivity.style.style import NEUTRAL_EXPRESSIVITY

FINGER_ROBOT, PLAIN_ROBOT = Robot.load("upper36"), Robot.load("upper22")
BUILTIN_LEXICON = Lexicon.load()
SYNC_TIMES = {"start": 1.0, "ready": 1.7, "strokeStart": 1.7, "stroke": 2.2, "strokeEnd": 2.7, "relax": 3.2, "end": 4.2}


def pace(robot):
    """Return the pace of a robot with equal servos."""
    count = np.ones(len(robot.skeleton.hinges))
    limits = Limits.box(
        lower=robot.skeleton.lower,
        upper=robot.skeleton.upper,
        speed=6.0 * count,
        acceleration=150.0 * count,
        jerk=4000.0 * count,
    )
    return Pace(robot, limits)


FINGER_PACE = pace(FINGER_ROBOT)


def keys_of(work, times=SYNC_TIMES, own=FINGER_PACE):
    hands = arrange_hands([Stroke("g", times, (work,))], own)
    return finger_keys(hands.hands, hands.works, own)


def keys_of_gesture(id, times=SYNC_TIMES):
    return keys_of(poses(BUILTIN_LEXICON.forms_by_id[id], FINGER_ROBOT, NEUTRAL_EXPRESSIVITY), times)


def drives(side):
    return [FINGER_ROBOT.skeleton.names[joint][2:] for joint in finger_joints(FINGER_ROBOT, side)]


@pytest.mark.parametrize("name", list(hand_shapes()))
def test_hand_shapes_are_within_ranges_and_equal_on_both_hands(name):
    left, right = (shape_angles(hand_shapes()[name], FINGER_ROBOT, side) for side in SIDES)
    joints = list(finger_joints(FINGER_ROBOT, "l"))
    assert np.all(left >= FINGER_ROBOT.skeleton.lower[joints])
    assert np.all(left <= FINGER_ROBOT.skeleton.upper[joints])
    np.testing.assert_array_equal(left, right)
    assert drives("l") == drives("r")


def test_hand_shapes_are_distinct_and_fingers_independent():
    rows = {
        name: dict(zip(drives("l"), shape_angles(s, FINGER_ROBOT, "l"), strict=True))
        for name, s in hand_shapes().items()
    }
    values = [tuple(row.values()) for row in rows.values()]
    assert len(set(values)) == len(values)
    horns, two, phone = (rows[name] for name in ("horns", "two", "phone"))
    assert horns["pinky_flexion1"] == horns["index_flexion1"] == 0.0 < horns["middle_flexion1"]
    assert two["index_abduct"] > 0.2 > two["middle_flexion1"]
    assert phone["thumb_abduct"] == phone["thumb_flexion1"] == 0.0 < phone["index_flexion1"]
    assert rows["crossed"]["index_abduct"] < 0.0


def test_fingers_of_the_relaxed_hand_are_bent_by_20_to_35_degrees():
    rest = shape_angles(hand_shapes()["relaxed"], FINGER_ROBOT, "l")
    np.testing.assert_array_equal(rest, FINGER_ROBOT.skeleton.rest[list(finger_joints(FINGER_ROBOT, "l"))])
    bent = [angle for name, angle in zip(drives("l"), rest, strict=True) if "flexion" in name and "thumb" not in name]
    assert np.all(np.degrees(bent) >= 20.0)
    assert np.all(np.degrees(bent) <= 35.0)


def test_hand_shape_changes_after_the_wrist_starts_and_is_complete_at_stroke_start():
    fist = shape_angles(hand_shapes()["fist"], FINGER_ROBOT, "r")
    (side, keys) = next(iter(keys_of_gesture("count_one").items()))
    assert side == "r"
    np.testing.assert_array_equal(keys[0].angles, FINGER_ROBOT.skeleton.rest[list(finger_joints(FINGER_ROBOT, "r"))])
    assert SYNC_TIMES["start"] + FINGER_DELAY <= keys[0].time < keys[1].time <= SYNC_TIMES["strokeStart"]
    np.testing.assert_array_equal(keys[1].angles, fist)
    assert keys[-1].time > keys[-2].time >= SYNC_TIMES["relax"] + FINGER_DELAY - 1e-9
    np.testing.assert_array_equal(keys[-1].angles, keys[0].angles)


def test_finger_motion_starts_before_the_wrist_if_time_is_short():
    hurried = SYNC_TIMES | {"start": 1.6}
    (keys,) = keys_of_gesture("count_one", hurried).values()
    assert keys[1].time <= hurried["strokeStart"]
    assert keys[1].time - keys[0].time > 0.1


def test_pointing_gesture_takes_the_index_hand_shape():
    (keys,) = keys_of(pointing_poses(np.array([2.0, -0.5, 1.0]), "r", FINGER_ROBOT)).values()
    np.testing.assert_array_equal(keys[1].angles, shape_angles(hand_shapes()["index"], FINGER_ROBOT, "r"))


@pytest.mark.parametrize(
    ("gesture", "moves"), [("air_quotes", "index"), ("typing", "ring"), ("walk_fingers", "middle")]
)
def test_fingers_move_back_and_forth_during_the_stroke_of_finger_gestures(gesture, moves):
    times = SYNC_TIMES | {"strokeEnd": 3.4, "relax": 3.5, "end": 4.5}
    for side, keys in keys_of_gesture(gesture, times).items():
        column = drives(side).index(f"{moves}_flexion1")
        during = [key.angles[column] for key in keys if times["strokeStart"] < key.time < times["strokeEnd"]]
        turns = np.diff(np.sign(np.diff(during)[np.abs(np.diff(during)) > 1e-6]))
        assert np.sum(turns != 0) >= 3, gesture
        assert all(b.time - a.time > 0.015 for a, b in pairwise(keys))


def test_hand_without_fingers_has_no_finger_keys_and_reports_missing_shapes():
    work = poses(BUILTIN_LEXICON.forms_by_id["count_two"], PLAIN_ROBOT, NEUTRAL_EXPRESSIVITY)
    assert keys_of(work, own=pace(PLAIN_ROBOT)) == {}
    assert lacking_shapes(("flat", "fist", "FORM_OPEN", "tentacle"), PLAIN_ROBOT) == ("fist", "tentacle")
    assert lacking_shapes(hand_shapes(), FINGER_ROBOT) == ()
    assert lacking_shapes(("tentacle",), FINGER_ROBOT) == ("tentacle",)
