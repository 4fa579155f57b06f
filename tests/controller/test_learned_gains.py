from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.controller.learned_gains import GAINS, LearnedGains, learn, soften
from kinesic.controller.observer_step import SHARES
from kinesic.sim.fitting.parameters import MOST_LATENCY
from kinesic.sim.log import Log, log_of
from kinesic.sim.servo_factors import NOMINAL, DriveFactors, Factors
from kinesic.sim.twin import Twin

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
    assert LearnedGains.of_twin(ROBOT, Factors(latency=0.5)).delay == MOST_LATENCY


def test_one_belief_goes_over_into_another_by_shares():
    some, others = (LearnedGains.of_twin(ROBOT, twin) for twin in (NOMINAL, Factors(gain=0.5, latency=0.02)))
    mixed = some.towards(others, np.array([0.0, 0.5, 1.0]))
    np.testing.assert_allclose(mixed.delay, [0.0, 0.01, 0.02])
    for rows in (mixed.load, mixed.lead):
        np.testing.assert_allclose(rows, np.outer([0.0, 0.5, 1.0], np.ones(len(ROBOT.drives))))


def nodding(twin: Factors, *, swing: float = 0.3) -> Log:
    """The neck of a twin nods for 1.2 s, and nothing else moves."""
    body, still, tilt = Twin(ROBOT, factors=twin), np.zeros(len(ROBOT.drives)), ROBOT.skeleton.joint("skullbase_tilt")
    for k in range(121):
        goals = ROBOT.skeleton.rest.copy()
        goals[tilt] += swing * np.sin(0.15 * k)
        body.write(Command(0.01 * k, goals, still, still, goals))
    return log_of(body.measurements())


def test_what_a_motion_does_not_tell_is_believed_as_before():
    neck, arm = "xc430_w240", "xm540_w270"
    before = Factors(stall=0.9, servos={arm: DriveFactors(gain=0.8)}, mass=1.1)
    wrong = Factors(stall=0.9, servos={arm: DriveFactors(gain=0.8), neck: DriveFactors(stall=0.9, gain=0.6)}, mass=1.1)
    lesson = learn(nodding(wrong), ROBOT, before)
    assert lesson.why == ""
    assert lesson.believed.servos[neck].gain == pytest.approx(0.6, rel=0.03)
    assert (lesson.believed.servos[neck].stall, lesson.believed.mass) == (0.9, 1.1)
    assert lesson.believed.servos[arm].gain == pytest.approx(0.8, rel=0.02)
    assert lesson.after < 0.2 * lesson.before


def test_servos_further_off_than_is_safe_are_believed_to_be_as_far_as_that_and_no_further():
    lesson = learn(nodding(Factors(gain=0.3)), ROBOT)
    assert lesson.believed.servos["xc430_w240"].gain == GAINS[0]
    assert lesson.bounded
    assert "further off than is believed" in str(lesson)


def test_nothing_is_learned_from_servos_that_stand_or_are_held():
    standing = learn(nodding(NOMINAL, swing=0.01), ROBOT)
    assert "servos moved for 0.0 s, at least 0.4 s are needed" in standing.why
    log = nodding(NOMINAL)
    held = log.angles.copy()
    held[:, ROBOT.skeleton.joint("l_elbow_flexion")] += np.linspace(0.0, 1.5, len(held))
    lesson = learn(replace(log, angles=held), ROBOT)
    assert "gain and delay do not explain the motion" in lesson.why
    assert lesson.believed is NOMINAL
    assert str(lesson).startswith("nothing learned: ")


def test_all_servos_are_as_soft_as_they_are_believed_to_be_and_none_is_stiffer():
    robot = Robot.load()
    for gain, softer in ((0.7, 0.7), (1.5, 1.0)):
        found = soften(robot, Factors(gain=gain)).drives.gain / robot.drives.gain
        assert found == pytest.approx(np.full(len(found), softer))
