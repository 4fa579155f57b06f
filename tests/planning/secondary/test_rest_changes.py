"""Tests of changes of the rest posture in long pauses."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.robot import SIDES, Robot
from kinesic.expressivity.style.standing import UNPOSED_STANDING
from kinesic.motion.trajectory import stay
from kinesic.planning.secondary.rest_changes import MIN_REST_SPAN, make_rest_changes
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

DEFAULT_ROBOT = Robot.load()
# document without motion, of a given duration [s]
WAIT_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><wait id="w" duration="{}"/></bml>'


IDLE_SETUP = set_up(DEFAULT_ROBOT, idle=1.0)  # setup with full idle motion


def changes(duration, seed=0, standing=UNPOSED_STANDING):
    motion = stay(DEFAULT_ROBOT.skeleton.rest, duration)
    return [*make_rest_changes(motion, (0.0, duration), IDLE_SETUP, standing, np.random.default_rng(seed))]


def test_long_rest_changes_its_posture_every_10_to_20_seconds():
    found = changes(60.0)
    begins = np.array([change.begin for change in found])
    assert np.all((np.diff(begins) > 10.0) & (np.diff(begins) < 20.0))
    assert found[0].begin >= 0.3
    assert found[-1].end <= 60.0
    arms = [joint for side in SIDES for joint in DEFAULT_ROBOT.arm(side).joints]
    assert all(np.degrees(np.abs(change.away[arms]).max()) > 4.0 for change in found)
    roll = DEFAULT_ROBOT.skeleton.joint("vl5_roll")
    assert all(1.0 < abs(np.degrees(change.away[roll])) < 3.0 for change in found)


def test_20_to_80_percent_of_rest_changes_use_a_pause_posture_of_the_style():
    folding = replace(UNPOSED_STANDING, pauses=(("hands_folded_low", 1.0),))
    found = [change for seed in range(4) for change in changes(30.0, seed, folding)]
    rest, wrist = DEFAULT_ROBOT.skeleton.rest, DEFAULT_ROBOT.arm("l").wrist
    places = [DEFAULT_ROBOT.skeleton.frames(rest + change.away).origins[wrist, 1] for change in found]
    folded = [place for place in places if place < 0.3 * DEFAULT_ROBOT.arm_length]
    assert 0.2 < len(folded) / len(found) < 0.8


def test_short_rest_between_gestures_keeps_the_rest_posture():
    assert changes(MIN_REST_SPAN - 1.0) == []


def test_changes_of_the_rest_posture_are_repeatable_by_seed():
    one, same, other = (changes(20.0, seed)[0].away for seed in (3, 3, 4))
    assert np.array_equal(one, same)
    assert not np.allclose(one, other)


@pytest.mark.parametrize("robot", ["human", "upper22"])
def test_idle_robot_changes_its_rest_posture_and_returns_to_the_first(robot):
    made = plan(WAIT_TEMPLATE.format(12), set_up(robot, idle=1.0))
    body = made.setup.robot
    arms = [joint for side in SIDES for joint in body.arm(side).joints]
    offsets = np.degrees(np.abs(made.trajectory.controls - body.skeleton.rest))
    assert offsets[len(offsets) // 2, arms].max() > 3.0
    assert offsets[[0, -1]].max() < 1e-6
    assert made.clearance.distances.min() >= body.min_clearance
    exact = plan(WAIT_TEMPLATE.format(12), set_up(robot)).trajectory.controls
    assert np.abs(exact - body.skeleton.rest).max() < 1e-9
