"""Tests of plans in standing postures that obstruct gestures."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.planning import standing_plan
from kinesic.planning.standing import standing_robot, vary_standing
from kinesic.planning.standing_plan import plan_standing_block
from kinesic.session.documents import read_block
from kinesic.session.setup import set_up

# document with one gesture of a given lexeme
GESTURE_DOCUMENT = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
  <gesture id="g" lexeme="{}" start="0.5"/>
</bml>"""


@pytest.fixture(scope="module")
def with_raised_hand():
    """Return a setup whose standing posture has a hand before the body."""
    return set_up(robot="upper22", variation=1.0, seed=5)


def plan_gesture(setup, lexeme):
    return plan_standing_block(read_block(GESTURE_DOCUMENT.format(lexeme), setup, source="test"), setup)


def refuse_raised_hands(monkeypatch, setup):
    """Drop the gesture of all plans that start from a given posture."""
    plan_block = standing_plan.plan_block

    def plan(block, posture, **options):
        is_raised = np.array_equal(posture.robot.skeleton.rest, setup.robot.skeleton.rest)
        return plan_block(block, posture, without={"g": "it meets the raised hand"} if is_raised else {}, **options)

    monkeypatch.setattr(standing_plan, "plan_block", plan)


def test_gesture_blocked_by_a_raised_hand_is_performed_from_hanging_arms(with_raised_hand, monkeypatch):
    setup = with_raised_hand
    refuse_raised_hands(monkeypatch, setup)
    plan = plan_gesture(setup, "wave")
    hanging = vary_standing(setup.unstyled, setup.style, setup.variation, setup.distances, hands_hang=True)
    assert plan.keyframes.outcomes["g"].kind == "realised"
    assert not np.array_equal(setup.robot.skeleton.rest, hanging.skeleton.rest)
    assert np.array_equal(plan.setup.robot.skeleton.rest, hanging.skeleton.rest)


def test_standing_posture_with_a_raised_hand_is_kept_if_all_gestures_are_performed(with_raised_hand):
    assert plan_gesture(with_raised_hand, "wave").setup is with_raised_hand


def test_standing_posture_with_a_raised_hand_is_kept_if_no_other_performs_more(with_raised_hand):
    plan = plan_gesture(with_raised_hand, "no_such_gesture_at_all")
    assert plan.keyframes.outcomes["g"].kind == "dropped"
    assert plan.setup is with_raised_hand


def test_blocked_gesture_stays_dropped_if_the_setup_has_a_fixed_posture(with_raised_hand, monkeypatch):
    refuse_raised_hands(monkeypatch, with_raised_hand)
    plan = plan_gesture(replace(with_raised_hand, unstyled=None), "wave")
    assert plan.keyframes.outcomes["g"].kind == "dropped"


def test_gesture_that_an_uneven_stance_prevents_is_performed_from_an_even_one(monkeypatch):
    setup = set_up(robot="human", variation=1.0, seed=0)
    even = standing_robot(setup.unstyled, setup.style, setup.lexicon, setup.distances)
    plan_block = standing_plan.plan_block

    def plan_even_only(block, posture, **options):
        is_even = np.array_equal(posture.robot.skeleton.rest, even.skeleton.rest)
        return plan_block(block, posture, without={} if is_even else {"g": "the stance is uneven"}, **options)

    monkeypatch.setattr(standing_plan, "plan_block", plan_even_only)
    plan = plan_gesture(setup, "plead")
    assert plan.keyframes.outcomes["g"].kind != "dropped"
    assert not np.array_equal(setup.robot.skeleton.rest, even.skeleton.rest)
    assert np.array_equal(plan.setup.robot.skeleton.rest, even.skeleton.rest)


def test_gesture_that_every_stance_of_a_style_prevents_is_performed_upright(monkeypatch):
    setup = set_up(robot="upper22", style="proud", variation=1.0, seed=1)
    own, plan_block = setup.unstyled.skeleton.rest, standing_plan.plan_block

    def refuse_stances(block, posture, **options):
        is_upright = np.array_equal(posture.robot.skeleton.rest, own)
        return plan_block(block, posture, without={} if is_upright else {"g": "the hip is in the way"}, **options)

    monkeypatch.setattr(standing_plan, "plan_block", refuse_stances)
    plan = plan_gesture(setup, "wave")
    assert plan.keyframes.outcomes["g"].kind == "realised"
    assert plan.setup.style is setup.style
    assert np.array_equal(plan.setup.robot.skeleton.rest, own)
