"""A sink whose servos are not as in their data sheets, from its first motion to a second one that is led better."""

from dataclasses import replace
from time import monotonic, sleep

import numpy as np
import pytest

from kinesic.controller.perform import plan
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import Stage
from kinesic.motion.trajectory import stay
from kinesic.serve.sinks.learner import ServoLearner
from kinesic.serve.sinks.real_time import RealTimeSink, RealTwin
from kinesic.sim.servo_factors import NOMINAL, Factors

SOFT = Factors(gain=0.6, latency=0.015)
NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" repetition="3"/></bml>'


def performed(sink: RealTimeSink, known, begin: float) -> float:
    """Has a sink follow nods and a second of stillness, as fast as it goes; returns the largest error [rad]."""
    motion = plan(NOD, known).trajectory
    shifted, worst = replace(motion, start=motion.start + begin), 0.0
    for now in np.arange(begin, begin + motion.duration + 1.2, 0.01):
        sink.follow(shifted, float(now), known, lambda time: {})
        worst = max(worst, float(np.abs(sink.sink.seen()[1] - shifted.sample(np.array([now]))[0][0]).max()))
    return worst


def test_what_a_first_motion_has_told_leads_the_second(known):
    sink = RealTimeSink(RealTwin(known.robot, factors=SOFT), learner=ServoLearner(known.robot, NOMINAL))
    first = performed(sink, known, 0.0)
    began, now, resting = monotonic(), 20.0, stay(known.robot.skeleton.rest)
    while sink.lesson is None and monotonic() < began + 120.0:
        sleep(0.05)
        now += 0.01
        sink.follow(resting, now, known, lambda time: {})
    lesson = sink.lesson
    assert lesson is not None
    assert lesson.why == ""
    assert lesson.believed.servos["xc430_w240"].gain == pytest.approx(0.6, rel=0.03)
    assert lesson.believed.latency == pytest.approx(0.015, abs=0.002)
    assert performed(sink, known, now + 2.0) < 0.6 * first
    sink.close()


def still(clock: float, count: int) -> Status:
    angles = np.zeros(count)
    return Status(Stage.ACTIVE, clock, clock, 1.0, angles=angles, goals=angles, taken=np.full(count, clock))


def test_stillness_is_not_looked_at(known):
    learner = ServoLearner(known.robot, NOMINAL)
    learner.see(still(0.01 * k, len(known.robot.drives)) for k in range(3000))
    assert learner.lesson() is None
    assert learner._coming is None
    learner.close()
