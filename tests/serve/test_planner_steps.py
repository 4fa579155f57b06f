"""Requests and due events of the planner, with stubbed scene and texts."""

import json
import re
from dataclasses import replace
from math import inf
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.bml.block import BmlError
from kinesic.motion.trajectory import stay
from kinesic.realizer.request import Message
from kinesic.serve import planner as module
from kinesic.serve.messages import (
    DocumentRequest,
    Interruption,
    Renewal,
    Resumption,
    Words,
)
from kinesic.serve.planner import PlannerState
from kinesic.serve.refiner import RefinedPlan
from kinesic.serve.shared_scene import Verdict
from kinesic.serve.talks import Phrase
from kinesic.serve.wire.quotas import Quotas

from .played_planner import NOW, played_planner


@pytest.fixture
def state(known, monkeypatch) -> PlannerState:
    return played_planner(known, monkeypatch)


def test_emergency_stop_forbids_idle_motion_and_clears_unspoken_words(state):
    assert state._shared.other_clients() == {3}
    state._shared.on_halt()
    assert state._idling.calls == ["forbid"]
    assert state._talks.taken == ["cleared"]


@pytest.mark.parametrize(
    ("scene", "idle", "words", "pause"),
    [
        (inf, inf, inf, None),
        (9.0, inf, inf, 2.0),
        (inf, 8.0, inf, 1.0),
        (inf, inf, 7.5, 0.5),
        (9.0, 8.0, 7.5, 0.5),
        (7.01, inf, inf, 0.05),
        (1.0, inf, inf, 0.05),
    ],
)
def test_planner_pauses_until_its_next_event(state, scene, idle, words, pause):
    state._shared.scene = SimpleNamespace(next_time=scene)
    state._idling.time, state._talks.time = idle, words
    assert state.pause == (None if pause is None else pytest.approx(pause))


@pytest.mark.parametrize(("time", "idles"), [(6.9, True), (NOW, True), (7.1, False)])
def test_idle_motion_begins_when_it_is_due(state, monkeypatch, time, idles):
    state._idling.time = time
    given = []

    def begin_idle(scene, spell, now):
        given.append((scene.runs, spell, now))
        return replace(scene, idle="moving")

    monkeypatch.setattr(module, "begin_idle", begin_idle)
    state.advance_scene()
    assert given == ([(100, "spell", NOW)] if idles else [])
    assert state._shared.scene.runs == 100
    assert state._idling.calls == []


def test_idle_motion_that_did_not_begin_is_postponed(state, monkeypatch):
    state._idling.time = NOW
    monkeypatch.setattr(module, "begin_idle", lambda scene, spell, now: scene)
    state.advance_scene()
    assert state._idling.calls == [("postpone", NOW)]


@pytest.mark.parametrize("block", [None, "b"])
def test_interruption_of_all_blocks_cancels_idle_motion_and_words(state, monkeypatch, block):
    monkeypatch.setattr(
        module, "interrupt", lambda scene, now, block, yields: replace(scene, runs=(now, block, yields))
    )
    state.execute(Interruption(block, yields=True))
    assert state._shared.scene.runs == (NOW, block, True)
    assert state._idling.calls == ["forbid"] * (block is None)
    assert state._talks.taken == ["cleared"] * (block is None)
    assert state._shared.waited == []


def test_request_to_reload_the_lexicon_reloads_the_setup_of_the_planner(state):
    setup = state._shared.scene.setup
    state.execute(Renewal())
    assert state._shared.renewed == [("new", setup)]
    state.execute(Renewal())
    assert state._renewals == 2


@pytest.mark.parametrize(("stops", "count"), [(1, 0), (2, 1), (3, 0)])
def test_robot_returns_to_rest_when_the_last_stop_is_resumed(state, stops, count):
    rest = state._shared.scene.motion.controls[-1]
    bent = state._shared.scene.setup.robot.skeleton.clamp(rest + 0.2)
    state._shared.scene = replace(state._shared.scene, motion=stay(bent), lasting=("held",))
    state.execute(Resumption(stops))
    assert state._shared.waited == [stops]
    assert len(state._shared.proposals) == count
    if count:
        np.testing.assert_allclose(state._shared.scene.motion.controls[-1], rest, atol=1e-9)
        assert state._shared.scene.lasting == ()


def test_only_hinges_with_a_nonzero_range_return_to_rest_on_resume(state, monkeypatch):
    given = []

    def release(motion, at, hinges, setup):
        given.append((at, hinges.tolist()))
        return motion

    monkeypatch.setattr(module, "release_motion", release)
    scene = state._shared.scene
    lower, upper = np.zeros(3), np.array([1.0, 0.0, 1.0])
    setup = SimpleNamespace(limits=SimpleNamespace(lower=lower, upper=upper))
    state._shared.scene = replace(scene, setup=setup, ahead=0.5)
    state.execute(Resumption(2))
    ((at, hinges),) = given
    assert at == 7.5
    assert hinges == [True, False, True]
    assert state._shared.scene.motion is not scene.motion


def test_streamed_words_are_queued_and_a_refusal_is_sent_to_their_client(state):
    words = Words("Hello", 7)
    state.execute(DocumentRequest(words, 2))
    assert state._talks.taken == [(words, NOW)]
    assert state._idling.calls == [("allow", NOW)]
    assert (state._shared.waited, state._shared.told) == ([2], [])
    assert state._shared.scene.runs == 100
    state._talks.refusal = "too long"
    state.execute(DocumentRequest(words, 2))
    ((message, sender),) = state._shared.told
    assert "rule waiting: too long" in message
    assert sender == 7
    assert state._shared.scene.runs == 200


def planned(state, monkeypatch, *, start: float = 0.0, end: float = 20.0):
    """Record the calls that plan a document from a start to an end [s]."""
    calls = []
    request = SimpleNamespace(
        block=SimpleNamespace(id="b"), timeline=SimpleNamespace(start=start, end=end), prediction="prediction"
    )

    def read(message, setup, *, context, bounds):
        calls.append((message, setup, context, bounds.size, bounds.depth))
        return "read"

    monkeypatch.setattr(module, "read_request", read)
    monkeypatch.setattr(module, "with_busy_hands", lambda scene, found: request if found == "read" else None)
    monkeypatch.setattr(
        module, "prepare_block", lambda found, setup, *, is_scheduled: ("plan", found is request, is_scheduled)
    )
    monkeypatch.setattr(module, "begin", lambda scene, prepared, now: replace(scene, runs=(prepared, now)))
    state.execute(DocumentRequest(Message("<bml id='b'/>", 7), 2))
    return calls


def test_document_is_predicted_and_planned_and_idle_motion_allowed(state, monkeypatch):
    ((message, setup, context, size, depth),) = planned(state, monkeypatch)
    assert (message.sender, setup, context.now) == (7, state._shared.scene.setup, NOW)
    assert (size, depth) == (Quotas().message, 8)
    assert state._shared.told == [("prediction", 7)]
    assert state._shared.scene.runs == (("plan", True, True), NOW)
    assert state._idling.calls == [("allow", NOW)]


@pytest.mark.parametrize(("start", "end", "is_refused"), [(0.0, 20.0, False), (0.0, 20.1, True), (-1.0, 19.1, True)])
def test_document_longer_than_the_quota_is_refused(state, monkeypatch, start, end, is_refused):
    planned(state, monkeypatch, start=start, end=end)
    ((message, sender),) = state._shared.told
    assert sender == 7
    assert ("rule duration" in message) is is_refused
    assert (state._shared.proposals == []) is is_refused
    if is_refused:
        assert f"b lasts {end:.0f} s, at most 20 s are taken: split it" in message
        assert 'id="b"' in message


@pytest.mark.parametrize(
    ("verdict", "rule", "why"),
    [
        (Verdict.STOPPED, "stopped", "resume first"),
        (Verdict.LATE, "planning", "too late for every start time"),
        (Verdict.UNSTEADY, "planning", "would cause a step"),
    ],
)
def test_rejected_plan_is_reported_with_its_reason(state, monkeypatch, verdict, rule, why):
    state._shared.verdict = verdict
    planned(state, monkeypatch)
    message, sender = state._shared.told[-1]
    assert f"rule {rule}: " in message
    assert why in message
    assert 'id="b"' in message
    assert sender == 7


def test_document_sent_before_an_emergency_stop_is_refused_and_its_motion_not_proposed(state, monkeypatch):
    state._shared.stops = 3
    planned(state, monkeypatch)
    assert state._shared.proposals == []
    assert "rule stopped" in state._shared.told[-1][0]


def test_refusal_or_failure_of_a_document_is_sent_to_its_client(state, monkeypatch, capfd):
    def fail(error):
        def read(*_, **__):
            raise error

        monkeypatch.setattr(module, "read_request", read)
        state.execute(DocumentRequest(Message("<bml id='b'/>", 7), 2))
        return state._shared.told[-1]

    message, sender = fail(BmlError("no such gesture"))
    assert (sender, "no such gesture" in message, "PARSING_FAILURE" in message) == (7, True, True)
    message, sender = fail(IndexError("defect"))
    assert sender == 7
    assert re.search(r'id="b".*rule planning: planning failed \(IndexError\)', message)
    assert "defect" in capfd.readouterr().err
    with pytest.raises(ConnectionResetError):
        fail(ConnectionResetError())


def test_streamed_phrases_are_reported_and_planned_in_turn(state, monkeypatch):
    documents = []
    monkeypatch.setattr(PlannerState, "_plan", lambda _, document: documents.append(document))
    state._talks.phrases = [
        Phrase(4, "said4-1", "<one/>", "One."),
        Phrase(5, "said5-1", "<two/>", "Two.", replaced=frozenset({"n"}), before="gone"),
    ]
    state._talks.ended = [(4, "said4-1")]
    state.plan_phrases()
    assert [(document.message.text, document.message.sender, document.stops) for document in documents] == [
        ("<one/>", 4, 2),
        ("<two/>", 5, 2),
    ]
    assert {document.message.source for document in documents} == {"<words>"}
    assert len(state._shared.proposals) == 1
    told = [(json.loads(message), sender) for message, sender in state._shared.told]
    assert [(message["told"], message["block"], sender) for message, sender in told] == [
        ("saying", "said4-1", 4),
        ("saying", "said5-1", 5),
        ("all_said", "said4-1", 4),
    ]


def test_background_replanner_gets_one_block_at_a_time(state, monkeypatch):
    monkeypatch.setattr(module, "pack", lambda job: job)
    state.request_refinement()
    assert state._refiner.sent == []
    state._shared.replans = ["first", "second"]
    state._renewals = 4
    state.request_refinement()
    state.request_refinement()
    (job,) = state._refiner.sent
    assert (job.request, job.style, job.renewals) == ("first", state._shared.scene.setup.style, 4)
    monkeypatch.setattr(module, "unpack", lambda data, setup: RefinedPlan("first", None))
    state.apply_refinement(b"")
    assert state._shared.proposals == []
    state.request_refinement()
    assert [job.request for job in state._refiner.sent] == ["first", "second"]


@pytest.mark.parametrize("is_possible", [True, False])
def test_refined_plan_is_applied_to_the_current_scene_and_proposed_if_possible(state, monkeypatch, is_possible):
    given = []

    def improve(scene, block, plan, now):
        given.append((scene.runs, block, plan, now))
        return replace(scene, runs=999) if is_possible else None

    monkeypatch.setattr(module, "unpack", lambda data, setup: RefinedPlan("b", "plan"))
    monkeypatch.setattr(module, "improve_block", improve)
    state.apply_refinement(b"")
    assert given == [(100, "b", "plan", NOW)]
    assert state._shared.scene.runs == (999 if is_possible else 100)
