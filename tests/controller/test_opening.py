from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.controller.bench.passage import passage
from kinesic.controller.opening import duration, opening, taken_over
from kinesic.controller.peaks import peaks
from kinesic.controller.plan import plan

LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
OVER = 0.1  # [s]


@pytest.fixture(scope="module")
def pair(known):
    block = parse(passage(1))
    return opening(block, known), plan(block, known)


def largest(trajectory, limits) -> float:
    return max(float(peak.ratios.max()) for peak in peaks(trajectory, limits).shares.values())


def test_a_quintic_of_its_duration_keeps_every_limit():
    s = np.linspace(0, 1, 2001)
    for way in (0.001, 0.03, 0.4, 3.9):
        t = duration(way, LIMITS, 0)
        speed = way / t * 30 * (s**2 - 2 * s**3 + s**4)
        acceleration = way / t**2 * (60 * s - 180 * s**2 + 120 * s**3)
        jerk = way / t**3 * (60 - 360 * s + 360 * s**2)
        duty = LIMITS.inertial * acceleration + LIMITS.viscous * speed
        for values, limit in ((speed, 4), (acceleration, 40), (jerk, 1e3), (duty, 0.7)):
            assert np.abs(values).max() <= limit
    assert duration(0.0, LIMITS, 0) == 0.0


def test_the_opening_is_certified_and_begins_with_the_block(pair, known):
    slow, _ = pair
    assert largest(slow.trajectory, known.limits) <= 1.001
    assert slow.trajectory.zero == pytest.approx(-slow.timeline.start)
    assert slow.clearance.distances.min() >= known.robot.least_clearance


def test_the_opening_rests_at_every_key(pair):
    slow, _ = pair
    times = slow.motion.planned + slow.trajectory.zero
    speeds = slow.trajectory.sample(times)[1]
    for row, posture in enumerate(slow.postures.postures):
        assert np.abs(speeds[row, list(posture.keyed)]).max(initial=0.0) < 0.05


def test_what_it_says_about_times_is_so(pair):
    slow, _ = pair
    reached = slow.trajectory.sample(slow.motion.planned + slow.trajectory.zero)[0]
    for row, posture in enumerate(slow.postures.postures):
        keyed = list(posture.keyed)
        np.testing.assert_allclose(reached[row, keyed], posture.angles[keyed], atol=1.1e-3)


def test_a_better_plan_takes_over_without_a_step(pair, known):
    slow, better = pair
    over = taken_over(slow, better, OVER)
    assert over is not None
    assert largest(over.trajectory, known.limits) <= 1.001
    past = np.linspace(0.0, OVER, 20)
    np.testing.assert_allclose(over.trajectory.sample(past)[0], slow.trajectory.sample(past)[0], atol=1e-9)
    late = np.linspace(better.trajectory.duration - 1.0, better.trajectory.duration, 20)
    np.testing.assert_allclose(over.trajectory.sample(late)[0], better.trajectory.sample(late)[0], atol=1e-9)
    reached = over.trajectory.sample(over.motion.planned + over.trajectory.zero)[0]
    for row, posture in enumerate(better.postures.postures):
        keyed = list(posture.keyed)
        np.testing.assert_allclose(reached[row, keyed], posture.angles[keyed], atol=1.1e-3)
    moved, at_first = (np.abs(found.motion.planned - found.motion.asked).max() for found in (over, slow))
    assert moved <= at_first


def test_another_beginning_cannot_take_over(pair):
    slow, better = pair
    motion = replace(better.motion, trajectory=replace(better.trajectory, zero=better.trajectory.zero + 0.3))
    assert taken_over(slow, replace(better, motion=motion), OVER) is None


def test_a_key_that_is_past_cannot_be_caught_up(pair):
    slow, better = pair
    late = slow.motion.planned - better.motion.planned
    row = int(late.argmax())
    between = (slow.motion.planned[row] + better.motion.planned[row]) / 2 + slow.trajectory.zero
    assert late[row] > 0.012
    assert taken_over(slow, better, float(between)) is None
