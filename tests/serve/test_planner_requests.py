"""A planner at a loop that answers by a rule, in simulated time: documents, stops and idle motion."""

import re
from collections.abc import Callable

import numpy as np
import pytest

from kinesic.motion.trajectory import stay
from kinesic.planning.setup import Setup
from kinesic.serve.idling import PAUSE, SPELL
from kinesic.serve.messages import (
    FeedbackNotice,
    Halted,
    Interruption,
    ProposalVerdict,
    Resumption,
)
from kinesic.serve.planner import LOOK

from .planning_bench import LONG, NOD, Planning
from .simulated import feedback_of


def test_a_document_is_predicted_and_then_proposed_with_its_feedback(planning: Planning):
    planning.document("b", NOD)
    first, *others = planning.loop.sent
    assert isinstance(first, FeedbackNotice)
    assert first.sender == 7
    assert "predictionFeedback" in first.message
    (proposal,) = others
    assert proposal.motion is not None
    assert proposal.cut > proposal.now
    assert proposal.owed == {7}
    assert not proposal.idles
    assert proposal.stops == 0
    assert {block for block, _ in proposal.moving} == {"b"}
    passed = re.findall('<blockProgress[^>]* id="(b:[a-z]*)"', "".join(each.xml for each in feedback_of(proposal)))
    assert passed == ["b:start", "b:relax", "b:end"]


def test_a_document_that_lasts_too_long_is_refused_with_its_duration(planning: Planning):
    planning.document("b", '<wait id="w" duration="19.5"/>')
    proposals, notices = planning.said()
    assert len(proposals) == 1
    planning.document("c", '<wait id="w" duration="20.6"/>')
    proposals, notices = planning.said()
    assert not proposals
    (notice,) = notices
    assert "rule duration: c lasts 21 s, at most 20 s are taken" in notice.message
    assert notice.sender == 7


def test_what_is_no_document_is_refused(planning: Planning):
    planning.document("b", "<head")
    proposals, (notice,) = planning.said()
    assert not proposals
    assert "PARSING_FAILURE" in notice.message


@pytest.mark.parametrize("stops", [0, 2])
def test_a_document_of_before_a_stop_is_refused_however_good_it_is(planning: Planning, stops: int):
    motion = stay(planning.setup.robot.skeleton.rest, start=0.0)
    planning.state.take_halt(Halted(1, 0.1, motion))
    planning.said()
    if stops > 1:
        planning.loop.answers.append(Halted(2, 0.2, motion))
    planning.document("b", NOD, stops=stops)
    proposals, notices = planning.said()
    if stops > 1:
        assert proposals[-1].motion is not None, "it waited for the stop, and was planned after it"
        assert proposals[-1].stops == 2
        return
    assert all(each.motion is None for each in proposals)
    assert "rule stopped: an emergency stop came; resume first" in notices[-1].message
    assert 'id="b"' in notices[-1].message


def test_resuming_is_for_the_last_stop_only_and_comes_with_a_motion(planning: Planning):
    rest = planning.setup.robot.skeleton.rest
    bent = planning.setup.robot.skeleton.clamp(rest + 0.2)
    planning.state.take_halt(Halted(1, 0.1, stay(bent, start=0.0)))
    planning.state.take_halt(Halted(2, 0.1, stay(bent, start=0.0)))
    planning.said()
    planning.state.fulfil(Resumption(1))
    assert planning.said() == ([], [])
    planning.state.fulfil(Resumption(2))
    (proposal,), _ = planning.said()
    assert proposal.motion is not None
    assert np.allclose(proposal.motion.controls[-1], rest)
    assert np.allclose(proposal.motion.at(0.0).angles, bent)


def test_a_robot_at_rest_resumes_with_a_motion_too(planning: Planning):
    """Its coming ends the stop at the loop."""
    planning.state.fulfil(Resumption(0))
    (proposal,), _ = planning.said()
    assert proposal.motion is not None


def test_a_stop_interrupts_all_and_leaves_the_motion_to_the_loop(planning: Planning):
    planning.document("b", LONG)
    planning.said()
    halted = stay(planning.setup.robot.skeleton.rest, start=0.5)
    planning.state.take_halt(Halted(1, 0.5, halted))
    (proposal,), _ = planning.said()
    assert proposal.motion is None
    assert proposal.stops == 1
    assert any("INTERRUPTED" in each.xml for each in feedback_of(proposal))
    planning.time = 3.0
    planning.state.go_on()
    (proposal,), _ = planning.said()
    assert proposal.owed == frozenset()


def test_one_block_is_interrupted_and_the_other_goes_on(planning: Planning):
    planning.document("a", LONG, sender=1)
    planning.document("b", NOD.replace('start="0"', 'start="3"'), sender=2)
    planning.said()
    planning.time = 1.0
    planning.state.fulfil(Interruption("a"))
    (proposal,), _ = planning.said()
    ends = [each.xml for each in feedback_of(proposal) if 'id="a:end"' in each.xml]
    assert any("INTERRUPTED" in end for end in ends)
    assert not any("INTERRUPTED" in each.xml and 'id="b' in each.xml for each in feedback_of(proposal))


def test_nothing_is_due_on_a_robot_at_rest(planning: Planning):
    assert planning.state.pause is None


def test_the_next_look_is_when_a_block_is_over(planning: Planning):
    planning.document("b", NOD)
    (proposal,), _ = planning.said()
    pause = planning.state.pause
    assert pause is not None
    assert LOOK <= pause <= proposal.motion.end + 1.0
    planning.time = 100.0
    assert planning.state.pause == LOOK, "what is due is looked at soon"
    planning.state.go_on()
    (proposal,), _ = planning.said()
    assert proposal.owed == frozenset()
    assert planning.state.pause is None


def test_it_idles_some_time_after_a_document_and_not_before(make_planning: Callable[..., Planning], lively: Setup):
    planning = make_planning(lively)
    assert planning.state.pause is None
    planning.document("b", NOD)
    (proposal,), _ = planning.said()
    end = proposal.motion.end
    while not proposal.idles:
        assert planning.state.pause is not None
        planning.time += planning.state.pause
        planning.state.go_on()
        (proposal,), _ = planning.said()
    assert planning.time == pytest.approx(end + PAUSE, abs=2 * LOOK)
    assert proposal.motion.end > planning.time + SPELL / 2


def test_nobody_idles_after_everything_was_interrupted(make_planning: Callable[..., Planning], lively: Setup):
    planning = make_planning(lively)
    planning.document("b", NOD)
    planning.state.fulfil(Interruption(None))
    planning.time = 50.0
    planning.state.go_on()
    assert planning.state.pause is None
    assert not planning.said()[0][-1].idles


def test_idling_goes_on_after_one_block_was_interrupted(make_planning: Callable[..., Planning], lively: Setup):
    planning = make_planning(lively)
    planning.document("b", NOD)
    planning.state.fulfil(Interruption("b"))
    planning.time = 50.0
    planning.state.go_on()
    planning.state.go_on()
    assert planning.said()[0][-1].idles


def test_a_spell_that_is_refused_is_put_off(make_planning: Callable[..., Planning], lively: Setup):
    planning = make_planning(lively)
    planning.document("b", NOD)
    planning.time = 50.0
    planning.state.go_on()
    planning.said()
    planning.loop.rule = lambda proposal: ProposalVerdict(proposal.motion is None, 0, 0.0)
    planning.state.go_on()
    if planning.state.pause is not None:
        assert planning.state.pause > 1.0
