"""What server, loop and planner tell one another across processes; all of it is small or an array."""

from collections.abc import Mapping
from dataclasses import dataclass

from kinesic.body.arrays import Flags
from kinesic.motion.trajectory import Trajectory
from kinesic.realizer.realizer import ScheduledFeedback
from kinesic.serve.tracks import SoundAndFace, Track


@dataclass(frozen=True)
class DocumentRequest:
    """To the planner: to be performed."""

    text: bytes
    sender: int
    source: str  # how messages call it
    stops: int  # emergency stops so far; planned only if there is no further one


@dataclass(frozen=True)
class Interruption:
    """To the planner: ends a block, or all."""

    block: str | None


@dataclass(frozen=True)
class Restyling:
    """To the planner: another manner, for what plays and what comes."""

    style: str | None
    changes: tuple[str, ...]  # NAME=VALUE
    amount: float | None  # of movements
    block: str | None  # None: all, and those to come
    sender: int


@dataclass(frozen=True)
class Resumption:
    """To the planner: back to rest after a stop."""

    stops: int


Wanted = DocumentRequest | Interruption | Restyling | Resumption


@dataclass(frozen=True, eq=False)
class LoopStart:
    """Where a planner takes over."""

    motion: Trajectory
    stops: int  # emergency stops so far
    agenda: tuple[ScheduledFeedback, ...]  # what another planner left to be told
    senses: SoundAndFace  # what is wanted beside the motion


@dataclass(frozen=True, eq=False)
class Halted:
    """From the loop to the planner: an emergency stop."""

    stops: int  # so many so far
    time: float  # [s] of the clock
    motion: Trajectory


@dataclass(frozen=True)
class ProposalVerdict:
    """From the loop to the planner: whether it plays what was proposed."""

    taken: bool
    stops: int
    time: float  # [s] of the clock, until which commands are out


@dataclass(frozen=True)
class PlannerReady:
    """From the planner: it is ready."""


@dataclass(frozen=True)
class FeedbackNotice:
    """From the planner to a sender, at once."""

    message: str
    sender: int


@dataclass(frozen=True)
class RequestDone:
    """From the planner: what was wanted is done."""


@dataclass(frozen=True, eq=False)
class Proposal:
    """From the planner to the loop: what to play and what to tell from now on; answered by a Verdict."""

    stops: int  # that the planner knows of
    now: float  # [s] of the clock: what was due until then is in the agenda for the last time
    cut: float  # [s] of the clock, until which the motion is the one that plays
    motion: Trajectory | None  # on the clock; None: as it is
    agenda: tuple[ScheduledFeedback, ...]  # all that is still to be told
    owed: frozenset[int]  # senders whose blocks are not over
    moving: Mapping[tuple[str, str], Flags]  # (block, behaviour) -> (n,) hinges that it moves
    tracks: Mapping[str, Track | None]  # by block, those that have changed; None: of a block that is over


News = PlannerReady | FeedbackNotice | RequestDone | Proposal
