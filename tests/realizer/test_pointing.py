"""Hands that point, on a trunk that others move."""

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.motion.trajectory import Trajectory
from kinesic.motion.transition import knot_at, lengthen
from kinesic.planning.quick_plan import plan_quickly
from kinesic.realizer.occupancy import occupancy_of
from kinesic.realizer.pointing import correct_pointing, pointing_hands

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
POINT = '<pointing id="p" target="user" mode="RIGHT_HAND" stroke="1.4"/>'
TURN = np.radians(8.0)  # of the trunk


@pytest.fixture(scope="module")
def alone(known):
    return plan_quickly(parse(ROOT.format(POINT + '<gesture id="g" lexeme="BEAT" mode="LEFT_HAND"/>')), known)


@pytest.fixture(scope="module")
def stroke(alone):
    planned = {(sync.behaviour, sync.sync): sync.planned for sync in alone.syncs}
    return planned["p", "stroke"] + alone.trajectory.zero


@pytest.fixture(scope="module")
def leaning(alone, known):
    """The motion on a trunk that stands turned."""
    controls = np.array(alone.trajectory.controls)
    controls[:, known.robot.joints("torso")[0]] += TURN
    return Trajectory(controls, alone.trajectory.zero)


def posture(motion, time):
    return motion.sample(np.array([time]))[0][0]


def test_only_hands_that_point_are_found(alone):
    (one,) = pointing_hands(alone)
    assert (one.behaviour, one.side) == ("p", "r")


def test_a_hand_meets_its_target_by_its_own_plan(alone, stroke, known):
    (one,) = pointing_hands(alone)
    assert one.miss(posture(alone.trajectory, stroke), known.robot) < np.radians(0.5)


def test_a_turned_trunk_makes_it_miss_and_the_arm_mends_it(leaning, alone, stroke, known):
    (one,) = pointing_hands(alone)
    off = posture(leaning, stroke)
    assert one.miss(off, known.robot) > np.radians(3.0)
    mended = one.arm(off, known.robot)
    assert one.miss(mended, known.robot) < np.radians(0.5)
    others = np.setdiff1d(np.arange(len(off)), known.robot.joints("r_arm"))
    np.testing.assert_array_equal(mended[others], off[others])


def test_a_corrected_motion_differs_only_in_the_arm_and_only_while_it_points(leaning, alone, stroke, known):
    (one,), needs = pointing_hands(alone), {each.behaviour: each for each in occupancy_of(alone)}
    cut = stroke - 0.4
    found = correct_pointing(leaning, cut, one, stroke, needs["p"], [needs["g"]], known)
    assert found is not None
    assert one.miss(posture(found, stroke), known.robot) < np.radians(0.5)
    count = max(len(found.controls), len(leaning.controls))
    change = np.abs(lengthen(found.controls, count) - lengthen(leaning.controls, count))
    assert set(np.flatnonzero(change.max(axis=0) > 1e-9)) <= set(known.robot.joints("r_arm"))
    assert change[: knot_at(cut) + 3].max() < 1e-9
    assert change[-3:].max() < 1e-9


def test_no_motion_is_corrected_that_may_not_change_in_time(leaning, alone, stroke, known):
    (one,), needs = pointing_hands(alone), {each.behaviour: each for each in occupancy_of(alone)}
    assert correct_pointing(leaning, needs["p"].end + 1.0, one, stroke, needs["p"], [], known) is None
