import numpy as np
import pytest

from kinesic.bench.plan import count_violations
from kinesic.body.robot import Robot
from kinesic.expressivity.hands.fingers import finger_joints, shape_angles
from kinesic.expressivity.keyframes import FingerKey
from kinesic.expressivity.lexicon.hand_shapes import hand_shapes
from kinesic.motion.keys import KeyPosture
from kinesic.planning.finger_postures import add_finger_keys, set_fingers
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

HANDS_ROBOT = Robot.load("upper36")  # robot with fingers
FIST_KEY = FingerKey(0.5, shape_angles(hand_shapes()["fist"], HANDS_ROBOT, "l"))  # fist at 0.5 s
OPEN_KEY = FingerKey(1.0, shape_angles(hand_shapes()["open"], HANDS_ROBOT, "l"))  # open hand at 1 s
# gesture that shows two fingers of a given hand
COUNT_TEMPLATE = """<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0">
<gesture id="g" lexeme="count_two" mode="{mode}"/></bml>"""


@pytest.fixture(scope="module")
def known():
    return set_up("upper36")


@pytest.fixture(scope="module")
def counted(known):
    return plan(COUNT_TEMPLATE.format(mode="right_hand"), known)


def test_added_finger_keys_are_inexact_and_have_distinct_times():
    rest = HANDS_ROBOT.skeleton.rest
    postures = [KeyPosture.whole(time, rest) for time in (0.0, 0.5, 2.0)]
    finger_keys = add_finger_keys(postures, {"l": (FIST_KEY, OPEN_KEY), "r": (FIST_KEY,)}, HANDS_ROBOT)
    assert [posture.is_exact for posture in finger_keys] == [True, True, False, False, True]
    assert len({posture.time for posture in finger_keys}) == len(finger_keys)
    both, left = finger_keys[2], finger_keys[3]
    assert set(np.flatnonzero(both.keyed)) == {*finger_joints(HANDS_ROBOT, "l"), *finger_joints(HANDS_ROBOT, "r")}
    assert set(np.flatnonzero(left.keyed)) == set(finger_joints(HANDS_ROBOT, "l"))
    np.testing.assert_array_equal(both.angles[list(finger_joints(HANDS_ROBOT, "r"))], FIST_KEY.angles)
    assert add_finger_keys(postures, {}, HANDS_ROBOT) == tuple(postures)


def test_finger_angles_of_a_posture_are_interpolated_at_its_time():
    angles = HANDS_ROBOT.skeleton.rest.copy()
    set_fingers(angles, 0.75, {"l": (FIST_KEY, OPEN_KEY)}, HANDS_ROBOT)
    np.testing.assert_allclose(angles[list(finger_joints(HANDS_ROBOT, "l"))], (FIST_KEY.angles + OPEN_KEY.angles) / 2)
    others = np.delete(np.arange(36), finger_joints(HANDS_ROBOT, "l"))
    np.testing.assert_array_equal(angles[others], HANDS_ROBOT.skeleton.rest[others])


@pytest.mark.parametrize(("time", "key"), [(0.0, FIST_KEY), (0.5, FIST_KEY), (1.0, OPEN_KEY), (9.0, OPEN_KEY)])
def test_first_and_last_finger_key_hold_outside_their_times(time, key):
    angles = HANDS_ROBOT.skeleton.rest.copy()
    set_fingers(angles, time, {"l": (FIST_KEY, OPEN_KEY)}, HANDS_ROBOT)
    np.testing.assert_array_equal(angles[list(finger_joints(HANDS_ROBOT, "l"))], key.angles)


def test_hand_shape_is_reached_within_5_degrees_at_the_stroke_and_within_limits(counted):
    two = shape_angles(hand_shapes()["two"], HANDS_ROBOT, "r")
    angles = counted.at("g:stroke").angles[list(finger_joints(HANDS_ROBOT, "r"))]
    assert np.degrees(np.abs(angles - two)).max() < 5.0
    assert counted.keyframes.outcomes["g"].kind == "realised"
    assert count_violations(counted) == 0
    rest = counted.trajectory.sample(np.array([0.0, counted.trajectory.duration]))[0]
    np.testing.assert_allclose(rest, np.tile(HANDS_ROBOT.skeleton.rest, (2, 1)), atol=1e-3)


def test_finger_postures_of_left_and_right_are_mirrored(known, counted):
    left = plan(COUNT_TEMPLATE.format(mode="left_hand"), known)
    times = np.linspace(0.0, counted.trajectory.duration, 30)
    a, b = (item.trajectory.sample(times)[0] for item in (left, counted))
    here, there = (list(finger_joints(HANDS_ROBOT, side)) for side in "lr")
    np.testing.assert_allclose(a[:, here], b[:, there], atol=1e-6)


@pytest.mark.parametrize("robot", ["upper36", pytest.param("human", marks=pytest.mark.soak)])
def test_wringing_hands_are_planned_without_notices(robot: str) -> None:
    """Plan crossing fingers, whose paths keep the required clearance."""
    planned = plan('<bml id="b"><gesture id="g" lexeme="nervous_wring"/></bml>', set_up(robot, voice="durations"))
    assert not planned.notices
