"""What will be told, and when: the feedback of blocks that play, in time."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from kinesic.bml.composition import BlockState
from kinesic.bml.feedback import block_progress, sync_point_progress
from kinesic.bml.timing.constraints import Point
from kinesic.planning.syncs import SyncTime

Times = Mapping[str, Mapping[str, float]]  # behaviour -> sync point -> [s] block time, each behaviour's in their order


@dataclass(frozen=True)
class Progress:
    """A point that a block passes."""

    block: str
    behaviour: str | None  # None: the block itself
    point: str
    time: float  # [s] block time
    character: str | None = None
    state: BlockState | None = None  # of a block that ended before its time

    @property
    def key(self) -> tuple[str | None, str]:
        """What tells it from all others of its block."""
        return self.behaviour, self.point


@dataclass(frozen=True)
class ScheduledFeedback:
    """A message for the sender of a block."""

    time: float  # [s] global
    told: Progress | str  # a point, or a message that is written already
    sender: int = 0
    measured: float | None = None  # [s] global time at which the point was seen to be passed
    unless_improved: str | None = None  # id of a block: it is not told when that one gets a better plan

    @cached_property
    def xml(self) -> str:
        """The message."""
        point = self.told
        if isinstance(point, str):
            return point
        state = point.state.value if point.state else None
        if point.behaviour is None:
            return block_progress(
                point.block, point.point, self.time, character=point.character, state=state, measured=self.measured
            )
        passed = Point(point.block, point.behaviour, point.point)
        return sync_point_progress(passed, point.time, self.time, character=point.character, measured=self.measured)

    def seen(self, time: float) -> "ScheduledFeedback":
        """The same with the global time [s] at which servos or twin were there."""
        return replace(self, measured=time)

    @property
    def block(self) -> str | None:
        """Id of the block that passes a point."""
        return None if isinstance(self.told, str) else self.told.block


def span(times: Times) -> tuple[float, float, float]:
    """Start, subsiding and end of a block, block time [s]: the start is no later than 0, the end no earlier."""
    points = [time for own in times.values() for time in own.values()]
    relaxed = [own.get("relax", max(own.values())) for own in times.values() if own]
    return min([0.0, *points]), max([0.0, *relaxed]), max([0.0, *points])


def agenda(
    block: str, times: Times, zero: float, *, sender: int, character: str | None = None
) -> tuple[ScheduledFeedback, ...]:
    """Everything that a block will tell, in order.

    Args:
        block: its id.
        times: of its sync points.
        zero: [s] global time of its time 0.
        sender: who is told.
        character: that performs.
    """
    start, relax, end = span(times)

    def due(behaviour: str | None, point: str, time: float) -> ScheduledFeedback:
        return ScheduledFeedback(zero + time, Progress(block, behaviour, point, time, character), sender)

    points = [due(behaviour, sync, time) for behaviour, own in times.items() for sync, time in _forward(own)]
    subsides = due(None, "relax", relax)
    inner = sorted([*points, subsides], key=lambda one: one.time)
    return due(None, "start", start), *inner, due(None, "end", end)


def _forward(own: Mapping[str, float]) -> Iterator[tuple[str, float]]:
    """Sync points of a behaviour in their order, none before its predecessor."""
    latest = -float("inf")
    for sync, time in own.items():
        latest = max(latest, time)
        yield sync, latest


def order_feedback(*agendas: Sequence[ScheduledFeedback]) -> tuple[ScheduledFeedback, ...]:
    """Several agendas as one; what is told at the same time keeps its order."""
    return tuple(sorted((due for each in agendas for due in each), key=lambda due: due.time))


def without(
    dues: Sequence[ScheduledFeedback], block: str, behaviours: frozenset[str] | None = None
) -> tuple[ScheduledFeedback, ...]:
    """The agenda without a block, or without some of its behaviours."""

    def goes(due: ScheduledFeedback) -> bool:
        told = due.told
        return (
            isinstance(told, Progress) and told.block == block and (behaviours is None or told.behaviour in behaviours)
        )

    return tuple(due for due in dues if not goes(due))


def retime_feedback(
    dues: Sequence[ScheduledFeedback], block: str, fresh: Sequence[ScheduledFeedback], now: float
) -> tuple[ScheduledFeedback, ...]:
    """The agenda with new times of a block: what was told is not told again, what is past is told at once."""
    left = {due.told.key for due in dues if isinstance(due.told, Progress) and due.told.block == block}
    again = [
        replace(due, time=max(due.time, now))
        for due in fresh
        if isinstance(due.told, Progress) and due.told.key in left
    ]
    return order_feedback(without(dues, block), again)


def times_of(syncs: tuple[SyncTime, ...]) -> dict[str, dict[str, float]]:
    """Sync points by behaviour, each behaviour's in their order."""
    times: dict[str, dict[str, float]] = {}
    for sync in syncs:
        times.setdefault(sync.behaviour, {})[sync.sync] = sync.planned
    return times
