"""Tests of plans of blocks without some of their behaviours."""

import pickle

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.planning.plan import plan_block
from kinesic.planning.quick_plan import plan_quickly, rest_at_keys
from kinesic.planning.reduced_plan import plan_without

# document whose {} is replaced by behaviours
BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
NOD_ELEMENT = '<head id="n" lexeme="NOD" start="1" end="3"/>'  # nod from 1 to 3 s
GAZE_ELEMENT = '<gaze id="z" target="left" start="0" ready="1" relax="3" end="4"/>'  # gaze from 0 to 4 s
SPEECH_ELEMENT = '<speech id="s"><text>One <sync id="m"/>two three.</text></speech>'  # speech with one mark
# simultaneous gestures of both hands
TWO_GESTURES = "".join(f'<gesture id="{id}" lexeme="large" mode="BOTH_HANDS" stroke="2"/>' for id in "ab")


@pytest.fixture
def planned(known):
    return lambda inside, plan=plan_quickly: plan(parse(BML_TEMPLATE.format(inside)), known)


def moved(plan) -> set[str]:
    return {behaviour for behaviour, parts in plan.keyframes.uses.items() if parts}


def test_plan_reduced_by_no_behaviours_is_the_plan_itself(planned):
    plan = planned(NOD_ELEMENT)
    assert plan_without(plan, ()) is plan


@pytest.mark.parametrize("planner", [plan_quickly, plan_block])
def test_remaining_behaviours_of_a_reduced_plan_move_as_if_planned_alone(planned, planner):
    reduced, alone = plan_without(planned(GAZE_ELEMENT + NOD_ELEMENT, planner), ["z"]), planned(NOD_ELEMENT, planner)
    assert moved(reduced) == {"n"}
    assert reduced.conditioned is alone.conditioned
    times = np.linspace(0.0, 4.0, 50)
    result, expected = (plan.trajectory.sample(times + plan.trajectory.zero)[0] for plan in (reduced, alone))
    np.testing.assert_allclose(result, expected, atol=1e-6)


def test_required_behaviour_can_be_removed_from_a_plan(planned):
    reduced = plan_without(planned(f"<required>{GAZE_ELEMENT}{NOD_ELEMENT}</required>"), {"z"})
    assert moved(reduced) == {"n"}
    assert "another block" in reduced.keyframes.outcomes["z"].why


def test_behaviour_dropped_for_a_busy_hand_stays_dropped_in_a_reduced_plan(planned):
    plan = planned(TWO_GESTURES + NOD_ELEMENT)
    (kept,) = moved(plan) - {"n"}
    (dropped,) = {"a", "b"} - {kept}
    reduced = plan_without(plan, {kept})
    assert moved(reduced) == {"n"}
    assert reduced.keyframes.outcomes[dropped].why == plan.keyframes.outcomes[dropped].why


def test_reduced_plan_keeps_the_speech_of_the_block(planned):
    plan = planned(SPEECH_ELEMENT + '<head id="n" lexeme="NOD" stroke="s:m"/>' + GAZE_ELEMENT)
    reduced = plan_without(plan, {"z"})
    assert reduced.utterances is plan.utterances
    assert reduced.timeline.block.behaviours[0].id == "s"


def test_plan_reduced_by_the_same_behaviours_comes_from_the_cache(planned):
    plan = planned(GAZE_ELEMENT + NOD_ELEMENT)
    assert plan_without(plan, ["z"]) is plan_without(plan, {"z"})
    assert plan_without(plan, ["n"]) is not plan_without(plan, ["z"])


def test_pickled_conditioner_of_a_plan_is_restored_as_the_same_function(planned):
    """Pickle a plan, as the background replanner does."""
    restored = pickle.loads(pickle.dumps(planned(NOD_ELEMENT).conditioned))
    assert restored is rest_at_keys
