"""What is laid over what: a running motion, a block's own, and what each of them needs when."""

from collections.abc import Sequence
from dataclasses import dataclass

from kinesic.body.arrays import Floats
from kinesic.realizer.busy import ARMS, Busy


@dataclass(frozen=True)
class Failed:
    """A behaviour that has no way within the limits."""

    behaviour: str
    why: str


@dataclass(frozen=True, eq=False)
class Work:
    """What is laid over what: both from the same time on."""

    base: Floats  # (k + 3, n) [rad] control points of what runs
    coming: Floats  # (k + 3, n) [rad] of the block's own motion
    cut: int  # knot until which nothing may change
    held: Sequence[Busy]  # of what runs, what has not given way at the cut
    performed: Sequence[Busy]  # behaviours of the block
    dropped: Sequence[Busy]  # behaviours of the block that are left out

    def blamed(self, why: str) -> Failed:
        """The last behaviour of the block that moves the trunk fails; none where it performs none."""
        performed = sorted(self.performed, key=lambda each: not each.roles <= set(ARMS))
        return Failed(performed[-1].behaviour if performed else "", why)
