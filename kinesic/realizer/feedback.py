"""Schedules the feedback of blocks that play: which message is sent when."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf
from operator import attrgetter

from kinesic.bml.composition import BlockState
from kinesic.bml.feedback import block_progress, sync_point_progress
from kinesic.bml.timing.constraints import Point
from kinesic.planning.syncs import SyncTime

BLOCK_START: tuple[str | None, str] = (None, "start")
BLOCK_END: tuple[str | None, str] = (None, "end")
Times = Mapping[str, Mapping[str, float]]  # behaviour -> sync point -> [s] block time, each behaviour's in their order


@dataclass(frozen=True)
class Progress:
    """A point that a block passes, as block progress or sync point progress is sent of it."""

    block: str
    behaviour: str | None  # None: the block itself
    point: str
    time: float  # [s] block time
    character: str | None = None
    state: BlockState | None = None  # of a block that ended before its time
    run: int = 0  # number of the running block; another block of the same id has another one

    @property
    def key(self) -> tuple[str | None, str]:
        """Behaviour and point: unique in a block."""
        return self.behaviour, self.point

    def interrupted(self, time: float) -> "Progress":
        """Return the point as interrupted at a block time [s]."""
        return replace(self, time=time, state=BlockState.INTERRUPTED)


FeedbackKey = tuple[int, str | None, str] | tuple[float, str, int]


@dataclass(frozen=True)
class ScheduledFeedback:
    """A message for the sender of a block."""

    time: float  # [s] global
    content: Progress | str  # a point, or a message that is written already
    sender: int = 0
    measured: float | None = None  # [s] global time at which the point was seen to be passed
    unless_improved: str | None = None  # id of a block: not sent when that one gets a better plan

    @cached_property
    def xml(self) -> str:
        """The message as XML."""
        point = self.content
        if isinstance(point, str):
            return point
        state = point.state.value if point.state else None
        if point.behaviour is None:
            return block_progress(
                point.block, point.point, self.time, character=point.character, state=state, measured=self.measured
            )
        passed = Point(point.block, point.behaviour, point.point)
        return sync_point_progress(passed, point.time, self.time, character=point.character, measured=self.measured)

    def measured_at(self, time: float) -> "ScheduledFeedback":
        """Adds the global time [s] at which servos or twin were there."""
        return replace(self, measured=time)

    @property
    def block(self) -> str | None:
        """Id of the block that passes a point."""
        return None if isinstance(self.content, str) else self.content.block

    @cached_property
    def key(self) -> FeedbackKey:
        """Identity of the message, independent of the time of its point."""
        if isinstance(self.content, str):
            return self.time, self.content, self.sender
        return self.content.run, *self.content.key

    def belongs_to(self, run: int) -> bool:
        """Whether a running block passes the point."""
        return isinstance(self.content, Progress) and self.content.run == run

    @property
    def is_block_start(self) -> bool:
        """Whether a block passes its start."""
        return isinstance(self.content, Progress) and self.content.key == BLOCK_START

    @property
    def is_block_end(self) -> bool:
        """Whether a block passes its end."""
        return isinstance(self.content, Progress) and self.content.key == BLOCK_END

    def interrupted_at(self, time: float) -> "ScheduledFeedback":
        """Return the message as interrupted at a global time [s]."""
        if isinstance(self.content, str):
            raise TypeError("a written message cannot be interrupted")
        return replace(self, time=time, content=self.content.interrupted(self.content.time + time - self.time))


def span(times: Times) -> tuple[float, float, float]:
    """Finds start, subsiding and end of a block, block time [s]: the start is no later than 0, the end no earlier."""
    points = [time for own in times.values() for time in own.values()]
    relaxed = [own.get("relax", max(own.values())) for own in times.values() if own]
    return min([0.0, *points]), max([0.0, *relaxed]), max([0.0, *points])


def agenda(
    block: str, times: Times, zero: float, *, sender: int, character: str | None = None, run: int = 0
) -> tuple[ScheduledFeedback, ...]:
    """Schedules feedback of all points of a block, in order.

    Args:
        block: its id.
        times: of its sync points.
        zero: [s] global time of its time 0.
        sender: who gets it.
        character: that performs.
        run: number of the running block.
    """
    start, relax, end = span(times)

    def progress(behaviour: str | None, point: str, time: float) -> ScheduledFeedback:
        return ScheduledFeedback(zero + time, Progress(block, behaviour, point, time, character, run=run), sender)

    points = [progress(behaviour, sync, time) for behaviour, at in times.items() for sync, time in _forward(at)]
    subsides = progress(None, "relax", relax)
    inner = sorted([*points, subsides], key=attrgetter("time"))
    return progress(None, "start", start), *inner, progress(None, "end", end)


def _forward(at: Mapping[str, float]) -> Iterator[tuple[str, float]]:
    """Sync points of a behaviour in their order, none before its predecessor."""
    latest = -inf
    for sync, time in at.items():
        latest = max(latest, time)
        yield sync, latest


def order_feedback(*agendas: Sequence[ScheduledFeedback]) -> tuple[ScheduledFeedback, ...]:
    """Joins agendas into one in order of time; messages of the same time keep their order."""
    return tuple(sorted((message for each in agendas for message in each), key=attrgetter("time")))


def without(
    agenda: Sequence[ScheduledFeedback], run: int, behaviours: frozenset[str] | None = None, *, after: float = -inf
) -> tuple[ScheduledFeedback, ...]:
    """Withdraw points of a running block from an agenda.

    Args:
        agenda: in order of time.
        run: number of the running block.
        behaviours: whose points are withdrawn; None: all points, those of the block too.
        after: [s] global time until which points are passed in any case.
    """

    def is_withdrawn(message: ScheduledFeedback) -> bool:
        point = message.content
        if isinstance(point, str) or point.run != run or message.time <= after:
            return False
        return behaviours is None or point.behaviour in behaviours

    return tuple(message for message in agenda if not is_withdrawn(message))


def without_provisional(agenda: Sequence[ScheduledFeedback], block: str) -> tuple[ScheduledFeedback, ...]:
    """Removes from an agenda the messages that are due only if a block gets no better plan."""
    return tuple(message for message in agenda if message.unless_improved != block)


def retime_feedback(
    agenda: Sequence[ScheduledFeedback], run: int, fresh: Sequence[ScheduledFeedback], change: float
) -> tuple[ScheduledFeedback, ...]:
    """Give the points of a running block new times in an agenda.

    Args:
        agenda: in order of time.
        run: number of the running block.
        fresh: all its points, with new times.
        change: [s] global time of the earliest change: points until then stay as they are, others come no earlier.
    """
    kept = without(agenda, run, after=change)
    pending = {message.key for message in agenda} - {message.key for message in kept}
    retimed = [replace(message, time=max(message.time, change)) for message in fresh if message.key in pending]
    return order_feedback(kept, retimed)


def times_of(syncs: tuple[SyncTime, ...]) -> dict[str, dict[str, float]]:
    """Sorts sync points by behaviour, each behaviour's in their order."""
    times: dict[str, dict[str, float]] = {}
    for sync in syncs:
        times.setdefault(sync.behaviour, {})[sync.sync] = sync.planned
    return times
