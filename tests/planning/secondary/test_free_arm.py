"""Tests of the resting arm's motion while the other arm gestures."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.planning.secondary.arm_times import find_arm_courses
from kinesic.planning.secondary.changes import Changes
from kinesic.planning.secondary.free_arm import swing_free_arms
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

# document whose {} is replaced by behaviours
BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
# gesture of one hand at given times [s]
OFFER_TEMPLATE = '<gesture id="{id}" lexeme="offer" mode="{mode}_HAND" start="{start}" stroke="{stroke}" end="{end}"/>'


def describe(mode, at, id="g"):
    return OFFER_TEMPLATE.format(id=id, mode=mode, start=at, stroke=at + 1.0, end=at + 3.0)


@pytest.fixture(scope="module")
def exact():
    """Plan a gesture of the right hand without secondary motion."""
    return plan(BML_TEMPLATE.format(describe("RIGHT", 0.5)), set_up("human"))


def find_swings(exact, amount=1.0, **options):
    courses = tuple(find_arm_courses(exact.keyframes, exact.motion, exact.setup.robot))
    return [*swing_free_arms(courses, exact.trajectory, amount, exact.setup.robot, **options)]


def wrists(exact, trajectory, side, times):
    robot = exact.setup.robot
    return robot.skeleton.frames(trajectory.sample(times)[0]).origins[:, robot.arm(side).wrist]


def test_free_arm_swings_outward_until_the_stroke_ends_and_returns(exact):
    (swing,) = find_swings(exact)
    zero = exact.trajectory.zero
    start, end = (zero + exact.syncs[f"g:{sync}"].planned for sync in ("start", "end"))
    assert (swing.begin, swing.end) == pytest.approx((start, end), abs=0.1)
    assert swing.peak == pytest.approx(zero + exact.syncs["g:strokeEnd"].planned, abs=0.02)
    assert set(swing.hinges) <= set(exact.setup.robot.arm("l").joints)
    laid = Changes(exact.trajectory, [swing]).added(np.ones(1))
    left = wrists(exact, laid, "l", np.array([start, swing.peak, end]))
    assert 0.005 < np.linalg.norm(left[1] - left[0]) < 0.08
    assert left[1, 1] >= left[0, 1] - 1e-4
    assert left[2] == pytest.approx(left[0], abs=1e-4)


def test_free_arm_swing_is_proportional_to_the_amount_and_varies_with_the_seed(exact):
    full, half, other = (find_swings(exact, **options) for options in ({}, {"amount": 0.5}, {"seed": (3, "b")}))
    assert half[0].away == pytest.approx(0.5 * full[0].away, abs=1e-6)
    assert np.abs(other[0].away - full[0].away).max() > 0.005
    assert not find_swings(exact, amount=0.0)


def test_arm_that_the_other_hand_touches_stays_still(exact):
    middle = exact.trajectory.zero + exact.syncs["g:stroke"].planned
    assert not find_swings(exact, touched={"l": [middle]})
    assert find_swings(exact, touched={"r": [middle], "l": [middle + 20.0]})


def test_arms_that_both_perform_gestures_do_not_swing():
    both = plan(BML_TEMPLATE.format(describe("RIGHT", 0.5) + describe("LEFT", 1.0, "h")), set_up("human"))
    assert not find_swings(both)


def test_free_arm_swings_visibly_in_a_plan_only_with_idle_motion(exact):
    text, setup = BML_TEMPLATE.format(describe("RIGHT", 0.5)), exact.setup
    paths = []
    for amount in (0.0, 1.0):
        made = plan(text, replace(setup, idling=replace(setup.idling, amount=amount)))
        times = np.linspace(made.trajectory.zero + 0.5, made.trajectory.zero + 3.5, 60)
        chest = made.trajectory.sample(times)[0]
        joints = list(setup.robot.arm("l").joints)
        paths.append(np.degrees(np.ptp(chest[:, joints], axis=0)).max())
    assert paths[0] < 0.5 < 1.5 < paths[1]
