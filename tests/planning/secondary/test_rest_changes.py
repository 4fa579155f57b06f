"""Changes of the rest posture in long pauses."""

import numpy as np
import pytest

from kinesic.body.robot import SIDES, Robot
from kinesic.motion.trajectory import stay
from kinesic.planning.secondary.rest_changes import MIN_REST_SPAN, make_rest_changes
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

ROBOT = Robot.load()
WAIT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><wait id="w" duration="{}"/></bml>'


def changes(duration, seed=0):
    motion = stay(ROBOT.skeleton.rest, duration)
    return [*make_rest_changes(motion, (0.0, duration), 1.0, ROBOT, np.random.default_rng(seed))]


def test_long_rest_changes_its_posture_every_10_to_20_seconds():
    result = changes(60.0)
    begins = np.array([change.begin for change in result])
    assert np.all((np.diff(begins) > 10.0) & (np.diff(begins) < 20.0))
    assert result[0].begin >= 0.3
    assert result[-1].end <= 60.0
    arms = [joint for side in SIDES for joint in ROBOT.arm(side).joints]
    assert all(np.degrees(np.abs(change.away[arms]).max()) > 4.0 for change in result)
    roll = ROBOT.skeleton.joint("vl5_roll")
    assert all(1.0 < abs(np.degrees(change.away[roll])) < 3.0 for change in result)


def test_short_rest_keeps_its_posture():
    assert changes(MIN_REST_SPAN - 1.0) == []


def test_rest_changes_are_repeatable_by_seed():
    one, same, other = (changes(20.0, seed)[0].away for seed in (3, 3, 4))
    assert np.array_equal(one, same)
    assert not np.allclose(one, other)


@pytest.mark.parametrize("robot", ["human", "upper22"])
def test_idle_body_changes_its_rest_and_comes_back(robot):
    made = plan(WAIT.format(12), set_up(robot, idle=1.0))
    body = made.setup.robot
    arms = [joint for side in SIDES for joint in body.arm(side).joints]
    offsets = np.degrees(np.abs(made.trajectory.controls - body.skeleton.rest))
    assert offsets[len(offsets) // 2, arms].max() > 3.0
    assert offsets[[0, -1]].max() < 1e-6
    assert made.clearance.distances.min() >= body.min_clearance
    exact = plan(WAIT.format(12), set_up(robot)).trajectory.controls
    assert np.abs(exact - body.skeleton.rest).max() < 1e-9
