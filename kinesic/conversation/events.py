"""Events of a conversation, from speech recognisers, cameras and clients.

An event has no absolute time: the caller passes the time of its arrival, and `age` is the delay of the report.
"""

from dataclasses import dataclass
from typing import Literal

Place = tuple[float, float, float]  # [m] position in the robot's world frame: x forward, y left, z up


@dataclass(frozen=True)
class Conversing:
    """Start or end of a conversation."""

    on: bool  # whether the conversation starts; otherwise it ends
    amount: float = 1.0  # 0..1 amount of the robot's conversational movements


@dataclass(frozen=True)
class Person:
    """A person that a camera or tracker reports."""

    id: str
    place: Place  # [m] position of the eyes
    looks: bool = False  # whether the person looks at the robot


@dataclass(frozen=True)
class PeopleSeen:
    """All people seen by a tracker at one time."""

    people: tuple[Person, ...]
    age: float = 0.0  # [s] time since the measurement


@dataclass(frozen=True)
class VoiceActivity:
    """Start or end of the voice of a person."""

    active: bool
    who: str | None = None  # id of the person; None: unknown
    age: float = 0.0  # [s] time since the voice began or ended


@dataclass(frozen=True)
class Transcript:
    """Recognised words of a person."""

    text: str  # all words of the turn so far
    final: bool = False  # whether the recogniser will not change the words any more
    who: str | None = None  # id of the person; None: unknown


@dataclass(frozen=True)
class TurnPrediction:
    """Probability that the turn passes to the robot."""

    yours: float  # 0..1 probability that the turn passes to the robot


@dataclass(frozen=True)
class Thinking:
    """Start or end of a model's preparation of its answer."""

    on: bool  # whether the preparation starts; otherwise it ends


@dataclass(frozen=True)
class RobotSpeech:
    """Start or end of the robot's own speech."""

    active: bool  # whether the speech starts; otherwise it ends
    ends_in: float | None = None  # [s] time until the speech ends; None: unknown
    filler: bool = False  # whether the speech only fills the time until the answer


@dataclass(frozen=True)
class BargeIn:
    """Decision that a person takes the turn while the robot speaks."""

    cause: Literal["voice", "words", "client"] = "voice"


@dataclass(frozen=True, eq=False)
class SoundPiece:
    """Part of a speech sound that a client supplies for the robot."""

    id: str  # id of the sound
    rate: int  # [Hz] sample rate
    data: bytes  # 16-bit little-endian samples of one channel
    ends: bool = False  # whether this is the last part
    plays: bool = True  # whether the robot plays the sound; otherwise the client plays it


@dataclass(frozen=True)
class SoundPosition:
    """Position in a sound that a client plays itself."""

    id: str  # id of the sound
    at: float  # [s] time since the start of the sound


SoundEvent = SoundPiece | SoundPosition
ConversationEvent = (
    Conversing | PeopleSeen | VoiceActivity | Transcript | TurnPrediction | Thinking | RobotSpeech | BargeIn
)
