"""Planner with a stub loop in simulated time: documents, stops and idling."""

import json
import re
from collections.abc import Callable

import numpy as np
import pytest

from kinesic.motion.trajectory import stay
from kinesic.planning.setup import Setup
from kinesic.realizer.scene import Scene
from kinesic.serve.idling import IDLE_SPELL_DURATION, REST_BEFORE_IDLING
from kinesic.serve.messages import (
    FeedbackNotice,
    Halted,
    Interruption,
    ProposalVerdict,
    Resumption,
)
from kinesic.serve.planner import MIN_POLL_PERIOD
from kinesic.serve.shared_scene import MAX_EXPECTED_DURATION, PROPOSAL_MARGIN

from .planning_bench import LONG_GESTURE_BML, NOD_BML, Planning
from .simulated import feedback_of


def test_prediction_of_a_document_is_sent_before_its_motion_and_feedback_are_proposed(planning: Planning):
    planning.document("b", NOD_BML)
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


def test_overlong_document_is_refused_with_its_duration(planning: Planning):
    planning.document("b", '<wait id="w" duration="20"/>')
    proposals, notices = planning.said()
    assert len(proposals) == 1
    planning.document("c", '<wait id="w" duration="20.6"/>')
    proposals, notices = planning.said()
    assert not proposals
    (notice,) = notices
    assert "rule duration: c lasts 21 s, at most 20 s are taken" in notice.message
    assert notice.sender == 7


def test_planner_refuses_an_invalid_document(planning: Planning):
    planning.document("b", "<head")
    proposals, (notice,) = planning.said()
    assert not proposals
    assert "PARSING_FAILURE" in notice.message


@pytest.mark.parametrize("stops", [0, 2])
def test_document_is_refused_only_if_sent_before_the_last_emergency_stop(planning: Planning, stops: int):
    motion = stay(planning.setup.robot.skeleton.rest, start=0.0)
    planning.state.handle_stop(Halted(1, 0.1, motion))
    planning.said()
    if stops > 1:
        planning.loop.answers.append(Halted(2, 0.2, motion))
    planning.document("b", NOD_BML, stops=stops)
    proposals, notices = planning.said()
    if stops > 1:
        assert proposals[-1].motion is not None, "it waited for the stop, and was planned after it"
        assert proposals[-1].stops == 2
        return
    assert all(each.motion is None for each in proposals)
    assert "rule stopped: an emergency stop came; resume first" in notices[-1].message
    assert 'id="b"' in notices[-1].message


def test_resume_applies_to_the_last_stop_and_proposes_a_motion(planning: Planning):
    rest = planning.setup.robot.skeleton.rest
    bent = planning.setup.robot.skeleton.clamp(rest + 0.2)
    planning.state.handle_stop(Halted(1, 0.1, stay(bent, start=0.0)))
    planning.state.handle_stop(Halted(2, 0.1, stay(bent, start=0.0)))
    planning.said()
    planning.state.execute(Resumption(1))
    assert planning.said() == ([], [])
    planning.state.execute(Resumption(2))
    (proposal,), _ = planning.said()
    assert proposal.motion is not None
    assert np.allclose(proposal.motion.controls[-1], rest)
    assert np.allclose(proposal.motion.at(0.0).angles, bent)


def test_resume_at_rest_proposes_a_motion(planning: Planning):
    """The loop stays stopped until it accepts a new motion."""
    planning.state.execute(Resumption(0))
    (proposal,), _ = planning.said()
    assert proposal.motion is not None


def test_emergency_stop_interrupts_the_playing_block_without_proposing_a_motion(planning: Planning):
    planning.document("b", LONG_GESTURE_BML)
    planning.said()
    halted = stay(planning.setup.robot.skeleton.rest, start=0.5)
    planning.state.handle_stop(Halted(1, 0.5, halted))
    (proposal,), _ = planning.said()
    assert proposal.motion is None
    assert proposal.stops == 1
    assert any("INTERRUPTED" in each.xml for each in feedback_of(proposal))
    planning.time = 3.0
    planning.state.advance_scene()
    (proposal,), _ = planning.said()
    assert proposal.owed == frozenset()


def test_blocks_end_at_the_first_of_two_emergency_stops_reported_together(planning: Planning):
    """The loop has already ended the blocks at the first stop."""
    planning.document("b", LONG_GESTURE_BML)
    planning.said()
    first, second = 3.2, 3.7  # [s] before and after `ready`
    for stops, time in ((1, first), (2, second)):
        planning.loop.answers.append(Halted(stops, time, stay(planning.setup.robot.skeleton.rest, start=time)))
    planning.loop.rule = lambda proposal: ProposalVerdict(accepted=proposal.stops == 2, stops=2, time=second)
    planning.time = 3.0
    planning.state.execute(Interruption("another"))
    proposals, _ = planning.said()
    assert proposals[-1].stops == 2
    messages = feedback_of(proposals[-1])
    assert max(each.time for each in messages) <= first
    assert [each.time for each in messages if 'id="b:end"' in each.xml] == [pytest.approx(first)]


def test_interruption_of_one_block_leaves_another_block_running(planning: Planning):
    planning.document("a", LONG_GESTURE_BML, sender=1)
    planning.document("b", NOD_BML.replace('start="0"', 'start="3"'), sender=2)
    planning.said()
    planning.time = 1.0
    planning.state.execute(Interruption("a"))
    (proposal,), _ = planning.said()
    ends = [each.xml for each in feedback_of(proposal) if 'id="a:end"' in each.xml]
    assert any("INTERRUPTED" in end for end in ends)
    assert not any("INTERRUPTED" in each.xml and 'id="b' in each.xml for each in feedback_of(proposal))


def test_heard_text_of_a_yielding_block_is_sent_once_to_its_sender_and_to_the_interrupting_client(planning: Planning):
    speech = '<speech id="s"><text>one two three four five six</text></speech>'
    planning.document("a", speech + LONG_GESTURE_BML, sender=1)
    planning.document("n", NOD_BML, sender=2)
    planning.said()
    planning.time = 1.3
    planning.state.execute(Interruption(None, yields=True, silenced=1.3, sender=2))
    (proposal,), notices = planning.said()
    told = [(json.loads(notice.message), notice.sender) for notice in notices if "yielded" in notice.message]
    assert {(answer["block"], sender) for answer, sender in told} == {("a", 1), ("a", 2), ("n", 2)}
    assert len(told) == 3
    heard = next(answer for answer, _ in told if answer["block"] == "a")
    assert heard["said"].startswith("one two")
    assert f"{heard['said']} {heard['unsaid']}" == "one two three four five six"
    assert sum("INTERRUPTED" in each.xml for each in feedback_of(proposal) if 'id="a:end"' in each.xml) == 1


def test_interruption_without_yielding_reports_no_heard_text(planning: Planning):
    planning.document("a", NOD_BML)
    planning.state.execute(Interruption(None))
    assert not any("yielded" in notice.message for notice in planning.said()[1])


def test_planning_time_expected_by_the_planner_decays_after_one_slow_plan(planning: Planning):
    shared = planning.state._shared
    leads: list[float] = []
    for seconds in (0.5, 0.0, 0.0, 0.0, 9.0, 0.0):

        def change(scene: Scene, now: float, seconds: float = seconds) -> Scene:
            leads.append(scene.ahead - PROPOSAL_MARGIN)
            planning.time += seconds
            return scene

        shared.propose(change)
    assert leads == pytest.approx([0.0, 0.5, 0.35, 0.245, 0.1715, MAX_EXPECTED_DURATION])


def test_planner_has_no_due_event_at_rest(planning: Planning):
    assert planning.state.pause is None


def test_next_due_event_of_the_planner_is_the_block_end(planning: Planning):
    planning.document("b", NOD_BML)
    (proposal,), _ = planning.said()
    pause = planning.state.pause
    assert pause is not None
    assert MIN_POLL_PERIOD <= pause <= proposal.motion.end + 1.0
    planning.time = 100.0
    assert planning.state.pause == MIN_POLL_PERIOD, "what is due is looked at soon"
    planning.state.advance_scene()
    (proposal,), _ = planning.said()
    assert proposal.owed == frozenset()
    assert planning.state.pause is None


def test_idling_begins_after_a_fixed_rest_at_the_end_of_a_document(
    make_planning: Callable[..., Planning], lively: Setup
):
    planning = make_planning(lively)
    assert planning.state.pause is None
    planning.document("b", NOD_BML)
    (proposal,), _ = planning.said()
    end = proposal.motion.end
    while not proposal.idles:
        assert planning.state.pause is not None
        planning.time += planning.state.pause
        planning.state.advance_scene()
        (proposal,), _ = planning.said()
    assert planning.time == pytest.approx(end + REST_BEFORE_IDLING, abs=2 * MIN_POLL_PERIOD)
    assert proposal.motion.end > planning.time + IDLE_SPELL_DURATION / 2


def test_no_idle_motion_begins_after_all_blocks_are_interrupted(make_planning: Callable[..., Planning], lively: Setup):
    planning = make_planning(lively)
    planning.document("b", NOD_BML)
    planning.state.execute(Interruption(None))
    planning.time = 50.0
    planning.state.advance_scene()
    assert planning.state.pause is None
    assert not planning.said()[0][-1].idles


def test_idle_motion_begins_after_a_single_block_is_interrupted(make_planning: Callable[..., Planning], lively: Setup):
    planning = make_planning(lively)
    planning.document("b", NOD_BML)
    planning.state.execute(Interruption("b"))
    planning.time = 50.0
    planning.state.advance_scene()
    planning.state.advance_scene()
    assert planning.said()[0][-1].idles


def test_rejected_idle_motion_is_postponed(make_planning: Callable[..., Planning], lively: Setup):
    planning = make_planning(lively)
    planning.document("b", NOD_BML)
    planning.time = 50.0
    planning.state.advance_scene()
    planning.said()
    planning.loop.rule = lambda proposal: ProposalVerdict(proposal.motion is None, 0, 0.0)
    planning.state.advance_scene()
    assert planning.state.pause is not None
    assert planning.state.pause > 1.0
