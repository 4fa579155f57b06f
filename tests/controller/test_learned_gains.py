import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.controller.learned_gains import LearnedGains
from kinesic.controller.observer_step import SHARES
from kinesic.sim.servo_factors import DriveFactors, Factors

ROBOT = Robot.load()


def test_a_fitted_twin_says_how_to_lead_its_servos():
    """Half the gain takes twice the error for all; a weak motor takes more for torque alone."""
    soft = LearnedGains.of_twin(ROBOT, Factors(gain=0.5))
    np.testing.assert_allclose([soft.load, soft.lead], 1.0)
    weak = LearnedGains.of_twin(ROBOT, Factors(stall=0.8))
    np.testing.assert_allclose(weak.load, 0.25)
    np.testing.assert_allclose(weak.lead, 0.0, atol=1e-12)
    slow = LearnedGains.of_twin(ROBOT, Factors(servos={"xm540_w270": DriveFactors(no_load=0.8)}))
    for k, drive in enumerate(ROBOT.drives):
        assert slow.lead[k] == pytest.approx(0.25 if drive.servo.name == "xm540_w270" else 0.0)


def test_it_stays_within_what_a_servo_may_be_wrong_by():
    low, high = SHARES
    soft, stiff = (LearnedGains.of_twin(ROBOT, Factors(gain=gain)) for gain in (0.2, 5.0))
    np.testing.assert_allclose([soft.load, soft.lead], high)
    np.testing.assert_allclose([stiff.load, stiff.lead], low)


def test_a_fitted_twin_says_how_late_goals_come():
    assert LearnedGains.of_twin(ROBOT, Factors(latency=0.012)).delay == 0.012
