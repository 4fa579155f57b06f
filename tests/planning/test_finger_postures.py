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

ROBOT = Robot.load("upper36")
FIST = FingerKey(0.5, shape_angles(hand_shapes()["fist"], ROBOT, "l"))
OPEN = FingerKey(1.0, shape_angles(hand_shapes()["open"], ROBOT, "l"))
BLOCK = """<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0">
<gesture id="g" lexeme="count_two" mode="{mode}"/></bml>"""


@pytest.fixture(scope="module")
def known():
    return set_up("upper36")


@pytest.fixture(scope="module")
def counted(known):
    return plan(BLOCK.format(mode="right_hand"), known)


def test_added_finger_keys_are_inexact_and_have_distinct_times():
    rest = ROBOT.skeleton.rest
    postures = [KeyPosture.whole(time, rest) for time in (0.0, 0.5, 2.0)]
    finger_keys = add_finger_keys(postures, {"l": (FIST, OPEN), "r": (FIST,)}, ROBOT)
    assert [posture.is_exact for posture in finger_keys] == [True, True, False, False, True]
    assert len({posture.time for posture in finger_keys}) == len(finger_keys)
    both, left = finger_keys[2], finger_keys[3]
    assert set(np.flatnonzero(both.keyed)) == {*finger_joints(ROBOT, "l"), *finger_joints(ROBOT, "r")}
    assert set(np.flatnonzero(left.keyed)) == set(finger_joints(ROBOT, "l"))
    np.testing.assert_array_equal(both.angles[list(finger_joints(ROBOT, "r"))], FIST.angles)
    assert add_finger_keys(postures, {}, ROBOT) == tuple(postures)


def test_finger_angles_of_a_posture_are_interpolated_at_its_time():
    angles = ROBOT.skeleton.rest.copy()
    set_fingers(angles, 0.75, {"l": (FIST, OPEN)}, ROBOT)
    np.testing.assert_allclose(angles[list(finger_joints(ROBOT, "l"))], (FIST.angles + OPEN.angles) / 2)
    others = np.delete(np.arange(36), finger_joints(ROBOT, "l"))
    np.testing.assert_array_equal(angles[others], ROBOT.skeleton.rest[others])


@pytest.mark.parametrize(("time", "key"), [(0.0, FIST), (0.5, FIST), (1.0, OPEN), (9.0, OPEN)])
def test_first_and_last_finger_key_hold_outside_their_times(time, key):
    angles = ROBOT.skeleton.rest.copy()
    set_fingers(angles, time, {"l": (FIST, OPEN)}, ROBOT)
    np.testing.assert_array_equal(angles[list(finger_joints(ROBOT, "l"))], key.angles)


def test_hand_shape_is_reached_within_5_degrees_at_the_stroke_and_within_limits(counted):
    two = shape_angles(hand_shapes()["two"], ROBOT, "r")
    angles = counted.at("g:stroke").angles[list(finger_joints(ROBOT, "r"))]
    assert np.degrees(np.abs(angles - two)).max() < 5.0
    assert counted.keyframes.outcomes["g"].kind == "realised"
    assert count_violations(counted) == 0
    rest = counted.trajectory.sample(np.array([0.0, counted.trajectory.duration]))[0]
    np.testing.assert_allclose(rest, np.tile(ROBOT.skeleton.rest, (2, 1)), atol=1e-3)


def test_finger_postures_of_left_and_right_are_mirrored(known, counted):
    left = plan(BLOCK.format(mode="left_hand"), known)
    times = np.linspace(0.0, counted.trajectory.duration, 30)
    a, b = (item.trajectory.sample(times)[0] for item in (left, counted))
    here, there = (list(finger_joints(ROBOT, side)) for side in "lr")
    np.testing.assert_allclose(a[:, here], b[:, there], atol=1e-6)


@pytest.mark.parametrize("robot", ["upper36", "human"])
def test_wringing_hands_are_planned_without_notices(robot: str) -> None:
    """The paths have enough clearance, so that nothing is dropped while fingers cross."""
    planned = plan('<bml id="b"><gesture id="g" lexeme="nervous_wring"/></bml>', set_up(robot, voice="durations"))
    assert not planned.notices
