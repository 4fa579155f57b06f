"""Schedules the feedback of blocks that play: which message is sent when."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import attrgetter

from kinesic.bml.composition import BlockState
from kinesic.bml.feedback import block_progress, sync_point_progress
from kinesic.bml.timing.constraints import Point
from kinesic.planning.syncs import SyncTime

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

    @property
    def key(self) -> tuple[str | None, str]:
        """Behaviour and point: unique in a block."""
        return self.behaviour, self.point


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


def span(times: Times) -> tuple[float, float, float]:
    """Finds start, subsiding and end of a block, block time [s]: the start is no later than 0, the end no earlier."""
    points = [time for own in times.values() for time in own.values()]
    relaxed = [own.get("relax", max(own.values())) for own in times.values() if own]
    return min([0.0, *points]), max([0.0, *relaxed]), max([0.0, *points])


def agenda(
    block: str, times: Times, zero: float, *, sender: int, character: str | None = None
) -> tuple[ScheduledFeedback, ...]:
    """Schedules feedback of all points of a block, in order.

    Args:
        block: its id.
        times: of its sync points.
        zero: [s] global time of its time 0.
        sender: who gets it.
        character: that performs.
    """
    start, relax, end = span(times)

    def progress(behaviour: str | None, point: str, time: float) -> ScheduledFeedback:
        return ScheduledFeedback(zero + time, Progress(block, behaviour, point, time, character), sender)

    points = [progress(behaviour, sync, time) for behaviour, at in times.items() for sync, time in _forward(at)]
    subsides = progress(None, "relax", relax)
    inner = sorted([*points, subsides], key=attrgetter("time"))
    return progress(None, "start", start), *inner, progress(None, "end", end)


def _forward(at: Mapping[str, float]) -> Iterator[tuple[str, float]]:
    """Sync points of a behaviour in their order, none before its predecessor."""
    latest = -float("inf")
    for sync, time in at.items():
        latest = max(latest, time)
        yield sync, latest


def order_feedback(*agendas: Sequence[ScheduledFeedback]) -> tuple[ScheduledFeedback, ...]:
    """Joins agendas into one in order of time; messages of the same time keep their order."""
    return tuple(sorted((message for each in agendas for message in each), key=attrgetter("time")))


def without(
    agenda: Sequence[ScheduledFeedback], block: str, behaviours: frozenset[str] | None = None
) -> tuple[ScheduledFeedback, ...]:
    """Takes the points of a block out of an agenda, or those of some of its behaviours."""

    def is_dropped(point: Progress | str) -> bool:
        if isinstance(point, str) or point.block != block:
            return False
        return behaviours is None or point.behaviour in behaviours

    return tuple(message for message in agenda if not is_dropped(message.content))


def without_provisional(agenda: Sequence[ScheduledFeedback], block: str) -> tuple[ScheduledFeedback, ...]:
    """Removes from an agenda the messages that are due only if a block gets no better plan."""
    return tuple(message for message in agenda if message.unless_improved != block)


def retime_feedback(
    agenda: Sequence[ScheduledFeedback], block: str, fresh: Sequence[ScheduledFeedback], now: float
) -> tuple[ScheduledFeedback, ...]:
    """Gives the points of a block new times in an agenda: those that were sent stay out, past ones are due now."""
    points = [message.content for message in agenda if isinstance(message.content, Progress)]
    pending = {point.key for point in points if point.block == block}
    retimed = [
        replace(message, time=max(message.time, now))
        for message in fresh
        if isinstance(message.content, Progress) and message.content.key in pending
    ]
    return order_feedback(without(agenda, block), retimed)


def times_of(syncs: tuple[SyncTime, ...]) -> dict[str, dict[str, float]]:
    """Sorts sync points by behaviour, each behaviour's in their order."""
    times: dict[str, dict[str, float]] = {}
    for sync in syncs:
        times.setdefault(sync.behaviour, {})[sync.sync] = sync.planned
    return times
