"""Scheduled feedback of running blocks."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf
from operator import attrgetter

from kinesic.bml.composition import BlockState
from kinesic.bml.feedback import write_block_progress, write_sync_point_progress
from kinesic.bml.timing.constraints import Point
from kinesic.planning.syncs import SyncTime

BLOCK_START: tuple[str | None, str] = (None, "start")  # behaviour (none) and sync point of a block's start
BLOCK_END: tuple[str | None, str] = (None, "end")  # behaviour (none) and sync point of a block's end
Times = Mapping[str, Mapping[str, float]]  # behaviour -> sync point -> block time [s], in order


@dataclass(frozen=True)
class Progress:
    """Progress report: a passed sync point or block point, with its time."""

    block: str
    behaviour: str | None  # None for the block itself
    point: str
    time: float  # [s] block time
    character: str | None = None
    state: BlockState | None = None  # final state of an interrupted block, otherwise None
    run: int = 0  # number of the running block, unique even for equal ids

    @property
    def key(self) -> tuple[str | None, str]:
        """Behaviour and point name, unique within a block."""
        return self.behaviour, self.point

    def interrupted(self, time: float) -> "Progress":
        """Return a copy of the report, interrupted at a block time [s]."""
        return replace(self, time=time, state=BlockState.INTERRUPTED)


FeedbackKey = tuple[int, str | None, str] | tuple[float, str, int]


@dataclass(frozen=True)
class ScheduledFeedback:
    """Feedback message with its send time and the client to receive it."""

    time: float  # [s] global send time
    content: Progress | str  # progress, or a complete message
    sender: int = 0  # number of the client that sent the block and receives the message
    measured: float | None = None  # [s] global time at which the robot was measured to reach the sync point
    unless_improved: str | None = None  # block id; the message is dropped when this block gets a refined plan

    @cached_property
    def xml(self) -> str:
        """Message as XML."""
        point = self.content
        if isinstance(point, str):
            return point
        state = point.state.value if point.state else None
        if point.behaviour is None:
            return write_block_progress(
                point.block, point.point, self.time, character=point.character, state=state, measured=self.measured
            )
        passed = Point(point.block, point.behaviour, point.point)
        return write_sync_point_progress(
            passed, point.time, self.time, character=point.character, measured=self.measured
        )

    def measured_at(self, time: float) -> "ScheduledFeedback":
        """Return a copy with the measured time [s] of the sync point."""
        return replace(self, measured=time)

    @property
    def block(self) -> str | None:
        """Id of the block for progress messages, or None."""
        return None if isinstance(self.content, str) else self.content.block

    @cached_property
    def key(self) -> FeedbackKey:
        """Identity of the message, for progress messages independent of their time."""
        if isinstance(self.content, str):
            return self.time, self.content, self.sender
        return self.content.run, *self.content.key

    def belongs_to(self, run: int) -> bool:
        """Return whether the message reports progress of a given running block."""
        return isinstance(self.content, Progress) and self.content.run == run

    @property
    def is_block_start(self) -> bool:
        """Whether the message reports a block start."""
        return isinstance(self.content, Progress) and self.content.key == BLOCK_START

    @property
    def is_block_end(self) -> bool:
        """Whether the message reports a block end."""
        return isinstance(self.content, Progress) and self.content.key == BLOCK_END

    def interrupted_at(self, time: float) -> "ScheduledFeedback":
        """Return a copy that reports the block's interruption at a time [s]."""
        if isinstance(self.content, str):
            raise TypeError("a written message cannot be interrupted")
        return replace(self, time=time, content=self.content.interrupted(self.content.time + time - self.time))


def block_span(times: Times) -> tuple[float, float, float]:
    """Return start, relax and end of a block in block time [s].

    The start is at most 0 and the end at least 0.
    """
    points = [time for sync_times in times.values() for time in sync_times.values()]
    relaxed = [sync_times.get("relax", max(sync_times.values())) for sync_times in times.values() if sync_times]
    return min([0.0, *points]), max([0.0, *relaxed]), max([0.0, *points])


def schedule_feedback(
    block: str, times: Times, zero: float, *, sender: int, character: str | None = None, run: int = 0
) -> tuple[ScheduledFeedback, ...]:
    """Return the progress feedback of a block's points, sorted by time.

    Args:
        block: id of the block.
        times: times of its sync points.
        zero: global time [s] of block time 0.
        sender: number of the client that receives the feedback.
        character: character that performs.
        run: number of the running block.
    """
    start, relax, end = block_span(times)

    def progress(behaviour: str | None, point: str, time: float) -> ScheduledFeedback:
        return ScheduledFeedback(zero + time, Progress(block, behaviour, point, time, character, run=run), sender)

    points = [progress(behaviour, sync, time) for behaviour, at in times.items() for sync, time in _monotonic(at)]
    subsides = progress(None, "relax", relax)
    inner = sorted([*points, subsides], key=attrgetter("time"))
    return progress(None, "start", start), *inner, progress(None, "end", end)


def _monotonic(at: Mapping[str, float]) -> Iterator[tuple[str, float]]:
    """Yield the sync points of a behaviour with non-decreasing times."""
    latest = -inf
    for sync, time in at.items():
        latest = max(latest, time)
        yield sync, latest


def order_feedback(*agendas: Sequence[ScheduledFeedback]) -> tuple[ScheduledFeedback, ...]:
    """Merge lists of scheduled feedback by time.

    Messages at equal times keep their order.
    """
    return tuple(sorted((message for agenda in agendas for message in agenda), key=attrgetter("time")))


def withdraw_feedback(
    agenda: Sequence[ScheduledFeedback], run: int, behaviours: frozenset[str] | None = None, *, after: float = -inf
) -> tuple[ScheduledFeedback, ...]:
    """Remove a running block's progress messages from scheduled feedback.

    Args:
        agenda: messages sorted by time.
        run: number of the running block.
        behaviours: behaviours whose points are removed; None removes all points of the block.
        after: global time [s] up to which points are kept.
    """

    def is_withdrawn(message: ScheduledFeedback) -> bool:
        point = message.content
        if isinstance(point, str) or point.run != run or message.time <= after:
            return False
        return behaviours is None or point.behaviour in behaviours

    return tuple(message for message in agenda if not is_withdrawn(message))


def withdraw_provisional(agenda: Sequence[ScheduledFeedback], block: str) -> tuple[ScheduledFeedback, ...]:
    """Remove a block's provisional warnings from scheduled feedback."""
    return tuple(message for message in agenda if message.unless_improved != block)


def retime_feedback(
    agenda: Sequence[ScheduledFeedback], run: int, fresh: Sequence[ScheduledFeedback], change: float
) -> tuple[ScheduledFeedback, ...]:
    """Move a running block's pending progress messages to new times.

    Args:
        agenda: messages sorted by time.
        run: number of the running block.
        fresh: all points of the block with new times.
        change: global time [s] of the earliest change; earlier points stay, others move to this time at the earliest.
    """
    kept = withdraw_feedback(agenda, run, after=change)
    pending = {message.key for message in agenda} - {message.key for message in kept}
    retimed = [replace(message, time=max(message.time, change)) for message in fresh if message.key in pending]
    return order_feedback(kept, retimed)


def times_by_behaviour(syncs: tuple[SyncTime, ...]) -> dict[str, dict[str, float]]:
    """Group planned sync point times [s] by behaviour, keeping their order."""
    times: dict[str, dict[str, float]] = {}
    for sync in syncs:
        times.setdefault(sync.behaviour, {})[sync.sync] = sync.planned
    return times
