"""What a behaviour asks the body to do, one type for each kind, whatever document said it."""

from dataclasses import dataclass
from typing import Literal

from kinesic.body.utterance import Script

HandMode = Literal["left", "right", "both", "unspecified"]
Modality = Literal["gesture", "head", "torso", "face"]  # each is moved in a manner of its own


@dataclass(frozen=True)
class Gesture:
    """A gesture of the lexicon."""

    lexeme: str
    mode: HandMode = "unspecified"
    target: str | None = None
    shape: str = ""  # how the hands are held, in place of the gesture's own shapes


@dataclass(frozen=True)
class Pointing:
    """Pointing at a target: a name, or "x y z" in the world [m]."""

    target: str
    mode: HandMode = "unspecified"
    shape: str = ""  # how the hand is held, in place of the stretched forefinger


@dataclass(frozen=True)
class Head:
    """A head movement that returns: NOD, SHAKE, or a direction of Greta's lexicon."""

    lexeme: str
    repetition: int = 1
    amount: float = 0.5


@dataclass(frozen=True)
class HeadDirectionShift:
    """A head direction that stays: a target, or a lexeme of Greta's."""

    target: str


@dataclass(frozen=True)
class Gaze:
    """Looking at a target, or in a direction off the present one."""

    target: str | None = None
    influence: str | None = None
    offset_angle: float = 0.0  # [deg]
    offset_direction: str | None = None
    shift: bool = False  # gazeShift: it stays


@dataclass(frozen=True)
class Face:
    """Facial expression: lexemes, or one action unit."""

    lexemes: tuple[str, ...] = ()
    action_unit: int | None = None
    side: Literal["left", "right", "both"] = "both"
    amount: float = 0.5
    shift: bool = False  # faceShift: it stays


@dataclass(frozen=True)
class Posture:
    """Body posture by stance and poses."""

    stance: str | None = None
    poses: tuple[tuple[str, str], ...] = ()  # (part, lexeme)
    shift: bool = False  # postureShift: it stays


@dataclass(frozen=True)
class Torso:
    """Greta's torso movement: a lexeme such as BodyLean."""

    lexeme: str
    amount: float = 0.5


@dataclass(frozen=True)
class Locomotion:
    """Walking to a target."""

    target: str
    manner: str = "WALK"


@dataclass(frozen=True)
class Speech:
    """Something said; its sync points are start, end and the marks of the script."""

    script: Script
    pause: float | None = None  # [s] longest pause before a word that waits for the body; None: as the block says


@dataclass(frozen=True)
class Wait:
    """Waiting for a while, without moving anything."""

    duration: float | None = None  # [s]


@dataclass(frozen=True)
class Interrupt:
    """Stops another block, or some of its behaviours."""

    target: str  # id of the block
    include: tuple[str, ...] = ()  # behaviours that stop; none: all
    exclude: tuple[str, ...] = ()  # behaviours that go on


@dataclass(frozen=True)
class Activate:
    """Begins a block that was sent early."""

    target: str  # id of the block


@dataclass(frozen=True)
class ParameterChange:
    """Changes how another block is performed while it plays."""

    target: str  # "block" or "block:behaviour"
    parameter: str  # "amount", "style", or a parameter of expressivity
    value: str


@dataclass(frozen=True)
class Custom:
    """A behaviour of an extension, by its name with prefix."""

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
BlockCommand = Interrupt | Activate | ParameterChange  # what a block does to others


def modality_of(action: Action) -> Modality | None:
    """Names the modality that performs; of a posture that of its arms; None when nothing of the body moves."""
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
