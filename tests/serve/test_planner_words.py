"""Planner with a stub loop in simulated time: words, styles and verdicts."""

import json
import re
from collections.abc import Callable

import numpy as np
import pytest

from kinesic.motion.trajectory import stay
from kinesic.serve.messages import (
    DocumentRequest,
    FeedbackNotice,
    Halted,
    Interruption,
    Proposal,
    ProposalVerdict,
    Restyling,
    Words,
)
from kinesic.serve.talks import Phrase
from kinesic.serve.tracks import SoundAndFace

from .planning_bench import BLOCK_BML, LONG_GESTURE_BML, NOD_BML, Line, Planning


def test_unknown_style_is_refused_and_a_valid_style_applies_to_future_blocks(planning: Planning):
    planning.state.execute(Restyling("gloomy", (), None, None, 3))
    proposals, (notice,) = planning.said()
    assert not proposals
    assert notice.sender == 3
    data = json.loads(notice.message)
    assert (data["told"], data["do"]) == ("refused", "style")
    assert "gloomy" in data["why"]
    planning.state.execute(Restyling("calm", ("power=-0.5",), None, None, 3))
    assert planning.said()[1] == []
    planning.document("b", LONG_GESTURE_BML)
    (calm,), _ = planning.said()
    other = Planning(planning.setup)
    other.document("b", LONG_GESTURE_BML)
    (usual,), _ = other.said()
    shared = min(len(calm.motion.controls), len(usual.motion.controls))
    assert not np.allclose(calm.motion.controls[:shared], usual.motion.controls[:shared], atol=1e-3)


@pytest.mark.parametrize("changes", [("power=9",), ("powr=0.5",), ("power",)])
def test_invalid_style_changes_are_refused(planning: Planning, changes: tuple[str, ...]):
    planning.state.execute(Restyling(None, changes, None, None, 3))
    proposals, (notice,) = planning.said()
    assert not proposals
    assert json.loads(notice.message)["told"] == "refused"


def test_parameter_changes_without_a_style_apply_to_the_current_style(planning: Planning):
    planning.state.execute(Restyling("calm", (), None, None, 3))
    planning.state.execute(Restyling(None, ("power=0.5",), None, None, 3))
    planning.document("b", LONG_GESTURE_BML)
    both = planning.said()[0][-1].motion.controls
    other = Planning(planning.setup)
    other.state.execute(Restyling(None, ("power=0.5",), None, None, 3))
    other.document("b", LONG_GESTURE_BML)
    alone = other.said()[0][-1].motion.controls
    shared = min(len(both), len(alone))
    assert not np.allclose(both[:shared], alone[:shared], atol=1e-3)


def saying(notices: list[FeedbackNotice]) -> list[dict]:
    return [json.loads(notice.message) for notice in notices if notice.message.startswith("{")]


def test_streamed_words_are_planned_phrase_by_phrase_and_reported_to_their_client(planning: Planning):
    planning.state.execute(DocumentRequest(Words("Hello there. And", 7), 0))
    proposals, _ = planning.said()
    assert proposals[-1].owed == {7}, "its client is owed the rest"
    planning.state.plan_phrases()
    proposals, notices = planning.said()
    (result,) = saying(notices)
    assert (result["told"], result["text"], result["block"]) == ("saying", "Hello there.", "said7-1")
    assert len(proposals) == 1, "nothing of an earlier phrase is replaced"
    assert {block for block, _ in proposals[-1].moving} <= {"said7-1"}
    assert {notice.sender for notice in notices} == {7}
    planning.state.plan_phrases()
    assert saying(planning.said()[1]) == [], "the rest is awaited"
    assert planning.state.pause is not None
    planning.state.execute(DocumentRequest(Words(" so on.", 7, ends=True), 0))
    planning.time = 100.0
    planning.state.advance_scene()
    planning.state.plan_phrases()
    result = saying(planning.said()[1])
    assert [item["told"] for item in result] == ["saying", "all_said"]
    assert result[0]["text"] == "And so on."
    assert result[1]["block"] == result[0]["block"] == "said7-2"


def test_streamed_phrase_removes_behaviours_that_it_replaces_in_the_preceding_block(
    planning: Planning, monkeypatch: pytest.MonkeyPatch
):
    planning.document("a", '<head id="n" lexeme="NOD" start="4"/>')
    phrases = iter([Phrase(7, "b", BLOCK_BML.format("b", NOD_BML), "Yes.", frozenset({"n"}), before="a"), None])
    monkeypatch.setattr(planning.state._talks, "next_phrase", lambda scene, now: next(phrases))
    planning.state.plan_phrases()
    assert [block for block, _ in planning.said()[0][-1].moving] == ["b"]


def test_streamed_phrase_waits_for_the_running_speech_of_another_client(planning: Planning):
    text = "One two three four five six seven eight nine ten. "
    planning.state.execute(DocumentRequest(Words(text, 1, ends=True), 0))
    planning.state.execute(DocumentRequest(Words("Here I am.", 2, ends=True), 0))
    planning.state.plan_phrases()
    first = saying(planning.said()[1])
    assert {item["block"][:5] for item in first} == {"said1"}
    planning.time = 100.0
    planning.state.advance_scene()
    planning.state.plan_phrases()
    assert "said2-1" in [item.get("block") for item in saying(planning.said()[1])]


@pytest.mark.parametrize("request_", [Interruption(None), "stop"])
def test_unspoken_words_are_dropped_at_a_stop_or_interruption(planning: Planning, request_: Interruption | str):
    planning.state.execute(DocumentRequest(Words("Hello there. And so on.", 7), 0))
    if request_ == "stop":
        planning.state.handle_stop(Halted(1, 0.0, stay(planning.setup.robot.skeleton.rest)))
    else:
        planning.state.execute(request_)
    assert planning.said()[0][-1].owed == frozenset()
    planning.state.plan_phrases()
    assert planning.said() == ([], [])


def test_planner_refuses_words_if_too_many_characters_of_a_client_wait(planning: Planning):
    planning.state.execute(DocumentRequest(Words("x " * 600_000, 7), 0))
    notices = planning.said()[1]
    assert re.search("rule waiting: .* characters already wait", notices[0].message)
    assert notices[0].sender == 7


def test_planner_proposes_a_face_track_once_and_only_with_a_face_output(make_planning: Callable[..., Planning]):
    smile = '<faceLexeme id="f" lexeme="RAISE_BROWS" start="0" end="2"/>'
    planning = make_planning(accompaniment=SoundAndFace(face=True))
    planning.document("b", smile)
    (proposal,), _ = planning.said()
    assert set(proposal.tracks) == {"b"}
    assert max(map(max, proposal.tracks["b"].face.values())) > 0.3
    planning.document("c", NOD_BML)
    assert set(planning.said()[0][0].tracks) == {"c"}, "what the loop has is not sent again"
    planning.time = 100.0
    planning.state.advance_scene()
    assert planning.said()[0][0].tracks == {"b": None, "c": None}
    silent = make_planning()
    silent.document("b", smile)
    assert silent.said()[0][0].tracks == {}


def test_late_proposal_is_repeated_for_a_later_time(planning: Planning):
    cuts = []

    def late(proposal: Proposal) -> ProposalVerdict:
        cuts.append(proposal.cut - proposal.now)
        return ProposalVerdict(len(cuts) > 3, 0, proposal.cut + 0.01)

    planning.loop.rule = late
    planning.document("b", NOD_BML)
    assert np.diff(cuts).min() > 0.0
    assert cuts[1:] == pytest.approx([2 * cut for cut in cuts[:-1]])
    _, notices = planning.said()
    assert not any("warning" in notice.message for notice in notices)


@pytest.mark.parametrize(("late", "why"), [(0.01, "the machine is too busy"), (-0.01, "cause a step")])
def test_proposal_rejected_at_all_attempts_is_reported_with_its_reason(planning: Planning, late: float, why: str):
    planning.loop.rule = lambda proposal: ProposalVerdict(accepted=False, stops=0, time=proposal.cut + late)
    planning.document("b", NOD_BML)
    proposals, notices = planning.said()
    assert 5 <= len(proposals) <= 12
    assert why in notices[-1].message
    planning.loop.rule = Line().rule
    planning.document("c", NOD_BML)
    (proposal,), _ = planning.said()
    assert {block for block, _ in proposal.moving} == {"c"}, "the other has left nothing behind"


def test_emergency_stop_between_proposal_and_verdict_refuses_the_document(planning: Planning):
    """The loop reports the stop before its verdict."""
    motion = stay(planning.setup.robot.skeleton.rest, start=0.0)
    verdicts = iter([False])

    def stopped(proposal: Proposal) -> ProposalVerdict:
        accepted = next(verdicts, True)
        if not accepted:
            planning.loop.answers.append(Halted(1, 0.0, motion))
        return ProposalVerdict(accepted, 1, 0.0)

    planning.loop.rule = stopped
    planning.document("b", NOD_BML)
    proposals, notices = planning.said()
    assert proposals[-1].stops == 1
    assert proposals[-1].owed == frozenset()
    assert "rule stopped" in notices[-1].message
