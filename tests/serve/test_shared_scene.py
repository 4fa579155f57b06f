"""What a planner proposes too late: it is planned again for a later start, and a refusal says what was the matter."""

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

WAY = 0.1  # [s] that every proposal is on its way: seven times what the first one allows for
NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="nod"><head id="h" lexeme="NOD" start="0"/></bml>'
MESSAGES = [(Message(NOD, 7), "nod"), (Words("Hello there. ", 7, ends=True), "said7-1")]
Wired = tuple[PlannerState, Connection]


@dataclass
class Loop:
    """The other end of a planner's pipe: answers by a rule, and keeps what it accepts and what clients are told."""

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
    """Plans a message at a loop that answers so."""
    planning, end = wired
    loop = Loop(end, answer)
    listener = Thread(target=loop.listen, daemon=True)
    listener.start()
    planning.fulfil(DocumentRequest(message, stops=0))
    planning.speak()
    planning._shared._loop.send(None)
    listener.join(10.0)
    return loop


@pytest.mark.parametrize(("message", "block"), MESSAGES)
def test_what_was_planned_too_late_begins_later_and_is_not_lost(wired: Wired, message: Message, block: str):
    def on_its_way(proposal: Proposal) -> ProposalVerdict:
        sleep(WAY)
        here = proposal.now + WAY
        return ProposalVerdict(accepted=here <= proposal.cut, stops=0, time=here)

    loop = plan(wired, message, on_its_way)
    assert {each for each, _ in loop.accepted[-1].moving} == {block}
    assert loop.accepted[-1].motion is not None
    assert not loop.refusals


@pytest.mark.parametrize("message", [message for message, _ in MESSAGES])
@pytest.mark.parametrize(("late", "why"), [(9.0, "in time at none of its starts"), (-9.0, "have been a step")])
def test_what_the_loop_never_takes_is_refused_for_the_true_reason(
    wired: Wired, message: Message, late: float, why: str
):
    loop = plan(wired, message, lambda proposal: ProposalVerdict(proposal.motion is None, 0, proposal.cut + late))
    (refusal,) = loop.refusals
    assert "rule planning" in refusal
    assert why in refusal
    assert "emergency" not in refusal


def test_an_emergency_stop_is_the_reason_where_one_came(wired: Wired):
    halts = iter([False])
    message, _ = MESSAGES[0]
    loop = plan(wired, message, lambda _proposal: ProposalVerdict(next(halts, True), stops=1, time=0.0))
    assert "an emergency stop came" in loop.refusals[0]
