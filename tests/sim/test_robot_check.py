import pytest

from kinesic.body.robot import Robot
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.robot_check import check_robot

ROBOT = Robot.load()
ROBOT_CHECK = check_robot(ROBOT)


def test_default_robot_has_the_documented_check_values():
    assert ROBOT_CHECK.mass == pytest.approx(5.945)
    assert ROBOT_CHECK.moving_mass == pytest.approx(4.25)
    assert ROBOT_CHECK.arm_length == pytest.approx(0.42)
    assert ROBOT_CHECK.rest_ratios.max() == pytest.approx(0.108, abs=0.001)
    assert ROBOT_CHECK.worst_ratios.max() == pytest.approx(0.251, abs=0.005)
    assert ROBOT_CHECK.rest_gap.distance == pytest.approx(0.0279, abs=1e-4)
    assert ROBOT_CHECK.zero_gap.distance == pytest.approx(0.0280, abs=1e-4)
    assert ROBOT_CHECK.clear_share == pytest.approx(0.78, abs=0.02)


def test_recorded_worst_torque_ratio_is_that_of_the_recorded_worst_posture():
    dynamics = MujocoDynamics(ROBOT)
    assert dynamics.static_ratios(ROBOT_CHECK.worst_postures).diagonal() == pytest.approx(ROBOT_CHECK.worst_ratios)
    assert (ROBOT_CHECK.worst_ratios >= ROBOT_CHECK.rest_ratios - 1e-12).all()
    assert (ROBOT_CHECK.worst_postures >= ROBOT.skeleton.lower - 1e-12).all()
    assert (ROBOT_CHECK.worst_postures <= ROBOT.skeleton.upper + 1e-12).all()


def test_closest_segment_pairs_of_the_robot_check_belong_to_the_checked_pairs():
    assert ROBOT_CHECK.rest_gap.pair in ROBOT.counted_pairs
    assert ROBOT_CHECK.zero_gap.pair in ROBOT.counted_pairs
