"""Tests of conversion between arm postures and link directions."""

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.planning.arm_directions import measure_arm, set_arm

TESTED_ROBOTS = {name: Robot.load(name) for name in ("human", "upper22", "upper36")}  # robots by name
HANGING_ARM = np.array([-6.0, 12.0, 25.0, 3.0, 14.0, -4.0])  # [deg] directions of a person's hanging arm


@pytest.mark.parametrize("name", TESTED_ROBOTS)
@pytest.mark.parametrize("side", ["l", "r"])
def test_arm_set_to_given_link_directions_has_them_within_one_degree(name, side):
    robot = TESTED_ROBOTS[name]
    posture = set_arm(robot, side, HANGING_ARM, np.array(robot.skeleton.rest))
    assert np.abs(measure_arm(robot, side, posture) - HANGING_ARM).max() < 1.0
    moved = np.flatnonzero(posture != robot.skeleton.rest)
    assert set(moved.tolist()) <= set(robot.arm(side).joints)


def test_arm_directions_are_relative_to_the_turned_shoulders():
    robot = TESTED_ROBOTS["human"]
    turned = np.array(robot.skeleton.rest)
    turned[robot.skeleton.joint("vl5_torsion")] = np.radians(20.0)
    assert measure_arm(robot, "l", turned) == pytest.approx(measure_arm(robot, "l", robot.skeleton.rest), abs=1e-6)


def test_arm_set_to_unreachable_directions_keeps_the_joint_limits():
    robot = TESTED_ROBOTS["upper36"]
    posture = set_arm(robot, "l", np.array([-170.0, 5.0, 80.0, -60.0, -120.0, 80.0]), np.array(robot.skeleton.rest))
    assert np.all((posture >= robot.skeleton.lower) & (posture <= robot.skeleton.upper))


def test_arm_directions_computed_for_several_postures_at_once_equal_single_results():
    robot = TESTED_ROBOTS["human"]
    postures = np.stack([robot.skeleton.rest, set_arm(robot, "l", HANGING_ARM, np.array(robot.skeleton.rest))])
    single = [measure_arm(robot, "l", posture) for posture in postures]
    np.testing.assert_allclose(measure_arm(robot, "l", postures), single, atol=1e-9)
