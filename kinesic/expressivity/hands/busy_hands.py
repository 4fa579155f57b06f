"""Hands used by other blocks, and strokes too close in time."""

from collections.abc import Mapping
from dataclasses import dataclass

from kinesic.body.robot import Side


@dataclass(frozen=True)
class Clash:
    """Timing conflict of two strokes of one hand, with the resulting delay."""

    delay: float  # [s] delay of the second stroke after the hand has moved from the first stroke
    brief: bool = False  # whether both strokes are single keys already, and cannot be shortened further


Clashes = Mapping[frozenset[str], Clash]  # by the ids of two behaviours


@dataclass(frozen=True)
class BusyHand:
    """A hand that another block needs for a time span."""

    side: Side
    begin: float  # [s] block time at which the hand must be in place
    end: float  # [s] block time at which the hand is free again
    by: str  # name in messages of the behaviour that needs the hand

    def meets(self, times: Mapping[str, float], travel_time: float) -> bool:
        """Return whether a gesture needs this hand while it is busy.

        Args:
            times: sync points of the gesture [s], which needs the hand from `ready` to `relax`.
            travel_time: of the hand [s].
        """
        return times["ready"] < self.end + travel_time and self.begin < times["relax"] + travel_time
