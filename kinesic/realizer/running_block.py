"""One block of a scene: what it will do and when, and how far it is."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from kinesic.bml.block import Block, Notice, Speech
from kinesic.bml.composition import BlockState, Until
from kinesic.bml.feedback import prediction, warning
from kinesic.bml.timing.constraints import Point
from kinesic.body.utterance import Utterance
from kinesic.planning.plan import Plan
from kinesic.realizer.feedback import ScheduledFeedback, Times, agenda, span, times_of
from kinesic.realizer.merge import MergedMotion
from kinesic.realizer.occupancy import Occupancy
from kinesic.realizer.request import TimedRequest

BETTER_PLAN_TIMEOUT = 1.0  # [s] for a better plan than a provisional one


@dataclass(frozen=True, eq=False)
class PreparedBlock:
    """A block that can begin at once."""

    request: TimedRequest
    plan: Plan
    is_provisional: bool = False  # planned quickly, to be planned well while it plays

    @property
    def replan_request(self) -> TimedRequest:
        """The request to plan the block anew with the same speech."""
        return replace(self.request, block=self.plan.timeline.block, utterances=self.plan.utterances, is_decided=True)

    @property
    def moves(self) -> bool:
        """Whether the body moves in it."""
        return len(self.plan.postures.postures) > 1


@dataclass(frozen=True)
class PlayingSpeech:
    """A speech of a block that plays."""

    block: str
    behaviour: str
    begin: float  # [s] global
    utterance: Utterance

    @property
    def end(self) -> float:
        """Time at which it ends [s] global."""
        return self.begin + self.utterance.duration


@dataclass(frozen=True, eq=False)
class RunningBlock:
    """A block that waits or plays."""

    prepared: PreparedBlock
    state: BlockState
    zero: float  # [s] global time of its time 0; as expected while it waits
    times: Times  # of its sync points, as performed; of behaviours that are left out none
    waits: dict[str, Until] = field(default_factory=dict)  # other blocks, and what must come of them
    merged: MergedMotion | None = None  # how its motion was laid over the scene's
    predicted: tuple[float, Times] | None = None  # zero and times of its last predictionFeedback
    run: int = 0  # its number, unique for all blocks of a server

    @classmethod
    def of(cls, prepared: PreparedBlock, state: BlockState, waits: dict[str, Until], *, run: int = 0) -> "RunningBlock":
        """Makes a block that has not begun."""
        return cls(prepared, state, prepared.request.zero, times_of(prepared.plan.syncs), waits, run=run)

    @property
    def block(self) -> Block:
        """The block as it was requested."""
        return self.prepared.plan.timeline.block

    @cached_property
    def id(self) -> str:
        """Id of the block."""
        return self.block.id

    @property
    def sender(self) -> int:
        """Number of the client that requested it."""
        return self.prepared.request.sender

    @cached_property
    def _span(self) -> tuple[float, float, float]:
        return span(self.times)

    @property
    def lead(self) -> float:
        """Time from its start to its time 0 [s]."""
        return -self._span[0]

    @property
    def relax(self) -> float:
        """Time at which it subsides [s] global."""
        return self.zero + self._span[1]

    @property
    def end(self) -> float:
        """Time at which it ends [s] global."""
        return self.zero + self._span[2]

    @cached_property
    def points(self) -> dict[Point, float]:
        """Its sync points and its own start and end [s] global."""
        own = {Point(self.id, id, sync): self.zero + t for id, at in self.times.items() for sync, t in at.items()}
        return own | {Point(self.id, "bml", "start"): self.zero, Point(self.id, "bml", "end"): self.end}

    @property
    def speeches(self) -> tuple[PlayingSpeech, ...]:
        """Its speech that is not left out."""
        return tuple(
            PlayingSpeech(self.id, behaviour.id, self.zero + self.times[behaviour.id]["start"], utterance)
            for behaviour in self.block.behaviours
            if isinstance(behaviour.action, Speech)
            and behaviour.id in self.times
            and (utterance := self.prepared.plan.utterances.get(behaviour.id)) is not None
        )

    @property
    def occupancy(self) -> tuple[Occupancy, ...]:
        """Which hinges its behaviours occupy, and when [s] global."""
        return () if self.merged is None else self.merged.occupancy

    def agenda(self) -> tuple[ScheduledFeedback, ...]:
        """Feedback of all its points, in order."""
        return agenda(self.id, self.times, self.zero, sender=self.sender, character=self.block.character, run=self.run)

    def prediction(self, now: float) -> ScheduledFeedback:
        """Writes its predictionFeedback."""
        start, _, end = span(self.times)
        text = prediction(self.block, start, end, self.times, zero=self.zero)
        return ScheduledFeedback(now, text, self.sender)

    def warning(self, notice: Notice, now: float) -> ScheduledFeedback:
        """Writes a warningFeedback about it."""
        return ScheduledFeedback(now, warning(notice, character=self.block.character), self.sender)

    def differs_from_prediction(self, by: float) -> bool:
        """Whether a time is not as it was predicted, by more than so many seconds."""
        if self.predicted is None:
            return True
        zero, times = self.predicted
        if abs(zero - self.zero) > by or times.keys() != self.times.keys():
            return True
        return any(
            abs(times[id].get(sync, np.inf) - time) > by for id, own in self.times.items() for sync, time in own.items()
        )

    @property
    def certain_notices(self) -> tuple[Notice, ...]:
        """Notices to be sent at once: of a provisional plan none about its times."""
        plan = self.prepared.plan
        return plan.keyframes.notices if self.prepared.is_provisional else plan.notices

    def doubtful_warnings(self, now: float) -> tuple[ScheduledFeedback, ...]:
        """Warnings to be sent when no better plan comes in time."""
        doubtful = [notice for notice in self.prepared.plan.notices if notice not in self.certain_notices]
        late = now + BETTER_PLAN_TIMEOUT
        return tuple(replace(self.warning(notice, late), unless_improved=self.id) for notice in doubtful)

    def without(self, behaviours: frozenset[str]) -> "RunningBlock":
        """Leaves out some of its behaviours from now on."""
        merged = self.merged
        if merged is not None:
            merged = replace(
                merged, occupancy=tuple(each for each in merged.occupancy if each.behaviour not in behaviours)
            )
        times = {id: own for id, own in self.times.items() if id not in behaviours}
        return replace(self, merged=merged, times=times)

    def since(self, time: float) -> "RunningBlock":
        """Forgets what it did before a time [s]."""
        return self if self.merged is None else replace(self, merged=self.merged.since(time))


@dataclass(frozen=True)
class EndedBlock:
    """A block that is over, as later blocks may refer to it."""

    id: str
    state: BlockState
    points: Mapping[Point, float]  # [s] global
