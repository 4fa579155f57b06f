"""A planner at a loop that answers by a rule: what it proposes, and what it has told."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from kinesic.motion.trajectory import stay
from kinesic.planning.setup import Setup
from kinesic.realizer.request import Message
from kinesic.serve.messages import (
    Clock,
    DocumentRequest,
    FeedbackNotice,
    LoopProperties,
    LoopStart,
    Proposal,
    ProposalVerdict,
)
from kinesic.serve.planner import PlannerState
from kinesic.serve.tracks import SILENT, SoundAndFace
from kinesic.serve.wire.quotas import Quotas

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
