"""Sink with deviating servos: the second motion is better after identification."""

from concurrent.futures import Future
from dataclasses import replace
from time import monotonic, sleep

import numpy as np
import pytest

from kinesic.controller.learned_gains import Identification
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.motion.trajectory import stay
from kinesic.serve.sinks.learner import (
    CYCLE_RATE,
    INITIAL_REST,
    MAX_ATTEMPTS,
    MIN_MOTION_DURATION,
    REST_DURATION,
    ServoLearner,
)
from kinesic.serve.sinks.real_time import RealTimeSink, RealTwin
from kinesic.session.plan import plan
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors

SOFT_SERVOS = Factors(gain=0.6, latency=0.015)
NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" repetition="3"/></bml>'


def performed(sink: RealTimeSink, known, begin: float) -> float:
    """Perform nods and a second of rest, and return the largest error [rad]."""
    motion = plan(NOD, known).trajectory
    shifted, worst = replace(motion, start=motion.start + begin), 0.0
    for now in np.arange(begin, begin + motion.duration + 1.2, 0.01):
        sink.follow(shifted, float(now), known, lambda time: {})
        worst = max(worst, float(np.abs(sink.sink.measurement()[1] - shifted.sample(np.array([now]))[0][0]).max()))
    return worst


def test_servo_parameters_identified_in_the_first_motion_improve_the_second(known):
    sink = RealTimeSink(RealTwin(known.robot, factors=SOFT_SERVOS), learner=ServoLearner(known.robot, NOMINAL_FACTORS))
    first = performed(sink, known, 0.0)
    began, now, resting = monotonic(), 20.0, stay(known.robot.skeleton.rest)
    while sink.lesson is None and monotonic() < began + 120.0:
        sleep(0.05)
        now += 0.01
        sink.follow(resting, now, known, lambda time: {})
    lesson = sink.lesson
    assert lesson is not None
    assert lesson.why == ""
    assert lesson.estimate.servos["xc430_w240"].gain == pytest.approx(0.6, rel=0.03)
    assert lesson.estimate.latency == pytest.approx(0.015, abs=0.002)
    assert performed(sink, known, now + 2.0) < 0.6 * first
    sink.close()


def still(clock: float, count: int) -> Status:
    angles = np.zeros(count)
    return Status(Stage.ACTIVE, clock, clock, 1.0, angles=angles, setpoints=angles, taken=np.full(count, clock))


def test_servos_are_not_identified_without_motion(known):
    learner = ServoLearner(known.robot, NOMINAL_FACTORS)
    learner.see(still(0.01 * k, len(known.robot.drives)) for k in range(3000))
    assert learner.lesson() is None
    assert learner._result is None
    learner.close()


@pytest.mark.parametrize("change", [{"stage": Stage.HOLD}, {"time": np.nan}])
def test_cycles_recorded_for_servo_identification_are_discarded_at_an_interruption(known, change):
    learner, count = ServoLearner(known.robot, NOMINAL_FACTORS), len(known.robot.drives)
    learner.see(still(0.01 * k, count) for k in range(10))
    assert len(learner._cycles) == 10
    step = 0.01 * known.robot.drives.no_load
    learner.see(replace(still(0.1 + 0.01 * k, count), setpoints=k * step) for k in range(10))
    assert learner._motion_time > 0.0
    learner.see([replace(still(0.2, count), **change)])
    assert not learner._cycles
    assert learner._motion_time == learner._rest_time == 0.0
    learner.close()


def test_servo_identification_result_is_returned_once_when_it_has_ended(known):
    learner = ServoLearner(known.robot, NOMINAL_FACTORS)
    learner._result = running = Future()
    assert learner.lesson() is None
    running.set_result(Identification(NOMINAL_FACTORS, why="too little motion"))
    assert learner.lesson() is running.result()
    assert learner.lesson() is None
    learner.close()


def test_short_motion_before_a_rest_is_not_used_for_servo_identification(known):
    learner, count = ServoLearner(known.robot, NOMINAL_FACTORS), len(known.robot.drives)
    step = 0.01 * known.robot.drives.no_load
    learner.see(replace(still(0.01 * k, count), setpoints=k * step) for k in range(20))
    assert learner._motion_time == pytest.approx(0.19)
    last = 19 * step
    learner.see(replace(still(0.2 + 0.01 * k, count), setpoints=last) for k in range(round(100 * REST_DURATION) + 2))
    assert learner._motion_time == 0.0
    assert len(learner._cycles) == round(INITIAL_REST * CYCLE_RATE)
    learner.close()


def test_failed_identification_is_repeated_up_to_the_maximum_number_of_attempts(known):
    learner = ServoLearner(known.robot, NOMINAL_FACTORS)
    for attempt in range(1, MAX_ATTEMPTS + 2):
        learner._motion_time, learner._rest_time = MIN_MOTION_DURATION, REST_DURATION
        learner.see([])
        assert learner._attempts == min(attempt, MAX_ATTEMPTS)
        assert (learner._result is not None) == (attempt <= MAX_ATTEMPTS)
        if learner._result is not None:
            learner._result.result(20.0)  # no telemetry was recorded
            assert learner.lesson().why
    learner.close()
