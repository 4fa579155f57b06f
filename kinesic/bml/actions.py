"""Actions that behaviours request, one type for each kind of behaviour."""

from dataclasses import dataclass
from typing import Literal

from kinesic.body.utterance import Script

HandMode = Literal["left", "right", "both", "unspecified"]
Modality = Literal["gesture", "head", "torso", "face"]  # body parts with separate expressivity


@dataclass(frozen=True)
class Gesture:
    """Gesture named by a lexeme, with hands, target and hand shape."""

    lexeme: str
    mode: HandMode = "unspecified"
    target: str | None = None
    shape: str = ""  # hand shape that replaces the shapes of the gesture; empty: shapes of the gesture


@dataclass(frozen=True)
class Pointing:
    """Pointing at a named target or world position "x y z" [m]."""

    target: str
    mode: HandMode = "unspecified"
    shape: str = ""  # hand shape that replaces the extended index finger


@dataclass(frozen=True)
class Head:
    """Temporary head movement, such as NOD, SHAKE or a Greta head direction."""

    lexeme: str
    repetition: int = 1
    amount: float = 0.5


@dataclass(frozen=True)
class HeadDirectionShift:
    """Lasting head direction, given by a target or a Greta lexeme."""

    target: str


@dataclass(frozen=True)
class Gaze:
    """Gaze at a target or in the held direction, with angular offset."""

    target: str | None = None
    influence: str | None = None
    offset_angle: float = 0.0  # [deg] offset; in BML drafts, values up to 1 are fractions of 50 deg
    offset_direction: str | None = None
    shift: bool = False  # whether the gaze persists (gazeShift)


@dataclass(frozen=True)
class Face:
    """Facial expression given by lexemes or by one action unit."""

    lexemes: tuple[str, ...] = ()
    action_unit: int | None = None
    side: Literal["left", "right", "both"] = "both"
    amount: float = 0.5
    shift: bool = False  # whether the expression persists (faceShift)


@dataclass(frozen=True)
class Posture:
    """Body posture given by a stance and poses of body parts."""

    stance: str | None = None
    poses: tuple[tuple[str, str], ...] = ()  # (body part, lexeme) of each pose
    shift: bool = False  # whether the posture persists (postureShift)


@dataclass(frozen=True)
class Torso:
    """Torso movement of Greta's lexicon, such as BodyLean."""

    lexeme: str
    amount: float = 0.5


@dataclass(frozen=True)
class Locomotion:
    """Walking to a target."""

    target: str
    manner: str = "WALK"


@dataclass(frozen=True)
class Speech:
    """Action that speaks a script.

    Its sync points are start, end and the marks of the script.
    """

    script: Script
    pause: float | None = None  # [s] maximum pause before a word that waits for the body; None: maximum of the block


@dataclass(frozen=True)
class Wait:
    """Waiting time without motion."""

    duration: float | None = None  # [s] duration; None: default


@dataclass(frozen=True)
class Interrupt:
    """Command to stop another block or some of its behaviours."""

    target: str  # id of the block
    include: tuple[str, ...] = ()  # ids of behaviours to stop; empty: all behaviours
    exclude: tuple[str, ...] = ()  # ids of behaviours that continue


@dataclass(frozen=True)
class Activate:
    """Command to start a preplanned block."""

    target: str  # id of the block


@dataclass(frozen=True)
class ParameterChange:
    """Command to change the expressivity of a playing block or behaviour."""

    target: str  # "block" or "block:behaviour"
    parameter: str  # "amount", "style", or a parameter of expressivity
    value: str  # new value as text


@dataclass(frozen=True)
class Custom:
    """Behaviour of an unknown type, identified by its element name."""

    name: str


Action = (
    Gesture
    | Pointing
    | Head
    | HeadDirectionShift
    | Gaze
    | Face
    | Posture
    | Torso
    | Locomotion
    | Speech
    | Wait
    | Interrupt
    | Activate
    | ParameterChange
    | Custom
)
BlockCommand = Interrupt | Activate | ParameterChange  # commands of a block to other blocks


def find_modality(action: Action) -> Modality | None:
    """Return the body part (modality) that performs an action, or None.

    None means that the body does not move. A posture has the modality of its arms.
    """
    match action:
        case Gesture() | Pointing() | Posture():
            return "gesture"
        case Head() | HeadDirectionShift() | Gaze():
            return "head"
        case Torso():
            return "torso"
        case Face():
            return "face"
    return None
