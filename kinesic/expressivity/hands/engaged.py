"""Hands that other blocks need, as a block finds them that begins beside those."""

from collections.abc import Mapping
from dataclasses import dataclass

from kinesic.body.robot import Side


@dataclass(frozen=True)
class Engaged:
    """A hand that another block needs for a while."""

    side: Side
    begin: float  # [s] block time from which the hand must be there
    end: float  # [s] block time at which it gives way
    by: str  # the behaviour that needs it, as the sender may know it

    def meets(self, times: Mapping[str, float], way: float) -> bool:
        """Whether a gesture needs the hand as well, or leaves it no time to come from one to the other.

        Args:
            times: sync points of the gesture [s], which needs the hand from `ready` to `relax`.
            way: [s] that the hand is on its way.
        """
        return times["ready"] < self.end + way and self.begin < times["relax"] + way
