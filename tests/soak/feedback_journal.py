"""Feedback of one client, with checks of order, time and repetition."""

import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from math import inf

CLOCK_RESOLUTION = 0.002  # [s] rounding of `time` in a status, plus one control period
PROGRESS = re.compile(
    r"<(?:blockProgress|syncPointProgress)\b[^>]*? id=\"([^\":]+):([^\"]+)\"[^>]*? globalTime=\"([^\"]+)\""
)
REFUSED = re.compile(r"<warningFeedback\b[^>]*? id=\"([^\":]+)\"[^>]*>(?:rule |revoked|not performed|a block of this)")


@dataclass(frozen=True)
class Arrival:
    """Sync point of a block, with the time [s] at which a client was informed."""

    block: str
    point: str  # sync point of the block, or `behaviour:point`
    time: float  # [s] time of the server's clock in the message
    received: float  # [s] time of the machine's monotonic clock at the arrival of the message
    earliest: float  # [s] earliest time of the monotonic clock at which the server's clock can have reached `time`


@dataclass
class FeedbackJournal:
    """All feedback of one client, with checks of its order and times."""

    arrivals: list[Arrival] = field(default_factory=list)
    sent: list[str] = field(default_factory=list)  # ids of the sent blocks
    refused: set[str] = field(default_factory=set)
    lost_messages: int = 0  # number of messages that the server dropped, because they were not read in time
    _offset: float = -inf  # [s] lower bound of the difference from the server's clock to the machine's clock

    def synchronize(self, asked: float, time: float) -> None:
        """Record the server time [s] that was requested at a machine time [s]."""
        self._offset = max(self._offset, asked - time)

    def hear(self, message: str, received: float) -> None:
        """Record a message and its arrival time [s]."""
        if (result := PROGRESS.search(message)) is not None:
            block, point, time = result[1], result[2], float(result[3])
            self.arrivals.append(Arrival(block, point, time, received, time + self._offset))
        elif (refused := REFUSED.search(message)) is not None:
            self.refused.add(refused[1])
            self.lost_messages += "rule unread" in message

    def faults(self) -> Iterator[str]:
        """Yield all violations of the feedback rules."""
        blocks = defaultdict[str, list[Arrival]](list)
        for arrival in self.arrivals:
            blocks[arrival.block].append(arrival)
        for block in self.sent:
            if block not in blocks and block not in self.refused:
                yield f"{block}: lost, neither begun nor refused"
        for block, arrivals in blocks.items():
            yield from (f"{block}: {fault}" for fault in _faults(arrivals))


def _faults(arrivals: list[Arrival]) -> Iterator[str]:
    """Yield violations of the feedback rules for one block."""
    points = [arrival.point for arrival in arrivals]
    for point in dict.fromkeys(points):
        if (times := points.count(point)) > 1:
            yield f"duplicate {point}, {times} times"
    if points[0] != "start":
        yield f"disorder: begins with {points[0]}"
    if "end" not in points:
        yield "has no end"
    elif points[-1] != "end":
        yield f"disorder: {points[-1]} after its end"
    for before, after in pairwise(arrivals):
        if after.time < before.time:
            yield f"disorder: {after.point} at {after.time:.6f} s behind {before.point} at {before.time:.6f} s"
    for each in arrivals:
        if each.received < each.earliest - CLOCK_RESOLUTION:
            yield f"early {each.point}, by {each.earliest - each.received:.4f} s"
