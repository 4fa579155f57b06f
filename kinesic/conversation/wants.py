"""Requests of a conversation to the robot's body, each with its reason."""

from dataclasses import dataclass
from typing import Literal

from kinesic.conversation.events import Place

Mode = Literal["off", "idle", "attending", "listening", "thinking", "speaking", "interrupted"]
Direction = tuple[float, float]  # [deg] left and up
ActionUnits = tuple[tuple[str, float], ...]  # action units with intensities 0..1

STRAIGHT_DIRECTION: Direction = (0.0, 0.0)  # [deg] straight at the position


@dataclass(frozen=True)
class Look:
    """Gaze at a position, or in a direction relative to a position."""

    place: Place | None  # [m] position in the world; None: straight ahead
    away: Direction = STRAIGHT_DIRECTION  # [deg] direction relative to the position
    head_fraction: float = 1.0  # fraction of `away` that the head performs; the eyes perform the rest
    reason: str = ""


@dataclass(frozen=True)
class BodyLean:
    """Lean of the trunk and tilt of the head.

    Both are held until the next request.
    """

    lean: float  # [deg] forward lean of the trunk
    tilt: float  # [deg] head, to the right
    reason: str = ""


@dataclass(frozen=True)
class Nod:
    """One nod of the head."""

    angle: float  # [deg] amplitude of the nod
    reason: str = ""


@dataclass(frozen=True)
class BriefExpression:
    """Brief facial expression."""

    units: ActionUnits
    duration: float  # [s]
    reason: str = ""


@dataclass(frozen=True)
class HeldExpression:
    """Facial expression that is held until the next request."""

    units: ActionUnits
    reason: str = ""


@dataclass(frozen=True)
class Filler:
    """Short utterance that fills the time until the answer."""

    number: int  # count of fillers since thinking began, from 1
    reason: str = ""


@dataclass(frozen=True)
class Yield:
    """Request to end the robot's speech because a person takes the turn."""

    reason: str = ""


@dataclass(frozen=True)
class ModeNotice:
    """Notice to the client about a new conversational state or person."""

    mode: Mode
    who: str | None = None  # id of the attended person


Want = Look | BodyLean | Nod | BriefExpression | HeldExpression | Filler | Yield | ModeNotice
