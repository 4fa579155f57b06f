"""Tests of meeting fingertips on hands of two sizes."""

import numpy as np
import pytest

from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.hands.fingers import finger_joints, shape_angles
from kinesic.expressivity.hands.fingertips import TIP_GAP, meeting_angles
from kinesic.expressivity.lexicon.hand_shapes import hand_shapes

FINGER_ROBOTS = [Robot.load(name) for name in ("upper36", "human")]
PLAIN_ROBOT = Robot.load("upper22")


def tips(robot, side, angles):
    """Return the centres and radii of all fingertip spheres [m]."""
    posture = robot.skeleton.rest.copy()
    posture[list(finger_joints(robot, side))] = angles
    frames = robot.skeleton.frames(posture)
    return {
        name: (frames.origins[tip.segment] + frames.rotations[tip.segment] @ tip.place, tip.radius)
        for name, tip in robot.finger_tips(side).items()
    }


def gap(found, a, b):
    return float(np.linalg.norm(found[a][0] - found[b][0])) - found[a][1] - found[b][1]


@pytest.mark.parametrize("robot", FINGER_ROBOTS, ids=lambda robot: robot.name)
@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("name", ["ring", "pinch"])
def test_thumb_and_index_fingertips_meet_in_each_hand_shape_with_their_contact(robot, side, name):
    result = tips(robot, side, shape_angles(hand_shapes()[name], robot, side))
    assert gap(result, "index", "thumb") == pytest.approx(TIP_GAP, abs=1e-3)


@pytest.mark.parametrize("robot", FINGER_ROBOTS, ids=lambda robot: robot.name)
def test_purse_hand_shape_brings_all_fingertips_together(robot):
    result = tips(robot, "l", shape_angles(hand_shapes()["purse"], robot, "l"))
    assert gap(result, "index", "thumb") < 0.006
    assert max(gap(result, a, b) for a, b in (("index", "middle"), ("middle", "ring"), ("ring", "pinky"))) < 0.01


@pytest.mark.parametrize("robot", FINGER_ROBOTS, ids=lambda robot: robot.name)
def test_crossed_hand_shape_swaps_index_and_middle_fingertips(robot):
    straight, crossed = (tips(robot, "l", shape_angles(hand_shapes()[name], robot, "l")) for name in ("two", "crossed"))
    wrist = robot.arm("l").wrist
    forward = robot.skeleton.rest_frames.rotations[wrist][:, 0]  # towards the thumb's side of the hand
    before, after = (forward @ (item["index"][0] - item["middle"][0]) for item in (straight, crossed))
    assert before > 0.02
    assert after < 0.0
    assert gap(crossed, "index", "middle") > 0.0


def test_fingertip_contact_of_missing_fingers_leaves_the_hand_unchanged():
    begun = np.zeros(0)
    assert meeting_angles(begun, ("index",), PLAIN_ROBOT, "l") is begun
    robot = FINGER_ROBOTS[0]
    begun = shape_angles(hand_shapes()["fist"], robot, "l")
    assert meeting_angles(begun, ("sixth",), robot, "l") is begun


def test_fingertip_contact_moves_only_the_thumb_and_the_touching_finger():
    robot = FINGER_ROBOTS[0]
    begun = shape_angles(hand_shapes()["open"], robot, "l")
    names = [robot.skeleton.names[joint] for joint in finger_joints(robot, "l")]
    moved = {
        name for name, a, b in zip(names, begun, meeting_angles(begun, ("middle",), robot, "l"), strict=True) if a != b
    }
    assert moved == {"l_thumb_abduct", "l_thumb_flexion1", "l_middle_flexion1"}
