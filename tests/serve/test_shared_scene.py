"""Late proposals: repeated for a later start, or refused with the reason."""

from collections.abc import Callable
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from threading import Thread
from time import sleep

import pytest

from kinesic.motion.trajectory import Trajectory
from kinesic.realizer.request import Message
from kinesic.serve.messages import DocumentRequest, FeedbackNotice, Halted, Proposal, ProposalVerdict, Words
from kinesic.serve.planner import PlannerState

PROPOSAL_DELAY = 0.1  # [s] transmission delay of each proposal, seven times the first margin
NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="nod"><head id="h" lexeme="NOD" start="0"/></bml>'
MESSAGES = [(Message(NOD, 7), "nod"), (Words("Hello there. ", 7, ends=True), "said7-1")]
Wired = tuple[PlannerState, Connection]


@dataclass
class Loop:
    """Stub loop that answers by a rule and records accepted proposals and feedback."""

    end: Connection
    answer: Callable[[Proposal], ProposalVerdict]
    accepted: list[Proposal] = field(default_factory=list)
    refusals: list[str] = field(default_factory=list)

    def listen(self) -> None:
        while (message := self.end.recv()) is not None:
            if isinstance(message, FeedbackNotice):
                self.refusals.extend([message.message] * ("warningFeedback" in message.message))
                continue
            verdict = self.answer(message)
            self.accepted.extend([message] * verdict.accepted)
            self.end.send(verdict)
            if verdict.stops > message.stops and isinstance(message.motion, Trajectory):
                self.end.send(Halted(verdict.stops, 0.0, message.motion))


def plan(wired: Wired, message: Message, answer: Callable[[Proposal], ProposalVerdict]) -> Loop:
    """Plan the document of a message, and return the stub control loop."""
    planning, end = wired
    loop = Loop(end, answer)
    listener = Thread(target=loop.listen, daemon=True)
    listener.start()
    planning.execute(DocumentRequest(message, stops=0))
    planning.plan_phrases()
    planning._shared._loop.send(None)
    listener.join(10.0)
    return loop


@pytest.mark.parametrize(("message", "block"), MESSAGES)
def test_plan_that_arrives_too_late_is_proposed_again_with_a_later_start(wired: Wired, message: Message, block: str):
    def on_its_way(proposal: Proposal) -> ProposalVerdict:
        sleep(PROPOSAL_DELAY)
        here = proposal.now + PROPOSAL_DELAY
        return ProposalVerdict(accepted=here <= proposal.cut, stops=0, time=here)

    loop = plan(wired, message, on_its_way)
    assert {each for each, _ in loop.accepted[-1].moving} == {block}
    assert loop.accepted[-1].motion is not None
    assert not loop.refusals


@pytest.mark.parametrize("message", [message for message, _ in MESSAGES])
@pytest.mark.parametrize(("late", "why"), [(9.0, "too late for every start time"), (-9.0, "cause a step")])
def test_document_whose_plans_are_all_rejected_is_refused_with_the_reason(
    wired: Wired, message: Message, late: float, why: str
):
    loop = plan(wired, message, lambda proposal: ProposalVerdict(proposal.motion is None, 0, proposal.cut + late))
    (refusal,) = loop.refusals
    assert "rule planning" in refusal
    assert why in refusal
    assert "emergency" not in refusal


def test_refusal_of_a_plan_rejected_by_an_emergency_stop_names_the_stop(wired: Wired):
    halts = iter([False])
    message, _ = MESSAGES[0]
    loop = plan(wired, message, lambda _proposal: ProposalVerdict(next(halts, True), stops=1, time=0.0))
    assert "an emergency stop came" in loop.refusals[0]
