"""Tips that meet, on hands of two sizes."""

import numpy as np
import pytest

from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.hands.fingers import finger_joints, shape_angles
from kinesic.expressivity.hands.fingertips import PLAY, meeting_angles
from kinesic.expressivity.lexicon.hand_shapes import hand_shapes

ROBOTS = [Robot.load(name) for name in ("upper36", "human")]
PLAIN = Robot.load("upper22")


def tips(robot, side, angles):
    """Where the balls of all fingers of a hand are [m], and their radii [m]."""
    posture = robot.skeleton.rest.copy()
    posture[list(finger_joints(robot, side))] = angles
    frames = robot.skeleton.frames(posture)
    return {
        name: (frames.origins[tip.segment] + frames.rotations[tip.segment] @ tip.place, tip.radius)
        for name, tip in robot.finger_tips(side).items()
    }


def gap(found, a, b):
    return float(np.linalg.norm(found[a][0] - found[b][0])) - found[a][1] - found[b][1]


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("name", ["ring", "pinch"])
def test_thumb_and_forefinger_meet(robot, side, name):
    found = tips(robot, side, shape_angles(hand_shapes()[name], robot, side))
    assert gap(found, "index", "thumb") == pytest.approx(PLAY, abs=1e-3)


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_tips_in_a_purse_are_together(robot):
    found = tips(robot, "l", shape_angles(hand_shapes()["purse"], robot, "l"))
    assert gap(found, "index", "thumb") < 0.006
    assert max(gap(found, a, b) for a, b in (("index", "middle"), ("middle", "ring"), ("ring", "pinky"))) < 0.01


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_crossed_fingers_change_their_order(robot):
    straight, crossed = (tips(robot, "l", shape_angles(hand_shapes()[name], robot, "l")) for name in ("two", "crossed"))
    wrist = robot.arm("l").wrist
    forward = robot.skeleton.resting.rotations[wrist][:, 0]  # towards the thumb's side of the hand
    before, after = (forward @ (found["index"][0] - found["middle"][0]) for found in (straight, crossed))
    assert before > 0.02
    assert after < 0.0
    assert gap(crossed, "index", "middle") > 0.0


def test_a_hand_that_lacks_the_fingers_stays_as_it_began():
    begun = np.zeros(0)
    assert meeting_angles(begun, ("index",), PLAIN, "l") is begun
    robot = ROBOTS[0]
    begun = shape_angles(hand_shapes()["fist"], robot, "l")
    assert meeting_angles(begun, ("sixth",), robot, "l") is begun


def test_fingers_that_meet_nobody_stay_as_they_are():
    robot = ROBOTS[0]
    begun = shape_angles(hand_shapes()["open"], robot, "l")
    names = [robot.skeleton.names[joint] for joint in finger_joints(robot, "l")]
    moved = {
        name for name, a, b in zip(names, begun, meeting_angles(begun, ("middle",), robot, "l"), strict=True) if a != b
    }
    assert moved == {"l_thumb_abduct", "l_thumb_flexion1", "l_middle_flexion1"}
