"""What server, loop and planner share across processes: the clock, and messages that are small or arrays."""

from collections.abc import Mapping
from ctypes import c_double
from dataclasses import dataclass
from multiprocessing.sharedctypes import RawValue
from time import monotonic
from typing import Literal

from msgspec import Struct

from kinesic.body.arrays import Flags, Floats
from kinesic.motion.trajectory import Trajectory
from kinesic.realizer.realizer import ScheduledFeedback
from kinesic.realizer.request import Message
from kinesic.serve.tracks import SoundAndFace, Track


class Clock:
    """Seconds since the server began, less the time that stood still.

    It is the machine's monotonic clock, less an offset that all processes share.
    """

    def __init__(self) -> None:
        """Begins at zero."""
        self._offset = RawValue(c_double, monotonic())

    def now(self) -> float:
        """Time [s]."""
        return monotonic() - float(self._offset.value)

    def at(self, clock: float) -> float:
        """Time [s] at one of the machine's monotonic clock [s]."""
        return clock - float(self._offset.value)

    def set(self, time: float) -> None:
        """Sets the present time [s]; only the loop does."""
        self._offset.value = monotonic() - time


ServoState = Literal[
    "limp",  # without torque, until somebody arms them
    "arming",  # torque comes
    "armed",  # they follow
    "releasing",  # they fold, lose their torque, and are opened anew
    "ended",  # nobody drives them: their supervisor has ended
]


class ServoReport(Struct, frozen=True):
    """How each servo is, in the order in which `servos` lists them; NaN for one that does not answer."""

    state: ServoState
    celsius: tuple[float, ...]  # (m,) [C]
    load: tuple[float, ...]  # (m,) of its current's limit; positive: its hinge's angle rises
    volts: tuple[float, ...]  # (m,) [V]
    errors: tuple[float, ...]  # (m,) bits of HARDWARE_ERROR_STATUS
    torque: tuple[float, ...]  # (m,) 1: it has torque


class ServoPlace(Struct, frozen=True):
    """Which servo it is, and what it turns."""

    bus: str
    id: int
    hinge: str
    model: str
    hottest: int  # [C] at which it shuts down


@dataclass(frozen=True, eq=False)
class ServoHealth:
    """How servos are at one moment."""

    angles: Floats  # (n,) [rad] measured, with torque or without; NaN for a servo that does not answer
    hottest: float  # [C] of all
    volts: float  # [V] the lowest of all
    faulty: bool  # whether one reports an error
    servos: ServoReport


class BodyReport(Struct, frozen=True):
    """How the robot is at one moment, for whoever watches."""

    time: float  # [s] of the clock
    angles: tuple[float, ...]  # [rad] measured, or planned where nothing is measured
    planned: tuple[float, ...]  # [rad] by the motion that plays
    hottest: float | None = None  # [C] of all servos
    volts: float | None = None  # [V] the lowest of all servos
    faulty: bool = False  # whether a servo reports an error
    servos: ServoReport | None = None  # where there are some

    @classmethod
    def of(cls, time: float, planned: Floats, measured: Floats | None, health: ServoHealth | None) -> "BodyReport":
        """Reports the body as it is measured, else as planned, and every servo.

        Args:
            time: [s] of the clock.
            planned: (n,) [rad] by the motion that plays.
            measured: (n,) [rad] by a sink that measures; None: nothing is measured, or not yet.
            health: of servos, which tell where they are also without torque; None: there are none.
        """
        aim = _rounded(planned)
        angles = aim if measured is None else _rounded(measured)
        if health is None:
            return cls(round(time, 3), angles, aim)
        if health.angles.size:
            angles = _rounded(health.angles)
        return cls(round(time, 3), angles, aim, health.hottest, health.volts, health.faulty, health.servos)


def _rounded(angles: Floats) -> tuple[float, ...]:
    """Angles [rad] as clients read them; NaN, of a servo that does not answer, stays."""
    return tuple(angles.round(4).tolist())


@dataclass(frozen=True)
class Words(Message):
    """Words that a client wants said, with what they mean; more may follow."""

    ends: bool = False  # whether no more follow
    instead: bool = False  # whether they take the place of all that is not said yet


@dataclass(frozen=True)
class DocumentRequest:
    """To the planner: perform a document, or say words."""

    message: Message
    stops: int  # emergency stops so far; planned only if there is no further one


@dataclass(frozen=True)
class Interruption:
    """To the planner: end a block, or all."""

    block: str | None


@dataclass(frozen=True)
class Restyling:
    """To the planner: change the style of what plays and what comes."""

    style: str | None
    changes: tuple[str, ...]  # NAME=VALUE
    amount: float | None  # of movements
    block: str | None  # None: all, and those to come
    sender: int


@dataclass(frozen=True)
class Resumption:
    """To the planner: return to rest after an emergency stop."""

    stops: int


@dataclass(frozen=True)
class Renewal:
    """To the planner: read anew which gestures are known."""


ClientRequest = DocumentRequest | Interruption | Restyling | Resumption | Renewal


@dataclass(frozen=True, eq=False)
class LoopStart:
    """The state of the loop from which a planner takes over."""

    motion: Trajectory
    stops: int  # emergency stops so far
    agenda: tuple[ScheduledFeedback, ...]  # what another planner left to be sent
    runs: int = 0  # number of the last running block in it


@dataclass(frozen=True, eq=False)
class LoopProperties:
    """What stays the same of the loop as long as it runs."""

    clock: Clock
    accompaniment: SoundAndFace  # what is performed beside the motion


@dataclass(frozen=True, eq=False)
class Halted:
    """From the loop to the planner: an emergency stop was made."""

    stops: int  # emergency stops so far
    time: float  # [s] of the clock
    motion: Trajectory


@dataclass(frozen=True)
class ProposalVerdict:
    """From the loop to the planner: whether it accepts a proposal."""

    accepted: bool
    stops: int
    time: float  # [s] of the clock, until which commands are out


@dataclass(frozen=True)
class PlannerReady:
    """From the planner: it is ready."""


@dataclass(frozen=True)
class FeedbackNotice:
    """From the planner: send a message at once."""

    message: str
    sender: int


@dataclass(frozen=True)
class RequestDone:
    """From the planner: the last request is done."""


@dataclass(frozen=True, eq=False)
class Proposal:
    """From the planner to the loop: what to play and to send from now on; answered by a `ProposalVerdict`."""

    stops: int  # that the planner knows of
    now: float  # [s] of the clock
    cut: float  # [s] of the clock, until which motion and feedback are those that play
    motion: Trajectory | None  # on the clock; None: as it is
    said: tuple[ScheduledFeedback, ...]  # final messages, in no later proposal
    agenda: tuple[ScheduledFeedback, ...]  # messages that the next proposal has again, changes or withdraws
    owed: frozenset[int]  # senders whose blocks are not over
    moving: Mapping[tuple[str, str], Flags]  # (block, behaviour) -> (n,) hinges that it moves
    tracks: Mapping[str, Track | None]  # by block, those that have changed; None: of a block that is over
    idles: bool = False  # whether the motion is nothing but idle motion


News = PlannerReady | FeedbackNotice | RequestDone | Proposal
