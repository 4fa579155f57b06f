import numpy as np
import pytest

from kinesic.bench.plan import violations
from kinesic.body.robot import Robot
from kinesic.controller.perform import plan, set_up
from kinesic.expressivity.hands.fingers import finger_joints, shape_angles
from kinesic.expressivity.keyframes import FingerKey
from kinesic.expressivity.lexicon.hand_shapes import hand_shapes
from kinesic.motion.keys import KeyPosture
from kinesic.planning.finger_postures import set_fingers, with_finger_keys

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


def test_keys_of_fingers_are_no_firm_ones_and_fall_on_no_other():
    rest = ROBOT.skeleton.rest
    postures = [KeyPosture.whole(time, rest) for time in (0.0, 0.5, 2.0)]
    found = with_finger_keys(postures, {"l": (FIST, OPEN), "r": (FIST,)}, ROBOT)
    assert [posture.firm for posture in found] == [True, True, False, False, True]
    assert len({posture.time for posture in found}) == len(found)
    both, left = found[2], found[3]
    assert set(np.flatnonzero(both.keyed)) == {*finger_joints(ROBOT, "l"), *finger_joints(ROBOT, "r")}
    assert set(np.flatnonzero(left.keyed)) == set(finger_joints(ROBOT, "l"))
    np.testing.assert_array_equal(both.angles[list(finger_joints(ROBOT, "r"))], FIST.angles)
    assert with_finger_keys(postures, {}, ROBOT) == tuple(postures)


def test_a_posture_has_the_fingers_of_its_time():
    angles = ROBOT.skeleton.rest.copy()
    set_fingers(angles, 0.75, {"l": (FIST, OPEN)}, ROBOT)
    np.testing.assert_allclose(angles[list(finger_joints(ROBOT, "l"))], (FIST.angles + OPEN.angles) / 2)
    others = np.delete(np.arange(36), finger_joints(ROBOT, "l"))
    np.testing.assert_array_equal(angles[others], ROBOT.skeleton.rest[others])


def test_a_shape_is_made_within_the_limits_when_the_stroke_begins(counted):
    two = shape_angles(hand_shapes()["two"], ROBOT, "r")
    angles = counted.at("g:stroke").angles[list(finger_joints(ROBOT, "r"))]
    assert np.degrees(np.abs(angles - two)).max() < 5.0
    assert counted.keyframes.outcomes["g"].kind == "realised"
    assert violations(counted) == 0
    rest = counted.trajectory.sample(np.array([0.0, counted.trajectory.duration]))[0]
    np.testing.assert_allclose(rest, np.tile(ROBOT.skeleton.rest, (2, 1)), atol=1e-3)


def test_left_mirrors_right(known, counted):
    left = plan(BLOCK.format(mode="left_hand"), known)
    times = np.linspace(0.0, counted.trajectory.duration, 30)
    a, b = (each.trajectory.sample(times)[0] for each in (left, counted))
    here, there = (list(finger_joints(ROBOT, side)) for side in "lr")
    np.testing.assert_allclose(a[:, here], b[:, there], atol=1e-6)


@pytest.mark.parametrize("robot", ["upper36", "human"])
def test_hands_that_wring_one_another_keep_clear(robot: str) -> None:
    """Each way has room, so that nothing is left out; fingers of one hand pass over those of the other."""
    planned = plan('<bml id="b"><gesture id="g" lexeme="nervous_wring"/></bml>', set_up(robot, voice="durations"))
    assert not planned.notices
