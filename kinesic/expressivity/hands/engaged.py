"""What keeps a hand from a stroke beside strokes that overlap: other blocks, and strokes too near for the way."""

from collections.abc import Mapping
from dataclasses import dataclass

from kinesic.body.robot import Side


@dataclass(frozen=True)
class Clash:
    """Two strokes that are too near for the hand that does both, though they do not overlap."""

    late: float  # [s] by which the hand comes too late from one to the other
    brief: bool = False  # whether each of them was but one key: then neither can be made briefer


Clashes = Mapping[frozenset[str], Clash]  # of two behaviours


@dataclass(frozen=True)
class Engaged:
    """A hand that another block needs for a while."""

    side: Side
    begin: float  # [s] block time from which the hand must be there
    end: float  # [s] block time at which it gives way
    by: str  # the behaviour that needs it, as the sender may know it

    def meets(self, times: Mapping[str, float], way: float) -> bool:
        """Checks whether a gesture overlaps with this use of the hand, or leaves no time to move between both.

        Args:
            times: sync points of the gesture [s], which needs the hand from `ready` to `relax`.
            way: [s] that the hand is on its way.
        """
        return times["ready"] < self.end + way and self.begin < times["relax"] + way
