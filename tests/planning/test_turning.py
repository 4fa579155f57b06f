from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.planning.turning import set_turn, turn_of

UPPER22 = Robot.load()
NAMES = ("vl5_tilt", "vl5_roll", "vl5_torsion")  # another robot's order, one body
REORDERED = replace(
    UPPER22,
    skeleton=replace(
        UPPER22.skeleton,
        hinges=tuple(
            replace(hinge, name=NAMES[k]) if k < 3 else hinge for k, hinge in enumerate(UPPER22.skeleton.hinges)
        ),
    ),
)


def test_a_turn_is_written_and_read_back():
    angles = np.array(UPPER22.skeleton.rest)
    set_turn(UPPER22, "neck", np.array([0.3, -0.2, 0.1]), angles)
    assert turn_of(UPPER22, "neck", angles) == pytest.approx([0.3, -0.2, 0.1])


def test_hinges_are_found_by_name_whatever_their_order():
    angles = np.array(REORDERED.skeleton.rest)
    set_turn(REORDERED, "torso", np.array([0.3, 0.2, 0.1]), angles)
    assert angles[:3] == pytest.approx([0.2, 0.1, 0.3])


def test_hinges_of_one_axis_share_it_by_their_room():
    skeleton = UPPER22.skeleton
    hinges = (replace(skeleton.hinges[0], name="vt1_tilt", lower=-0.2, upper=0.2), *skeleton.hinges[1:])
    robot = replace(UPPER22, skeleton=replace(skeleton, hinges=hinges))
    angles = np.array(robot.skeleton.rest)
    set_turn(robot, "torso", np.array([0.5, 0.3, 0.0]), angles)
    assert angles[0] / angles[1] == pytest.approx(0.2 / skeleton.upper[1])
    assert turn_of(robot, "torso", angles) == pytest.approx([0.0, 0.3, 0.0])


def test_ranges_hold():
    angles = np.array(UPPER22.skeleton.rest)
    set_turn(UPPER22, "neck", np.array([9.0, -9.0, 9.0]), angles)
    assert np.all(angles == UPPER22.skeleton.clamp(angles))


def test_a_chain_that_the_robot_lacks_turns_nothing():
    robot, angles = replace(UPPER22, chains={}), np.array(UPPER22.skeleton.rest)
    set_turn(robot, "torso", np.array([0.3, 0.2, 0.1]), angles)
    assert np.array_equal(angles, UPPER22.skeleton.rest)
    assert turn_of(robot, "torso", angles).tolist() == [0.0, 0.0, 0.0]
