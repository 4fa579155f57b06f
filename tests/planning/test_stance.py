"""Standing postures drawn like those of captured people."""

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.planning.stance import (
    ARM_FEATURES,
    STANCE_FEATURES,
    draw_deviation,
    measure_arm,
    read_stances,
    set_arm,
    spread_features,
)

ROBOTS = {name: Robot.load(name) for name in ("human", "upper22", "upper36")}
HANGING_REST = np.array([-6.0, 12.0, 25.0, 3.0, 14.0, -4.0])  # [deg] directions of a person's hanging arm


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("side", ["l", "r"])
def test_links_of_an_arm_take_the_directions_of_a_stance(name, side):
    robot = ROBOTS[name]
    posture = set_arm(robot, side, HANGING_REST, np.array(robot.skeleton.rest))
    assert np.abs(measure_arm(robot, side, posture) - HANGING_REST).max() < 1.0
    moved = np.flatnonzero(posture != robot.skeleton.rest)
    assert set(moved.tolist()) <= set(robot.arm(side).joints)


def test_directions_are_relative_to_the_turned_shoulders():
    robot = ROBOTS["human"]
    turned = np.array(robot.skeleton.rest)
    turned[robot.skeleton.joint("vl5_torsion")] = np.radians(20.0)
    assert measure_arm(robot, "l", turned) == pytest.approx(measure_arm(robot, "l", robot.skeleton.rest), abs=1e-6)


def test_unreachable_directions_keep_the_joint_limits():
    robot = ROBOTS["upper36"]
    posture = set_arm(robot, "l", np.array([-170.0, 5.0, 80.0, -60.0, -120.0, 80.0]), np.array(robot.skeleton.rest))
    assert np.all((posture >= robot.skeleton.lower) & (posture <= robot.skeleton.upper))


def test_drawn_stances_have_the_distribution_of_their_table():
    table = read_stances().hanging
    draws = np.stack([draw_deviation(table, np.random.default_rng(seed)) for seed in range(400)])
    tilt = [row["trunk_tilt"] for row in table.symmetric] + [table.within["trunk_tilt"]]
    expected = float(np.linalg.norm(tilt))
    column = STANCE_FEATURES.index("trunk_tilt")
    assert 0.8 * expected < draws[:, column].std() < 1.05 * expected
    assert np.abs(draws.mean(axis=0)).max() < 1.0
    left, right = draws[:, -2 * len(ARM_FEATURES) :].reshape(len(draws), 2, -1).transpose(1, 0, 2)
    assert np.all((left - right).std(axis=0) > 0.5)
    assert np.corrcoef(left[:, 0], right[:, 0])[0, 1] > 0.5


def test_arms_of_the_mean_stance_are_bent_and_near_the_body():
    mean = dict(zip(STANCE_FEATURES, spread_features(read_stances().hanging.mean), strict=True))
    assert 15.0 < mean["l_forearm_forward"] - mean["l_upper_arm_forward"] < 30.0
    assert mean["l_upper_arm_outward"] > mean["l_forearm_outward"] > 0.0
    assert mean["l_hand_forward"] == mean["r_hand_forward"] < mean["l_forearm_forward"]
