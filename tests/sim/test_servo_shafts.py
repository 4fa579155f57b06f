import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors
from kinesic.sim.servo_shafts import Shafts
from kinesic.sim.twin import Twin


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load()


@pytest.mark.parametrize("factors", [NOMINAL_FACTORS, Factors(play=0.01)], ids=["as made", "with play"])
def test_shafts_with_full_torque_move_like_the_twin(robot: Robot, factors: Factors):
    """Equal setpoints give equal motion over one second of a swinging arm."""
    rest = robot.skeleton.rest
    twin, shafts = Twin(robot, factors=factors, rounds=False), Shafts(robot, factors=factors)
    moving = robot.joints("l_arm")
    ones, zeros = np.ones(len(rest)), np.zeros(len(rest))
    for k in range(101):
        goals = np.array(rest)
        goals[list(moving)] += 0.2 * np.sin(k / 100 * 2 * np.pi)
        twin.write(Command(time=k / 100, angles=goals, velocities=zeros, accelerations=zeros, setpoints=goals))
        if k < 100:
            shafts.advance(0.01, goals, ones)
    np.testing.assert_allclose(shafts.angles, twin.state().angles, atol=1e-12)
    assert np.abs(shafts.velocities[list(moving)]).max() > 0.5


def test_arm_falls_with_torque_off_and_holds_with_torque_on(robot: Robot):
    rest = np.array(robot.skeleton.rest)
    start = rest.copy()
    raised = robot.skeleton.joint("l_shoulder_flexion")
    start[raised] = np.deg2rad(80)
    limp, held = Shafts(robot, start=start), Shafts(robot, start=start)
    for _ in range(100):
        limp.advance(0.01, start, np.zeros(len(rest)))
        held.advance(0.01, start, np.ones(len(rest)))
    assert limp.angles[raised] < start[raised] - 0.5
    assert abs(held.angles[raised] - start[raised]) < 0.1
    assert limp.loads[raised] == 0.0
    assert 0.02 < abs(held.loads[raised]) < 0.6
    assert held.duties[raised] == pytest.approx(held.loads[raised], abs=0.02)


def test_torque_ratio_limits_the_shaft_torque(robot: Robot):
    rest = np.array(robot.skeleton.rest)
    far = rest.copy()
    elbow = robot.skeleton.joint("l_elbow_flexion")
    far[elbow] += 1.0
    weak = Shafts(robot)
    for _ in range(20):
        weak.advance(0.01, far, np.full(len(rest), 0.3))
        assert np.abs(weak.loads).max() <= 0.3 + 1e-9


def test_advancing_servo_shafts_by_zero_duration_changes_no_angle(robot: Robot):
    shafts = Shafts(robot)
    before = shafts.angles
    shafts.advance(0.0, before + 1.0, np.ones(len(before)))
    assert (shafts.angles == before).all()
