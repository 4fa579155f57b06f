import pytest

from kinesic.body.robot import Robot
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.robot_check import check_robot

ROBOT = Robot.load()
CHECK = check_robot(ROBOT)


def test_the_default_robot_is_worth_what_its_sheet_says():
    assert CHECK.mass == pytest.approx(5.945)
    assert CHECK.moving_mass == pytest.approx(4.25)
    assert CHECK.arm_length == pytest.approx(0.42)
    assert CHECK.rest_ratios.max() == pytest.approx(0.120, abs=0.001)
    assert CHECK.worst_ratios.max() == pytest.approx(0.251, abs=0.005)
    assert CHECK.rest_gap.distance == pytest.approx(0.0271, abs=1e-4)
    assert CHECK.zero_gap.distance == pytest.approx(0.0280, abs=1e-4)
    assert CHECK.clear_share == pytest.approx(0.78, abs=0.02)


def test_the_worst_posture_needs_the_worst_share():
    dynamics = MujocoDynamics(ROBOT)
    assert dynamics.static_ratios(CHECK.worst_postures).diagonal() == pytest.approx(CHECK.worst_ratios)
    assert (CHECK.worst_ratios >= CHECK.rest_ratios - 1e-12).all()
    assert (CHECK.worst_postures >= ROBOT.skeleton.lower - 1e-12).all()
    assert (CHECK.worst_postures <= ROBOT.skeleton.upper + 1e-12).all()


def test_the_closest_pairs_are_counted_ones():
    assert CHECK.rest_gap.pair in ROBOT.counted_pairs
    assert CHECK.zero_gap.pair in ROBOT.counted_pairs
