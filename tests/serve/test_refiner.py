"""Refined plans of running blocks, with planner and refiner in threads."""

import pickle
from dataclasses import replace
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from threading import Thread

import numpy as np
import pytest

from kinesic.bml.block import BmlError
from kinesic.body.utterance import Script, Utterance
from kinesic.expressivity.style.style import style_preset
from kinesic.motion.trajectory import stay
from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import prepare_block
from kinesic.realizer.request import Message, read_request
from kinesic.serve import refiner as refiner_module
from kinesic.serve.messages import (
    Clock,
    DocumentRequest,
    FeedbackNotice,
    Halted,
    LoopProperties,
    LoopStart,
    PlannerReady,
    Proposal,
    ProposalVerdict,
    Renewal,
    RequestDone,
    Restyling,
)
from kinesic.serve.planner import run_planner
from kinesic.serve.refiner import RefinedPlan, RefinementJob, pack, run_refiner, unpack
from kinesic.serve.tracks import NO_ACCOMPANIMENT

from .planning_bench import BLOCK_BML, LONG_GESTURE_BML, NOD_BML, TEST_QUOTAS, Planning


def test_running_blocks_are_replanned_in_another_style_one_at_a_time(planning: Planning):
    for name, start in (("a", 0), ("b", 8)):
        planning.document(name, f'<head id="h" lexeme="NOD" start="{start}" repetition="4"/>')
    planning.state.request_refinement()
    planning.refiner.take()
    planning.state.execute(Restyling(None, (), 0.3, None, 3))
    planning.said()
    planning.state.request_refinement()
    planning.state.request_refinement()
    (data,) = planning.refiner.take()
    job = unpack(data, planning.setup)
    assert isinstance(job, RefinementJob)
    assert job.request.block.id == "a"
    assert job.renewals == 0
    better = prepare_block(job.request, planning.setup).plan
    planning.state.apply_refinement(pack(RefinedPlan("a", better)))
    (proposal,), _ = planning.said()
    assert proposal.motion is not None
    planning.state.request_refinement()
    assert len(planning.refiner.take()) == 1, "it is the next one's turn"


@pytest.mark.parametrize("plan", [None, "gone"])
def test_block_keeps_its_running_plan_if_refinement_fails(planning: Planning, plan: str | None):
    planning.document("a", '<head id="h" lexeme="NOD" start="0" repetition="4"/>')
    planning.state.execute(Restyling(None, (), 0.3, None, 3))
    planning.state.request_refinement()
    (data,) = planning.refiner.take()
    planning.said()
    job = unpack(data, planning.setup)
    found = None if plan is None else prepare_block(job.request, planning.setup).plan
    planning.state.apply_refinement(pack(RefinedPlan("gone", found)))
    proposals, notices = planning.said()
    assert not notices
    assert all(each.motion is None for each in proposals)
    assert len(proposals) == (0 if plan is None else 1)


def test_refinement_job_contains_the_number_of_lexicon_reloads(planning: Planning):
    planning.state.execute(Renewal())
    planning.state.execute(Renewal())
    assert planning.renewed == 2
    planning.document("a", '<head id="h" lexeme="NOD" start="0" repetition="4"/>')
    planning.state.execute(Restyling(None, (), 0.3, None, 3))
    planning.state.request_refinement()
    job = unpack(planning.refiner.take()[0], planning.setup)
    assert job.renewals == 2


def test_refinement_jobs_are_pickled_without_the_setup(known: Setup):
    request = read_request(Message(BLOCK_BML.format("b", NOD_BML)), known)
    data = pack(RefinedPlan("b", prepare_block(request, known).plan))
    other = replace(known, seed_of_nothing=1) if hasattr(known, "seed_of_nothing") else replace(known)
    found = unpack(data, other)
    assert isinstance(found, RefinedPlan)
    assert found.plan is not None
    assert found.plan.setup is other
    assert len(data) < 1_000_000


def styled_job(known: Setup, style: str) -> RefinementJob:
    request = read_request(Message(BLOCK_BML.format("b", LONG_GESTURE_BML)), known)
    return RefinementJob(request, known.style if style == known.style.name else style_preset(style))


@pytest.fixture
def refining(known: Setup, monkeypatch: pytest.MonkeyPatch):
    """Refiner in a thread, the planner's pipe end, and the count of created setups."""
    monkeypatch.setattr(refiner_module, "lower_priority", lambda _: None)
    ours, theirs = Pipe()
    made = []

    def make_setup() -> Setup:
        made.append(known)
        return known

    thread = Thread(target=run_refiner, args=(make_setup, theirs))
    thread.start()
    yield ours, made
    ours.close()
    thread.join(10.0)
    assert not thread.is_alive(), "it ends with the planner"


def refined(line: Connection, job: RefinementJob, setup: Setup) -> RefinedPlan:
    line.send_bytes(pack(job))
    assert line.poll(20.0), "no answer"
    found = unpack(line.recv_bytes(), setup)
    assert isinstance(found, RefinedPlan)
    return found


def test_background_replanner_synthesises_a_trial_speech_before_its_first_job(
    known: Setup, monkeypatch: pytest.MonkeyPatch
):
    scripts = []

    class HeardVoice:
        def say(self, script: Script, /, *, rate: float = 1.0, pitch: float = 1.0) -> Utterance:
            scripts.append(script)
            return known.voice.say(script, rate=rate, pitch=pitch)

    monkeypatch.setattr(refiner_module, "lower_priority", lambda _: None)
    ours, theirs = Pipe()
    ours.close()
    run_refiner(lambda: replace(known, voice=HeardVoice()), theirs)
    assert [script.text for script in scripts] == ["Yes."]


def test_background_replanner_plans_each_job_in_the_style_of_the_job(known: Setup, refining):
    line, made = refining
    usual, calm = (refined(line, styled_job(known, style), known) for style in (known.style.name, "calm"))
    assert usual.block == calm.block == "b"
    assert usual.plan is not None
    assert calm.plan is not None
    assert not np.array_equal(usual.plan.trajectory.controls, calm.plan.trajectory.controls)
    assert len(made) == 1


def test_background_replanner_rebuilds_its_setup_once_per_lexicon_reload(known: Setup, refining):
    line, made = refining
    for renewals, count in ((0, 1), (1, 2), (1, 2), (3, 3)):
        refined(line, replace(styled_job(known, known.style.name), renewals=renewals), known)
        assert len(made) == count


def test_background_replanner_returns_no_plan_if_planning_fails(
    known: Setup, refining, monkeypatch: pytest.MonkeyPatch
):
    def fail(*_: object) -> None:
        raise BmlError("b: no")

    monkeypatch.setattr(refiner_module, "prepare_block", fail)
    found = refined(refining[0], styled_job(known, known.style.name), known)
    assert (found.block, found.plan) == ("b", None)


def test_pickled_object_of_an_unexpected_type_is_rejected_by_the_background_replanner(known: Setup):
    with pytest.raises(pickle.UnpicklingError, match="unexpected dict"):
        unpack(pickle.dumps({}), known)


def test_planner_reports_readiness_executes_requests_and_ends_with_the_server(known: Setup):
    requests, loop, refiner = (Pipe() for _ in range(3))
    thread = Thread(
        target=run_planner,
        args=(lambda: known, requests[1], loop[1], refiner[1], LoopProperties(Clock(), NO_ACCOMPANIMENT), TEST_QUOTAS),
        daemon=True,
    )
    thread.start()

    def heard() -> object:
        assert loop[0].poll(30.0), "it says nothing"
        return loop[0].recv()

    requests[0].send(LoopStart(stay(known.robot.skeleton.rest, start=0.0), 0, ()))
    assert isinstance(heard(), PlannerReady)
    request = read_request(Message(BLOCK_BML.format("gone", NOD_BML)), known)
    refiner[0].send_bytes(pack(RefinedPlan("gone", prepare_block(request, known).plan)))
    assert isinstance(heard(), Proposal), "refined plans are received"
    loop[0].send(ProposalVerdict(accepted=True, stops=0, time=0.0))
    for name in ("a", "b"):
        requests[0].send(DocumentRequest(Message(BLOCK_BML.format(name, NOD_BML), 7), 0))
        said = [heard(), heard()]
        assert isinstance(said[0], FeedbackNotice)
        assert isinstance(said[1], Proposal)
        loop[0].send(ProposalVerdict(accepted=True, stops=0, time=0.0))
        assert isinstance(heard(), RequestDone)
    loop[0].send(Halted(1, 0.1, stay(known.robot.skeleton.rest, start=0.0)))
    while not isinstance(proposal := heard(), Proposal) or proposal.stops != 1:
        loop[0].send(ProposalVerdict(accepted=True, stops=0, time=0.0))
    loop[0].send(ProposalVerdict(accepted=True, stops=1, time=0.0))
    requests[0].close()
    thread.join(10.0)
    assert not thread.is_alive()
