"""Tests of nod stroke times and of overshoot of close gestures."""

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.planning.plan import plan_block
from kinesic.planning.syncs import SHIFT_TO_WARN

# document whose {} is replaced by behaviours
BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
NOD_BEHAVIOURS = (  # speech with two marks, and a nod with given attributes
    '<speech id="s" start="1"><text>Yes, <sync id="m"/>indeed it is so, <sync id="n"/>always.</text></speech>'
    '<head id="h" lexeme="NOD" amount="0.8" {}/>'
)
# lexemes of ten successive gestures
GESTURE_LEXEMES = ("beat", "offer", "large", "beat_edge", "oath", "me", "up", "beat", "take_out", "cut_off")


@pytest.fixture
def planned(known):
    return lambda text: plan_block(parse(BML_TEMPLATE.format(text)), known)


def down_strokes(plan):
    """Return the block times [s] of the lowest head positions."""
    times = np.arange(0.0, plan.trajectory.duration, 0.005)
    robot = plan.setup.robot
    head = robot.skeleton.segment(robot.chains["neck"][-1])
    depth = -robot.skeleton.frames(plan.trajectory.sample(times)[0]).rotations[:, head, 2, 0]  # sine of the pitch
    lowest = np.flatnonzero((depth[1:-1] > depth[:-2]) & (depth[1:-1] >= depth[2:]) & (depth[1:-1] > 0.1)) + 1
    return times[lowest] - plan.trajectory.zero


def crowd(gap):
    """Write ten strokes of one hand at a given interval [s]."""
    return "".join(
        f'<gesture id="g{k}" lexeme="{lexeme}" mode="RIGHT_HAND" stroke="{1.5 + gap * k:.2f}"/>'
        for k, lexeme in enumerate(GESTURE_LEXEMES)
    )


def test_nod_is_lowest_at_the_word_of_its_stroke(planned):
    plan = planned(NOD_BEHAVIOURS.format('stroke="s:m"'))
    assert down_strokes(plan) == pytest.approx([plan.syncs["s:m"].planned], abs=0.02)
    assert plan.syncs["h:strokeEnd"].planned > plan.syncs["s:m"].planned  # it comes up after the word


def test_two_nods_are_lowest_at_the_words_of_their_strokes(planned):
    tie = '<constraint><synchronize><sync ref="s:n"/><sync ref="h:stroke:2"/></synchronize></constraint>'
    plan = planned(NOD_BEHAVIOURS.format('repetition="2" stroke="s:m"') + tie)
    assert down_strokes(plan) == pytest.approx([plan.syncs[f"s:{mark}"].planned for mark in "mn"], abs=0.06)


def test_gestures_close_in_time_lose_overshoot_but_no_stroke(planned):
    roomy, near = planned(crowd(2.0)), planned(crowd(0.75))
    for plan in (roomy, near):
        assert {outcome.kind for outcome in plan.keyframes.outcomes.values()} <= {"realised", "partly"}
        late = {sync.name: sync.planned - sync.requested for sync in plan.syncs if sync.sync == "stroke"}
        assert len(late) == len(GESTURE_LEXEMES)
        assert max(map(abs, late.values())) <= SHIFT_TO_WARN, late
    assert swinging(near) < 0.5 * swinging(roomy)


def swinging(plan):
    """Return the fraction of hinges that overshoot their keys."""
    return sum(passage.swing > 0.0 for posture in plan.postures.postures for passage in posture.passages)
