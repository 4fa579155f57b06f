"""Client queries without robot motion: inverse kinematics, plans, files, telemetry."""

from typing import Annotated, Literal

from msgspec import Meta, Struct

Length = Annotated[float, Meta(ge=-10.0, le=10.0)]  # [m]
Angle = Annotated[float, Meta(ge=-10.0, le=10.0)]  # [rad]
Place = tuple[Length, Length, Length]  # [m] in world coordinates
Format = Literal["npz", "csv", "bap", "wav", "glb"]  # file format of a motion, a voice or a scene
BackupKey = Annotated[str, Meta(pattern="^[a-z0-9]{8,32}$")]
BackupName = Annotated[str, Meta(max_length=100)]
Revision = Annotated[str, Meta(max_length=64)]
UnixTime = Annotated[float, Meta(ge=0.0, le=1e11)]  # [s]
LONG_VERBS = frozenset(
    {"plan", "export", "gesture", "author", "alternatives", "save", "backup", "words"}
)  # `do` values of messages that may be as long as a document


class ReachQuestion(Struct, tag="reach", tag_field="do", forbid_unknown_fields=True):
    """Request for the posture that brings a body part to a position."""

    target: Place  # [m] position in the world
    side: Literal["left", "right"] = "right"  # arm of a hand or elbow
    part: Literal["hand", "elbow", "trunk", "gaze"] = "hand"  # body part that reaches, or looks at, the target
    posture: tuple[Angle, ...] | None = None  # [rad] start posture in joint order; None: rest
    id: int = 0  # number that the answer repeats; 0: none


class PlanQuestion(Struct, tag="plan", tag_field="do", forbid_unknown_fields=True):
    """Request for the plan of a document."""

    bml: str  # document
    set: tuple[str, ...] = ()  # changes of the style, each as NAME=VALUE
    id: int = 0  # number that the answer repeats; 0: none


class ExportQuestion(Struct, tag="export", tag_field="do", forbid_unknown_fields=True):
    """Request for the performance of a document as a file."""

    bml: str  # document
    format: Format  # file format
    set: tuple[str, ...] = ()  # changes of the style, each as NAME=VALUE
    id: int = 0  # number that the answer repeats; 0: none


class GestureQuestion(Struct, tag="gesture", tag_field="do", forbid_unknown_fields=True):
    """Request for the plan or the TOML file of a single gesture."""

    toml: str | None = None  # gesture file whose first gesture is planned
    lexeme: str | None = None  # id of a built-in gesture whose file is returned instead
    set: tuple[str, ...] = ()  # changes of the style, each as NAME=VALUE
    id: int = 0  # number that the answer repeats; 0: none


class FindQuestion(Struct, tag="find", tag_field="do", forbid_unknown_fields=True):
    """Request for the gestures that match some words, the best first."""

    words: Annotated[str, Meta(max_length=200)]  # words for the meaning of a gesture, in English
    id: int = 0  # number that the answer repeats; 0: none


class AuthorQuestion(Struct, tag="author", tag_field="do", forbid_unknown_fields=True):
    """Request for a document that speaks a text with fitting gestures."""

    text: str  # text to be spoken, as in `kinesic say`
    style: str = ""  # name of a built-in style; empty: the server's style
    id: int = 0  # number that the answer repeats; 0: none


class AlternativesQuestion(Struct, tag="alternatives", tag_field="do", forbid_unknown_fields=True):
    """Request for the possible gestures at a word, the best first."""

    text: str  # spoken text
    at: Annotated[int, Meta(ge=0, le=99_999)]  # position [characters] of the word in the text
    intent: Annotated[str, Meta(max_length=100)] = ""  # intent of the gesture that the word has now; empty: unknown
    id: int = 0  # number that the answer repeats; 0: none


class WatchRequest(Struct, tag="watch", tag_field="do", forbid_unknown_fields=True):
    """Request for periodic reports of the robot state."""

    rate: float = 20.0  # [Hz] rate of reports; 0 ends the subscription


class ServosQuestion(Struct, tag="servos", tag_field="do", forbid_unknown_fields=True):
    """Request for the list of servos, ordered as in `body` reports."""

    id: int = 0  # number that the answer repeats; 0: none


class SaveRequest(Struct, tag="save", tag_field="do", forbid_unknown_fields=True):
    """Request to save a document in the server's document folder."""

    name: str  # file name without a folder
    text: str  # content of the file
    revision: Revision | None = None  # revision of the file that may be replaced; empty: no file, None: any file
    id: int = 0  # number that the answer repeats; 0: none


class OpenRequest(Struct, tag="open", tag_field="do", forbid_unknown_fields=True):
    """Request for a document of the folder, or for all document names."""

    name: str | None = None  # file name; if missing, the answer lists all names
    id: int = 0  # number that the answer repeats; 0: none


class VersionsRequest(Struct, tag="versions", tag_field="do", forbid_unknown_fields=True):
    """Request for an earlier version of a document, or for the list."""

    name: str  # file name of the document
    number: int | None = None  # number of the version; if missing, the answer lists all versions
    id: int = 0  # number that the answer repeats; 0: none


class BackupRequest(Struct, tag="backup", tag_field="do", forbid_unknown_fields=True):
    """Request to store or discard the backup of an unsaved document."""

    key: BackupKey  # key of the edited document, chosen by the client
    name: BackupName = ""  # name of the document
    text: str | None = None  # text of the document; None discards the backup
    revision: Revision = ""  # revision of the saved file that was edited; empty without a saved file
    time: UnixTime | None = None  # time of the text by the client's clock; None: the server's time
    id: int = 0  # number that the answer repeats; 0: none


class BackupsRequest(Struct, tag="backups", tag_field="do", forbid_unknown_fields=True):
    """Request for one backup or for the list of backups."""

    key: BackupKey | None = None  # key of one backup; if missing, the answer lists all backups
    id: int = 0  # number that the answer repeats; 0: none


class StylesRequest(Struct, tag="styles", tag_field="do", forbid_unknown_fields=True):
    """Request for all styles: built-in ones and those of the folder."""

    id: int = 0  # number that the answer repeats; 0: none


BodyQuestion = ReachQuestion | WatchRequest | ServosQuestion
StorageRequest = SaveRequest | OpenRequest | VersionsRequest | BackupRequest | BackupsRequest | StylesRequest
TextQuestion = AuthorQuestion | AlternativesQuestion
DocumentQuestion = PlanQuestion | ExportQuestion | GestureQuestion | FindQuestion | TextQuestion | StorageRequest
Question = BodyQuestion | DocumentQuestion
