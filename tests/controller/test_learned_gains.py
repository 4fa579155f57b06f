from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.controller.learned_gains import GAIN_FACTOR_RANGE, LearnedGains, identify_servos, reduce_stiffness
from kinesic.controller.observer_step import LOAD_ERROR_RANGE
from kinesic.sim.fitting.parameters import MAX_LATENCY
from kinesic.sim.log import Log, make_log
from kinesic.sim.servo_factors import NOMINAL_FACTORS, DriveFactors, Factors
from kinesic.sim.twin import Twin

ROBOT = Robot.load()


def test_learned_feed_forward_gains_follow_from_fitted_servo_factors():
    """Half the gain doubles all offsets; a weak motor increases the torque offset alone."""
    soft = LearnedGains.of_twin(ROBOT, Factors(gain=0.5))
    np.testing.assert_allclose([soft.load, soft.lead], 1.0)
    weak = LearnedGains.of_twin(ROBOT, Factors(stall=0.8))
    np.testing.assert_allclose(weak.load, 0.25)
    np.testing.assert_allclose(weak.lead, 0.0, atol=1e-12)
    slow = LearnedGains.of_twin(ROBOT, Factors(servos={"xm540_w270": DriveFactors(no_load=0.8)}))
    for k, drive in enumerate(ROBOT.drives):
        assert slow.lead[k] == pytest.approx(0.25 if drive.servo.name == "xm540_w270" else 0.0)


def test_learned_feed_forward_gains_stay_in_the_load_error_range():
    low, high = LOAD_ERROR_RANGE
    soft, stiff = (LearnedGains.of_twin(ROBOT, Factors(gain=gain)) for gain in (0.2, 5.0))
    np.testing.assert_allclose([soft.load, soft.lead], high)
    np.testing.assert_allclose([stiff.load, stiff.lead], low)


def test_learned_delay_is_the_fitted_latency_up_to_its_maximum():
    assert LearnedGains.of_twin(ROBOT, Factors(latency=0.012)).delay == 0.012
    assert LearnedGains.of_twin(ROBOT, Factors(latency=0.5)).delay == MAX_LATENCY


def test_learned_feed_forward_gains_are_interpolated_linearly_between_samples():
    some, others = (LearnedGains.of_twin(ROBOT, twin) for twin in (NOMINAL_FACTORS, Factors(gain=0.5, latency=0.02)))
    mixed = some.towards(others, np.array([0.0, 0.5, 1.0]))
    np.testing.assert_allclose(mixed.delay, [0.0, 0.01, 0.02])
    for rows in (mixed.load, mixed.lead):
        np.testing.assert_allclose(rows, np.outer([0.0, 0.5, 1.0], np.ones(len(ROBOT.drives))))


def nodding(twin: Factors, *, swing: float = 0.3) -> Log:
    """Return the log of a twin whose neck nods for 0.8 s."""
    body, still, tilt = Twin(ROBOT, factors=twin), np.zeros(len(ROBOT.drives)), ROBOT.skeleton.joint("skullbase_tilt")
    for k in range(81):
        goals = ROBOT.skeleton.rest.copy()
        goals[tilt] += swing * np.sin(0.15 * k)
        body.write(Command(0.01 * k, goals, still, still, goals))
    return make_log(body.measurements())


def test_servo_factors_that_the_motion_does_not_determine_keep_the_earlier_estimate():
    neck, arm = "xc430_w240", "xm540_w270"
    before = Factors(stall=0.9, servos={arm: DriveFactors(gain=0.8)}, mass=1.1)
    wrong = Factors(stall=0.9, servos={arm: DriveFactors(gain=0.8), neck: DriveFactors(stall=0.9, gain=0.6)}, mass=1.1)
    lesson = identify_servos(nodding(wrong), ROBOT, before)
    assert lesson.why == ""
    assert lesson.estimate.servos[neck].gain == pytest.approx(0.6, rel=0.03)
    assert (lesson.estimate.servos[neck].stall, lesson.estimate.mass) == (0.9, 1.1)
    assert lesson.estimate.servos[arm].gain == pytest.approx(0.8, rel=0.02)
    assert lesson.after < 0.2 * lesson.before


def test_servo_gain_below_its_range_is_clipped_and_reported():
    lesson = identify_servos(nodding(Factors(gain=0.3)), ROBOT)
    assert lesson.estimate.servos["xc430_w240"].gain == GAIN_FACTOR_RANGE[0]
    assert lesson.bounded
    assert "the estimate is at its bounds" in str(lesson)


def test_servos_with_too_little_or_unexplained_motion_are_not_identified():
    standing = identify_servos(nodding(NOMINAL_FACTORS, swing=0.01), ROBOT)
    assert "servos moved for 0.0 s, at least 0.4 s are needed" in standing.why
    log = nodding(NOMINAL_FACTORS)
    held = log.angles.copy()
    held[:, ROBOT.skeleton.joint("l_elbow_flexion")] += np.linspace(0.0, 1.5, len(held))
    lesson = identify_servos(replace(log, angles=held), ROBOT)
    assert "gain and delay do not explain the motion" in lesson.why
    assert lesson.estimate is NOMINAL_FACTORS
    assert str(lesson).startswith("nothing learned: ")


def test_reduced_servo_stiffness_is_at_most_that_of_the_data_sheet():
    robot = Robot.load()
    for gain, softer in ((0.7, 0.7), (1.5, 1.0)):
        result = reduce_stiffness(robot, Factors(gain=gain)).drives.gain / robot.drives.gain
        assert result == pytest.approx(np.full(len(result), softer))
