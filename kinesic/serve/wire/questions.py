"""Messages that ask and move nothing: where a hand can go, what a document would become, how the robot is."""

from typing import Annotated, Literal

from msgspec import Meta, Struct

Length = Annotated[float, Meta(ge=-10.0, le=10.0)]  # [m]
Angle = Annotated[float, Meta(ge=-10.0, le=10.0)]  # [rad]
Place = tuple[Length, Length, Length]  # in the world
Format = Literal["npz", "csv", "bap", "wav", "glb"]  # of a file: motion, voice, a scene
LONG_VERBS = frozenset(
    {"plan", "export", "gesture", "save", "words"}
)  # whose messages carry documents or texts, and may be as long as one


class ReachQuestion(Struct, tag="reach", tag_field="do", forbid_unknown_fields=True):
    """Asks for the posture that brings a hand, or another part of the body, to a place."""

    target: Place
    side: Literal["left", "right"] = "right"
    part: Literal["hand", "elbow", "trunk", "gaze"] = "hand"
    posture: tuple[Angle, ...] | None = None  # [rad] from which it starts, in joint order; None: rest
    id: int = 0  # of the question, in its answer


class PlanQuestion(Struct, tag="plan", tag_field="do", forbid_unknown_fields=True):
    """Asks what a document would become."""

    bml: str
    set: tuple[str, ...] = ()  # NAME=VALUE of the style, as the command line's --set
    id: int = 0


class ExportQuestion(Struct, tag="export", tag_field="do", forbid_unknown_fields=True):
    """Asks for a document's performance as a file of another program."""

    bml: str
    format: Format
    set: tuple[str, ...] = ()  # NAME=VALUE of the style
    id: int = 0


class GestureQuestion(Struct, tag="gesture", tag_field="do", forbid_unknown_fields=True):
    """Asks what a gesture would look like alone, or for the file of one of our own."""

    toml: str | None = None  # a file of gestures, of which the first is planned
    lexeme: str | None = None  # whose file is asked for instead
    set: tuple[str, ...] = ()  # NAME=VALUE of the style
    id: int = 0


class WatchRequest(Struct, tag="watch", tag_field="do", forbid_unknown_fields=True):
    """Asks for the state of the robot, again and again."""

    rate: float = 20.0  # [Hz]; 0: no longer


class ServosQuestion(Struct, tag="servos", tag_field="do", forbid_unknown_fields=True):
    """Asks which servos there are, in the order in which `body` tells how they are."""

    id: int = 0


class SaveRequest(Struct, tag="save", tag_field="do", forbid_unknown_fields=True):
    """Asks to keep a document in the folder that the server was given."""

    name: str  # of the file, without a folder
    text: str
    id: int = 0


class OpenRequest(Struct, tag="open", tag_field="do", forbid_unknown_fields=True):
    """Asks for a document of that folder, or for the names of all."""

    name: str | None = None
    id: int = 0


BodyQuestion = ReachQuestion | WatchRequest | ServosQuestion
DocumentQuestion = PlanQuestion | ExportQuestion | GestureQuestion | SaveRequest | OpenRequest
Question = BodyQuestion | DocumentQuestion
