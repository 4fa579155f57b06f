"""A planner at a loop that answers by a rule, in simulated time: what it proposes for each request."""

import json
import pickle
import re
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from threading import Thread

import numpy as np
import pytest

from kinesic.bml.block import BmlError
from kinesic.controller.perform import set_up
from kinesic.expressivity.style.style import style_preset
from kinesic.motion.trajectory import stay
from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import prepare_block
from kinesic.realizer.request import Message, read_request
from kinesic.serve import messages
from kinesic.serve import refiner as refiner_module
from kinesic.serve.idling import PAUSE, SPELL
from kinesic.serve.messages import (
    Clock,
    DocumentRequest,
    FeedbackNotice,
    Halted,
    Interruption,
    LoopProperties,
    LoopStart,
    PlannerReady,
    Proposal,
    ProposalVerdict,
    Renewal,
    RequestDone,
    Restyling,
    Resumption,
    Words,
)
from kinesic.serve.planner import LOOK, PlannerState, run_planner
from kinesic.serve.refiner import RefinedPlan, RefinementJob, pack, run_refiner, unpack
from kinesic.serve.tracks import SILENT, SoundAndFace
from kinesic.serve.wire.quotas import Quotas

from .simulated import feedback_of

BML = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
NOD = '<head id="h" lexeme="NOD" start="0"/>'
LONG = '<gesture id="g" lexeme="BEAT" mode="LEFT_HAND" stroke="4"/>'
RULES = Quotas(duration=20.0, depth=8)


@dataclass
class Line:
    """The loop's end of a planner's pipe, which answers every proposal at once."""

    sent: list[object] = field(default_factory=list)
    answers: deque[object] = field(default_factory=deque)
    rule: Callable[[Proposal], ProposalVerdict] = lambda _: ProposalVerdict(accepted=True, stops=0, time=0.0)

    def send(self, message: object) -> None:
        self.sent.append(message)
        if isinstance(message, Proposal):
            self.answers.append(self.rule(message))

    def recv(self) -> object:
        return self.answers.popleft()

    def send_bytes(self, data: bytes) -> None:
        self.sent.append(data)

    def take(self) -> list[object]:
        taken, self.sent = self.sent, []
        return taken


class Planning:
    """A planner, its clock, and all that it says."""

    def __init__(self, setup: Setup, *, accompaniment: SoundAndFace = SILENT) -> None:
        self.time, self.loop, self.refiner, self.renewed = 0.0, Line(), Line(), 0
        self.clock = Clock()
        self.setup = setup
        beginning = LoopStart(stay(setup.robot.skeleton.rest, start=0.0), 0, ())
        self.state = PlannerState(
            setup,
            self.renew,
            self.loop,
            self.refiner,
            LoopProperties(self.clock, accompaniment),
            beginning=beginning,
            rules=RULES,
        )

    def renew(self, setup: Setup) -> Setup:
        self.renewed += 1
        return setup

    def document(self, name: str, inside: str, sender: int = 7, stops: int = 0) -> None:
        self.state.fulfil(DocumentRequest(Message(BML.format(name, inside), sender), stops))

    def said(self) -> tuple[list[Proposal], list[FeedbackNotice]]:
        taken = self.loop.take()
        return [each for each in taken if isinstance(each, Proposal)], [
            each for each in taken if isinstance(each, FeedbackNotice)
        ]


@pytest.fixture
def make(known: Setup, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Planning]:
    """Makes planners whose time goes on only when they are told to."""
    made: list[Planning] = []
    monkeypatch.setattr(messages, "monotonic", lambda: made[-1].time if made else 0.0)

    def making(setup: Setup = known, **options: object) -> Planning:
        made.append(Planning(setup, **options))
        return made[-1]

    return making


@pytest.fixture
def planning(make: Callable[..., Planning]) -> Planning:
    return make()


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


@pytest.fixture(scope="module")
def lively() -> Setup:
    return set_up(idle=1.0)


def test_it_idles_some_time_after_a_document_and_not_before(make: Callable[..., Planning], lively: Setup):
    planning = make(lively)
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


def test_nobody_idles_after_everything_was_interrupted(make: Callable[..., Planning], lively: Setup):
    planning = make(lively)
    planning.document("b", NOD)
    planning.state.fulfil(Interruption(None))
    planning.time = 50.0
    planning.state.go_on()
    assert planning.state.pause is None
    assert not planning.said()[0][-1].idles


def test_idling_goes_on_after_one_block_was_interrupted(make: Callable[..., Planning], lively: Setup):
    planning = make(lively)
    planning.document("b", NOD)
    planning.state.fulfil(Interruption("b"))
    planning.time = 50.0
    planning.state.go_on()
    planning.state.go_on()
    assert planning.said()[0][-1].idles


def test_a_spell_that_is_refused_is_put_off(make: Callable[..., Planning], lively: Setup):
    planning = make(lively)
    planning.document("b", NOD)
    planning.time = 50.0
    planning.state.go_on()
    planning.said()
    planning.loop.rule = lambda proposal: ProposalVerdict(proposal.motion is None, 0, 0.0)
    planning.state.go_on()
    if planning.state.pause is not None:
        assert planning.state.pause > 1.0


def test_a_style_that_nobody_knows_is_refused_and_a_known_one_is_that_of_what_comes(planning: Planning):
    planning.state.fulfil(Restyling("gloomy", (), None, None, 3))
    proposals, (notice,) = planning.said()
    assert not proposals
    assert notice.sender == 3
    told = json.loads(notice.message)
    assert (told["told"], told["do"]) == ("refused", "style")
    assert "gloomy" in told["why"]
    planning.state.fulfil(Restyling("calm", ("power=-0.5",), None, None, 3))
    assert planning.said()[1] == []
    planning.document("b", LONG)
    (calm,), _ = planning.said()
    other = Planning(planning.setup)
    other.document("b", LONG)
    (usual,), _ = other.said()
    shared = min(len(calm.motion.controls), len(usual.motion.controls))
    assert not np.allclose(calm.motion.controls[:shared], usual.motion.controls[:shared], atol=1e-3)


@pytest.mark.parametrize("changes", [("power=9",), ("powr=0.5",), ("power",)])
def test_changes_that_make_no_style_are_refused(planning: Planning, changes: tuple[str, ...]):
    planning.state.fulfil(Restyling(None, changes, None, None, 3))
    proposals, (notice,) = planning.said()
    assert not proposals
    assert json.loads(notice.message)["told"] == "refused"


def test_changes_without_a_style_change_the_present_one(planning: Planning):
    planning.state.fulfil(Restyling("calm", (), None, None, 3))
    planning.state.fulfil(Restyling(None, ("power=0.5",), None, None, 3))
    planning.document("b", LONG)
    both = planning.said()[0][-1].motion.controls
    other = Planning(planning.setup)
    other.state.fulfil(Restyling(None, ("power=0.5",), None, None, 3))
    other.document("b", LONG)
    alone = other.said()[0][-1].motion.controls
    shared = min(len(both), len(alone))
    assert not np.allclose(both[:shared], alone[:shared], atol=1e-3)


def test_a_block_that_plays_is_planned_anew_in_another_style_one_at_a_time(planning: Planning):
    for name, start in (("a", 0), ("b", 8)):
        planning.document(name, f'<head id="h" lexeme="NOD" start="{start}" repetition="4"/>')
    planning.state.request_refinement()
    planning.refiner.take()
    planning.state.fulfil(Restyling(None, (), 0.3, None, 3))
    planning.said()
    planning.state.request_refinement()
    planning.state.request_refinement()
    (data,) = planning.refiner.take()
    job = unpack(data, planning.setup)
    assert isinstance(job, RefinementJob)
    assert job.request.block.id == "a"
    assert job.renewals == 0
    better = prepare_block(job.request, planning.setup).plan
    planning.state.improve(pack(RefinedPlan("a", better)))
    (proposal,), _ = planning.said()
    assert proposal.motion is not None
    planning.state.request_refinement()
    assert len(planning.refiner.take()) == 1, "it is the next one's turn"


@pytest.mark.parametrize("plan", [None, "gone"])
def test_a_plan_that_cannot_be_better_changes_nothing(planning: Planning, plan: str | None):
    planning.document("a", '<head id="h" lexeme="NOD" start="0" repetition="4"/>')
    planning.state.fulfil(Restyling(None, (), 0.3, None, 3))
    planning.state.request_refinement()
    (data,) = planning.refiner.take()
    planning.said()
    job = unpack(data, planning.setup)
    found = None if plan is None else prepare_block(job.request, planning.setup).plan
    planning.state.improve(pack(RefinedPlan("gone", found)))
    proposals, notices = planning.said()
    assert not notices
    assert all(each.motion is None for each in proposals)
    assert len(proposals) == (0 if plan is None else 1)


def test_gestures_are_read_anew_and_the_refiner_is_told_how_often(planning: Planning):
    planning.state.fulfil(Renewal())
    planning.state.fulfil(Renewal())
    assert planning.renewed == 2
    planning.document("a", '<head id="h" lexeme="NOD" start="0" repetition="4"/>')
    planning.state.fulfil(Restyling(None, (), 0.3, None, 3))
    planning.state.request_refinement()
    job = unpack(planning.refiner.take()[0], planning.setup)
    assert job.renewals == 2


def saying(notices: list[FeedbackNotice]) -> list[dict]:
    return [json.loads(each.message) for each in notices if each.message.startswith("{")]


def test_words_are_said_as_they_are_whole_and_all_is_told_at_the_end(planning: Planning):
    planning.state.fulfil(DocumentRequest(Words("Hello there. And", 7), 0))
    proposals, _ = planning.said()
    assert proposals[-1].owed == {7}, "its client is owed the rest"
    planning.state.speak()
    proposals, notices = planning.said()
    (told,) = saying(notices)
    assert (told["told"], told["text"], told["block"]) == ("saying", "Hello there", "said7-1")
    assert {block for block, _ in proposals[-1].moving} <= {"said7-1"}
    assert {each.sender for each in notices} == {7}
    planning.state.speak()
    assert saying(planning.said()[1]) == [], "the rest is awaited"
    assert planning.state.pause is not None
    planning.state.fulfil(DocumentRequest(Words(" so on.", 7, ends=True), 0))
    planning.time = 100.0
    planning.state.go_on()
    planning.state.speak()
    told = saying(planning.said()[1])
    assert [each["told"] for each in told] == ["saying", "all_said"]
    assert told[0]["text"] == "And so on"
    assert told[1]["block"] == told[0]["block"] == "said7-2"


def test_what_is_said_waits_for_whoever_speaks(planning: Planning):
    text = "One two three four five six seven eight nine ten. "
    planning.state.fulfil(DocumentRequest(Words(text, 1, ends=True), 0))
    planning.state.fulfil(DocumentRequest(Words("Here I am.", 2, ends=True), 0))
    planning.state.speak()
    first = saying(planning.said()[1])
    assert {each["block"][:5] for each in first} == {"said1"}
    planning.time = 100.0
    planning.state.go_on()
    planning.state.speak()
    assert "said2-1" in [each.get("block") for each in saying(planning.said()[1])]


@pytest.mark.parametrize("request_", [Interruption(None), "stop"])
def test_words_that_are_not_said_are_forgotten(planning: Planning, request_: Interruption | str):
    planning.state.fulfil(DocumentRequest(Words("Hello there. And so on.", 7), 0))
    if request_ == "stop":
        planning.state.take_halt(Halted(1, 0.0, stay(planning.setup.robot.skeleton.rest)))
    else:
        planning.state.fulfil(request_)
    assert planning.said()[0][-1].owed == frozenset()
    planning.state.speak()
    assert planning.said() == ([], [])


def test_too_many_words_are_refused(planning: Planning):
    planning.state.fulfil(DocumentRequest(Words("x " * 60_000, 7), 0))
    notices = planning.said()[1]
    assert re.search("rule waiting: .* letters wait", notices[0].message)
    assert notices[0].sender == 7


def test_faces_and_sounds_go_with_the_motion_where_there_are_sinks(make: Callable[..., Planning]):
    smile = '<faceLexeme id="f" lexeme="RAISE_BROWS" start="0" end="2"/>'
    planning = make(accompaniment=SoundAndFace(face=True))
    planning.document("b", smile)
    (proposal,), _ = planning.said()
    assert set(proposal.tracks) == {"b"}
    assert max(map(max, proposal.tracks["b"].face.values())) > 0.3
    planning.document("c", NOD)
    assert set(planning.said()[0][0].tracks) == {"c"}, "what the loop has is not sent again"
    planning.time = 100.0
    planning.state.go_on()
    assert planning.said()[0][0].tracks == {"b": None, "c": None}
    silent = make()
    silent.document("b", smile)
    assert silent.said()[0][0].tracks == {}


def test_a_proposal_that_comes_too_late_is_made_again_for_a_later_time(planning: Planning):
    cuts = []

    def late(proposal: Proposal) -> ProposalVerdict:
        cuts.append(proposal.cut - proposal.now)
        return ProposalVerdict(len(cuts) > 3, 0, proposal.cut + 0.01)

    planning.loop.rule = late
    planning.document("b", NOD)
    assert np.diff(cuts).min() > 0.0
    assert cuts[1:] == pytest.approx([2 * cut for cut in cuts[:-1]])
    _, notices = planning.said()
    assert not any("warning" in each.message for each in notices)


@pytest.mark.parametrize(("late", "why"), [(0.01, "the machine is too busy"), (-0.01, "a step from what plays")])
def test_what_is_never_taken_is_refused_for_its_reason(planning: Planning, late: float, why: str):
    planning.loop.rule = lambda proposal: ProposalVerdict(accepted=False, stops=0, time=proposal.cut + late)
    planning.document("b", NOD)
    proposals, notices = planning.said()
    assert 5 <= len(proposals) <= 12
    assert why in notices[-1].message
    planning.loop.rule = Line().rule
    planning.document("c", NOD)
    (proposal,), _ = planning.said()
    assert {block for block, _ in proposal.moving} == {"c"}, "the other has left nothing behind"


def test_a_stop_between_proposal_and_verdict_counts(planning: Planning):
    """The loop made a stop first: what it tells of it comes before its verdict."""
    motion = stay(planning.setup.robot.skeleton.rest, start=0.0)
    verdicts = iter([False])

    def stopped(proposal: Proposal) -> ProposalVerdict:
        accepted = next(verdicts, True)
        if not accepted:
            planning.loop.answers.append(Halted(1, 0.0, motion))
        return ProposalVerdict(accepted, 1, 0.0)

    planning.loop.rule = stopped
    planning.document("b", NOD)
    proposals, notices = planning.said()
    assert proposals[-1].stops == 1
    assert proposals[-1].owed == frozenset()
    assert "rule stopped" in notices[-1].message


def test_a_plan_goes_to_the_refiner_without_the_setup(known: Setup):
    request = read_request(Message(BML.format("b", NOD)), known)
    data = pack(RefinedPlan("b", prepare_block(request, known).plan))
    other = replace(known, seed_of_nothing=1) if hasattr(known, "seed_of_nothing") else replace(known)
    found = unpack(data, other)
    assert isinstance(found, RefinedPlan)
    assert found.plan is not None
    assert found.plan.setup is other
    assert len(data) < 1_000_000


def styled_job(known: Setup, style: str) -> RefinementJob:
    request = read_request(Message(BML.format("b", LONG)), known)
    return RefinementJob(request, known.style if style == known.style.name else style_preset(style))


@pytest.fixture
def refining(known: Setup, monkeypatch: pytest.MonkeyPatch):
    """A refiner in a thread, and the planner's end of its line; how often it made a setup."""
    monkeypatch.setattr(refiner_module.os, "nice", lambda _: None)
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


def test_the_refiner_plans_job_after_job_in_the_style_of_each(known: Setup, refining):
    line, made = refining
    usual, calm = (refined(line, styled_job(known, style), known) for style in (known.style.name, "calm"))
    assert usual.block == calm.block == "b"
    assert usual.plan is not None
    assert calm.plan is not None
    assert not np.array_equal(usual.plan.trajectory.controls, calm.plan.trajectory.controls)
    assert len(made) == 1


def test_the_refiner_reads_gestures_anew_once_for_each_time_they_were(known: Setup, refining):
    line, made = refining
    for renewals, count in ((0, 1), (1, 2), (1, 2), (3, 3)):
        refined(line, replace(styled_job(known, known.style.name), renewals=renewals), known)
        assert len(made) == count


def test_what_cannot_be_planned_has_no_plan(known: Setup, refining, monkeypatch: pytest.MonkeyPatch):
    def fail(*_: object) -> None:
        raise BmlError("b: no")

    monkeypatch.setattr(refiner_module, "prepare_block", fail)
    found = refined(refining[0], styled_job(known, known.style.name), known)
    assert (found.block, found.plan) == ("b", None)


def test_what_is_no_job_is_no_message(known: Setup):
    with pytest.raises(pickle.UnpicklingError, match="a dict came"):
        unpack(pickle.dumps({}), known)


def test_a_planner_says_that_it_is_ready_fulfils_requests_and_ends_with_the_server(known: Setup):
    requests, loop, refiner = (Pipe() for _ in range(3))
    thread = Thread(
        target=run_planner,
        args=(lambda: known, requests[1], loop[1], refiner[1], LoopProperties(Clock(), SILENT), RULES),
    )
    thread.start()

    def heard() -> object:
        assert loop[0].poll(30.0), "it says nothing"
        return loop[0].recv()

    requests[0].send(LoopStart(stay(known.robot.skeleton.rest, start=0.0), 0, ()))
    assert isinstance(heard(), PlannerReady)
    for name in ("a", "b"):
        requests[0].send(DocumentRequest(Message(BML.format(name, NOD), 7), 0))
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
