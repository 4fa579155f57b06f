"""Waiting or running block of a scene."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from kinesic.bml.block import Block, Notice, Speech
from kinesic.bml.composition import BlockState, Until
from kinesic.bml.feedback import write_prediction, write_warning
from kinesic.bml.timing.constraints import Point
from kinesic.body.utterance import Utterance
from kinesic.planning.plan import Plan
from kinesic.realizer.feedback import ScheduledFeedback, Times, block_span, schedule_feedback, times_by_behaviour
from kinesic.realizer.merge import MergedMotion
from kinesic.realizer.occupancy import Occupancy
from kinesic.realizer.request import TimedRequest

REFINEMENT_TIMEOUT = 1.0  # [s] longest wait for a refined plan before provisional warnings are sent


@dataclass(frozen=True, eq=False)
class PreparedBlock:
    """Planned block that can start at once."""

    request: TimedRequest
    plan: Plan
    is_provisional: bool = False  # whether the plan is a quick one that a refined plan will replace

    @property
    def replan_request(self) -> TimedRequest:
        """Request to replan the block with the same speech."""
        return replace(self.request, block=self.plan.timeline.block, utterances=self.plan.utterances, is_decided=True)

    @property
    def moves(self) -> bool:
        """Whether the block moves the body."""
        return len(self.plan.postures.postures) > 1


@dataclass(frozen=True)
class PlayingSpeech:
    """Speech behaviour of a running block, with its global start time."""

    block: str
    behaviour: str
    begin: float  # [s] global start time
    utterance: Utterance

    @property
    def end(self) -> float:
        """Global time [s] at which the utterance ends."""
        return self.begin + self.utterance.duration


@dataclass(frozen=True, eq=False)
class RunningBlock:
    """State of a waiting or running block: plan, times and motion."""

    prepared: PreparedBlock
    state: BlockState
    zero: float  # [s] global time of block time 0; an estimate while the block waits
    times: Times  # times of sync points as performed, without dropped behaviours
    waits: dict[str, Until] = field(default_factory=dict)  # dependencies: other blocks and the point to wait for
    merged: MergedMotion | None = None  # motion of the block, merged into the scene's motion
    predicted: tuple[float, Times] | None = None  # zero and times of the last predictionFeedback
    run: int = 0  # number, unique for all blocks of a server

    @classmethod
    def of(cls, prepared: PreparedBlock, state: BlockState, waits: dict[str, Until], *, run: int = 0) -> "RunningBlock":
        """Create a block that has not begun."""
        return cls(prepared, state, prepared.request.zero, times_by_behaviour(prepared.plan.syncs), waits, run=run)

    @property
    def block(self) -> Block:
        """Block as requested."""
        return self.prepared.plan.timeline.block

    @cached_property
    def id(self) -> str:
        """Id of the block."""
        return self.block.id

    @property
    def sender(self) -> int:
        """Number of the client that requested the block."""
        return self.prepared.request.sender

    @cached_property
    def _span(self) -> tuple[float, float, float]:
        return block_span(self.times)

    @property
    def lead_in(self) -> float:
        """Duration [s] from the block's start to its time 0."""
        return -self._span[0]

    @property
    def relax(self) -> float:
        """Global time [s] at which the block relaxes."""
        return self.zero + self._span[1]

    @property
    def end(self) -> float:
        """Global time [s] at which the block ends."""
        return self.zero + self._span[2]

    @cached_property
    def points(self) -> dict[Point, float]:
        """Global times [s] of block time 0, sync points and block end.

        Block time 0 is the point `bml:start`.
        """
        sync_points = {
            Point(self.id, id, sync): self.zero + t for id, at in self.times.items() for sync, t in at.items()
        }
        return sync_points | {Point(self.id, "bml", "start"): self.zero, Point(self.id, "bml", "end"): self.end}

    @property
    def speeches(self) -> tuple[PlayingSpeech, ...]:
        """Speech of the block, without dropped behaviours."""
        return tuple(
            PlayingSpeech(self.id, behaviour.id, self.zero + self.times[behaviour.id]["start"], utterance)
            for behaviour in self.block.behaviours
            if isinstance(behaviour.action, Speech)
            and behaviour.id in self.times
            and (utterance := self.prepared.plan.utterances.get(behaviour.id)) is not None
        )

    @property
    def occupancy(self) -> tuple[Occupancy, ...]:
        """Occupancies of the block's behaviours, in global time [s]."""
        return () if self.merged is None else self.merged.occupancy

    def agenda(self) -> tuple[ScheduledFeedback, ...]:
        """Return progress feedback for all points of the block, sorted by time."""
        return schedule_feedback(
            self.id, self.times, self.zero, sender=self.sender, character=self.block.character, run=self.run
        )

    def prediction(self, now: float) -> ScheduledFeedback:
        """Return the block's predictionFeedback."""
        start, _, end = block_span(self.times)
        text = write_prediction(self.block, start, end, self.times, zero=self.zero)
        return ScheduledFeedback(now, text, self.sender)

    def warning(self, notice: Notice, now: float) -> ScheduledFeedback:
        """Return a warningFeedback for a notice."""
        return ScheduledFeedback(now, write_warning(notice, character=self.block.character), self.sender)

    def differs_from_prediction(self, tolerance: float) -> bool:
        """Return whether planned times differ from predicted ones beyond a tolerance [s]."""
        if self.predicted is None:
            return True
        zero, times = self.predicted
        if abs(zero - self.zero) > tolerance or times.keys() != self.times.keys():
            return True
        return any(
            abs(times[id].get(sync, np.inf) - time) > tolerance
            for id, sync_times in self.times.items()
            for sync, time in sync_times.items()
        )

    @property
    def final_notices(self) -> tuple[Notice, ...]:
        """Notices that no refined plan can change, to send at once."""
        plan = self.prepared.plan
        return plan.keyframes.notices if self.prepared.is_provisional else plan.notices

    def provisional_warnings(self, now: float) -> tuple[ScheduledFeedback, ...]:
        """Return warnings to send unless a refined plan arrives in time."""
        provisional = [notice for notice in self.prepared.plan.notices if notice not in self.final_notices]
        late = now + REFINEMENT_TIMEOUT
        return tuple(replace(self.warning(notice, late), unless_improved=self.id) for notice in provisional)

    def without(self, behaviours: frozenset[str]) -> "RunningBlock":
        """Return the block without some behaviours, but with its motion."""
        merged = self.merged
        if merged is not None:
            remaining = tuple(entry for entry in merged.occupancy if entry.behaviour not in behaviours)
            ended = behaviours & {entry.behaviour for entry in merged.occupancy}
            merged = replace(merged, occupancy=remaining, dropped=(*merged.dropped, *sorted(ended)))
        times = {id: sync_times for id, sync_times in self.times.items() if id not in behaviours}
        return replace(self, merged=merged, times=times)

    def since(self, time: float) -> "RunningBlock":
        """Return the block without its motion before a time [s]."""
        return self if self.merged is None else replace(self, merged=self.merged.since(time))


@dataclass(frozen=True)
class EndedBlock:
    """Ended block, to which later blocks may refer."""

    id: str
    state: BlockState
    points: Mapping[Point, float]  # global times [s]
