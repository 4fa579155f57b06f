"""Shared clock and messages between server, loop and planner."""

from collections.abc import Mapping
from ctypes import c_double
from dataclasses import dataclass
from multiprocessing.sharedctypes import RawValue
from time import monotonic
from typing import Literal

from msgspec import Struct

from kinesic.body.arrays import Flags, Floats
from kinesic.conversation.events import ConversationEvent, SoundEvent
from kinesic.motion.trajectory import Trajectory
from kinesic.realizer.realizer import ScheduledFeedback
from kinesic.realizer.request import Message
from kinesic.serve.tracks import SoundAndFace, Track


class Clock:
    """Clock of the server, shared between processes.

    Its time is the machine's monotonic clock minus a shared offset: seconds since the server started, without
    suspensions.
    """

    def __init__(self) -> None:
        """Create a clock that starts at zero."""
        self._offset = RawValue(c_double, monotonic())

    def now(self) -> float:
        """Return the current time [s]."""
        return monotonic() - float(self._offset.value)

    def set(self, time: float) -> None:
        """Set the current time [s].

        Only the loop may call this.
        """
        self._offset.value = monotonic() - time


ServoState = Literal[
    "limp",  # torque off until a client arms them
    "arming",  # torque is being enabled
    "armed",  # following commands
    "releasing",  # folding, then torque off and reopening
    "ended",  # the supervisor process has ended
]


class ServoReport(Struct, frozen=True):
    """Telemetry of all servos, in the order of the `servos` answer.

    Values are NaN for a servo that does not answer.
    """

    state: ServoState  # state of the torque
    celsius: tuple[float, ...]  # (m,) [C] temperature of each servo
    load: tuple[float, ...]  # (m,) fraction of the current limit; positive in the direction of a growing angle
    volts: tuple[float, ...]  # (m,) [V] supply voltage of each servo
    errors: tuple[float, ...]  # (m,) bits of HARDWARE_ERROR_STATUS
    torque: tuple[float, ...]  # (m,) 1 if the torque is on


class ServoPlace(Struct, frozen=True):
    """Identity of a servo and the hinge that it drives."""

    bus: str  # name of the bus
    id: int  # id on the bus
    hinge: str  # name of the hinge that the servo drives
    model: str  # servo model
    hottest: int  # [C] shutdown temperature


@dataclass(frozen=True, eq=False)
class ServoHealth:
    """Telemetry of all servos at one time."""

    angles: Floats  # (n,) [rad] measured, with torque on or off; NaN for a servo that does not answer
    hottest: float  # [C] highest temperature of all servos
    volts: float  # [V] lowest supply voltage of all servos
    faulty: bool  # whether a servo reports an error
    servos: ServoReport


class BodyReport(Struct, frozen=True):
    """State of the robot at one time, for subscribed clients."""

    time: float  # [s] clock time
    angles: tuple[float, ...]  # [rad] measured, or planned without a measurement
    planned: tuple[float, ...]  # [rad] angles of the running motion
    hottest: float | None = None  # [C] highest temperature of all servos
    volts: float | None = None  # [V] lowest supply voltage of all servos
    faulty: bool = False  # whether a servo reports an error
    servos: ServoReport | None = None  # measurements of the servos; None without servos

    @classmethod
    def of(cls, time: float, planned: Floats, measured: Floats | None, health: ServoHealth | None) -> "BodyReport":
        """Build a report from planned angles, measured angles and servo telemetry.

        Args:
            time: clock time [s].
            planned: (n,) [rad] of the running motion.
            measured: (n,) [rad] from a measuring sink; None if there is no measurement.
            health: servo telemetry, whose angles are valid with torque off, too; None without servos.
        """
        reference = _rounded(planned)
        angles = reference if measured is None else _rounded(measured)
        if health is None:
            return cls(round(time, 3), angles, reference)
        if health.angles.size:
            angles = _rounded(health.angles)
        return cls(round(time, 3), angles, reference, health.hottest, health.volts, health.faulty, health.servos)


def _rounded(angles: Floats) -> tuple[float, ...]:
    """Round angles [rad] for clients.

    NaN stays NaN.
    """
    return tuple(angles.round(4).tolist())


@dataclass(frozen=True)
class Words(Message):
    """Request to the planner: speak streamed text.

    More may follow.
    """

    ends: bool = False  # whether the text is complete
    instead: bool = False  # whether this text replaces all unspoken text
    style: str = ""  # name of the style of this text; empty: the server's style


@dataclass(frozen=True)
class DocumentRequest:
    """Request to the planner: perform a document or speak streamed text."""

    message: Message
    stops: int  # count of emergency stops at the time of the request; a later stop cancels the request


@dataclass(frozen=True)
class Interruption:
    """Request to the planner: end one block or all blocks."""

    block: str | None
    yields: bool = False  # whether arms hold before they return, because a person speaks
    silenced: float = 0.0  # [s] clock time at which the speech began to fade out
    sender: int | None = None  # client to be told the text heard so far


@dataclass(frozen=True)
class Restyling:
    """Request to the planner: change the style of one or all blocks."""

    style: str | None
    changes: tuple[str, ...]  # changes of style parameters, NAME=VALUE
    amount: float | None  # amount of movement, 0..1; None: unchanged
    block: str | None  # id of the block; None: all running and future blocks
    sender: int


@dataclass(frozen=True)
class ConversationRequest:
    """Request to the planner: an event of a conversation."""

    event: ConversationEvent | SoundEvent
    sender: int
    stops: int = 0  # count of emergency stops at the time of the request; a later stop cancels the request
    fills: bool = False  # whether the robot says fillers, if the event begins the conversation


@dataclass(frozen=True)
class Resumption:
    """Request to the planner: return to rest after an emergency stop."""

    stops: int


@dataclass(frozen=True)
class Renewal:
    """Request to the planner: reload the gesture lexicon."""


ClientRequest = DocumentRequest | Interruption | Restyling | ConversationRequest | Resumption | Renewal


@dataclass(frozen=True, eq=False)
class LoopStart:
    """State of the control loop from which a new planner continues."""

    motion: Trajectory
    stops: int  # executed emergency stops
    agenda: tuple[ScheduledFeedback, ...]  # pending feedback of the previous planner
    runs: int = 0  # number of the last running block in the agenda


@dataclass(frozen=True, eq=False)
class LoopProperties:
    """Clock and available outputs of the loop, which never change."""

    clock: Clock
    accompaniment: SoundAndFace  # available outputs for face and sound


@dataclass(frozen=True, eq=False)
class Halted:
    """Message from the loop to the planner: an emergency stop was executed."""

    stops: int  # executed emergency stops
    time: float  # [s] clock time
    motion: Trajectory


@dataclass(frozen=True)
class ProposalVerdict:
    """Message to the planner that accepts or rejects a proposal."""

    accepted: bool
    stops: int
    time: float  # [s] clock time up to which commands were sent


@dataclass(frozen=True)
class PlannerReady:
    """Message from the planner: warm-up is complete."""


@dataclass(frozen=True)
class FeedbackNotice:
    """Message from the planner: send this feedback immediately."""

    message: str
    sender: int


@dataclass(frozen=True)
class RequestDone:
    """Message from the planner: the last request is complete."""


@dataclass(frozen=True, eq=False)
class Proposal:
    """Message from the planner to the loop: new motion, feedback and tracks.

    The loop answers with a `ProposalVerdict`.
    """

    stops: int  # count of emergency stops known to the planner
    now: float  # [s] clock time of the proposal
    cut: float  # [s] clock time from which motion and feedback may differ from the current ones
    motion: Trajectory | None  # in clock time; None: unchanged
    final_feedback: tuple[ScheduledFeedback, ...]  # final messages, not repeated in later proposals
    agenda: tuple[ScheduledFeedback, ...]  # messages that the next proposal repeats, changes or withdraws
    owed: frozenset[int]  # clients with unfinished blocks
    moving: Mapping[tuple[str, str], Flags]  # (block, behaviour) -> (n,) moving hinges
    tracks: Mapping[str, Track | None]  # changed tracks by block; None for an ended block
    idles: bool = False  # whether the motion is idle motion only


News = PlannerReady | FeedbackNotice | RequestDone | Proposal
