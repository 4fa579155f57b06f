"""Planner with a stub loop and a record of its messages."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from kinesic.motion.trajectory import Trajectory, stay
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
from kinesic.serve.tracks import NO_ACCOMPANIMENT, SoundAndFace
from kinesic.serve.wire.quotas import Quotas

BLOCK_BML = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}">{}</bml>'
NOD_BML = '<head id="h" lexeme="NOD" start="0"/>'
LONG_GESTURE_BML = '<gesture id="g" lexeme="BEAT" mode="LEFT_HAND" stroke="4"/>'
TEST_QUOTAS = Quotas(duration=20.0, depth=8)


@dataclass
class Line:
    """Loop end of a planner's pipe that answers each proposal immediately."""

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
    """Planner with its clock and a record of its messages."""

    def __init__(
        self, setup: Setup, *, accompaniment: SoundAndFace = NO_ACCOMPANIMENT, motion: Trajectory | None = None
    ) -> None:
        self.time, self.loop, self.refiner, self.renewed = 0.0, Line(), Line(), 0
        self.clock = Clock()
        self.setup = setup
        beginning = LoopStart(motion or stay(setup.robot.skeleton.rest, start=0.0), 0, ())
        self.state = PlannerState(
            setup,
            self.renew,
            self.loop,
            self.refiner,
            LoopProperties(self.clock, accompaniment),
            beginning=beginning,
            rules=TEST_QUOTAS,
        )

    def renew(self, setup: Setup) -> Setup:
        self.renewed += 1
        return setup

    def document(self, name: str, inside: str, sender: int = 7, stops: int = 0) -> None:
        self.state.execute(DocumentRequest(Message(BLOCK_BML.format(name, inside), sender), stops))

    def said(self) -> tuple[list[Proposal], list[FeedbackNotice]]:
        taken = self.loop.take()
        return [item for item in taken if isinstance(item, Proposal)], [
            item for item in taken if isinstance(item, FeedbackNotice)
        ]
