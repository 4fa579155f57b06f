"""Types for requested behaviours (`Block`) and their times (`Timeline`)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Literal

from kinesic.bml.actions import (
    Action,
    Activate,
    BlockCommand,
    Custom,
    Face,
    Gaze,
    Gesture,
    HandMode,
    Head,
    HeadDirectionShift,
    Interrupt,
    Locomotion,
    Modality,
    ParameterChange,
    Pointing,
    Posture,
    Speech,
    Torso,
    Wait,
    find_modality,
)

__all__ = [
    "DEFAULT_BLOCK_ID",
    "DEFAULT_BOUNDS",
    "EXPRESSIVITY_RANGES",
    "FACE_SYNCS",
    "GAZE_SYNCS",
    "GESTURE_SYNCS",
    "SHIFT_SYNCS",
    "Action",
    "Activate",
    "Behaviour",
    "Block",
    "BlockCommand",
    "BlockOrder",
    "BmlError",
    "Composition",
    "Custom",
    "Dialect",
    "DocumentBounds",
    "Drop",
    "Face",
    "Gaze",
    "Gesture",
    "HandMode",
    "Head",
    "HeadDirectionShift",
    "Interrupt",
    "Locomotion",
    "Manner",
    "Modality",
    "Notice",
    "NoticeType",
    "ParameterChange",
    "Place",
    "Pointing",
    "Posture",
    "Precedence",
    "Speech",
    "SyncRef",
    "Synchronize",
    "TimedBehaviour",
    "Timeline",
    "Torso",
    "Wait",
    "document_error",
    "find_modality",
]

DEFAULT_BLOCK_ID = "block"  # id of a block whose document gives none

Dialect = Literal["bml-1.0", "draft", "none", "fml-apml", "smartbody", "json"]

GESTURE_SYNCS = ("start", "ready", "strokeStart", "stroke", "strokeEnd", "relax", "end")  # sync points of gestures
GAZE_SYNCS = ("start", "ready", "relax", "end")  # sync points of gazes in order
FACE_SYNCS = ("start", "attackPeak", "relax", "end")  # sync points of facial expressions in order
SHIFT_SYNCS = ("start", "end")  # sync points of shifts, waits and block commands, in order

EXPRESSIVITY_RANGES: Mapping[str, tuple[float, float]] = {  # allowed values of each parameter (thesis 8.7)
    "spatial": (-1.0, 1.0),
    "temporal": (-1.0, 1.0),
    "fluidity": (-1.0, 1.0),
    "power": (-1.0, 1.0),
    "tension": (-1.0, 1.0),
    "repetition": (-1.0, 1.0),
    "activation": (-1.0, 1.0),
    "openness": (0.0, 1.0),
}


class BmlError(ValueError):
    """Error in a document, with file, line, column, problem and remedy."""


@dataclass(frozen=True)
class Place:
    """Line and column in a document, counted from 1."""

    line: int
    column: int


def document_error(source: str, place: Place, problem: str, remedy: str) -> BmlError:
    """Return the error that rejects a document.

    Args:
        source: name of the document.
        place: line and column, from 1.
        problem: description of the problem, with the value.
        remedy: valid alternative.
    """
    return BmlError(f"{source}:{place.line}:{place.column}: {problem}; {remedy}")


@dataclass(frozen=True)
class DocumentBounds:
    """Maximum size of a document."""

    size: int = 4_000_000  # [bytes] size of the text
    depth: int = 64  # largest depth of nested elements
    elements: int = 20_000  # largest number of elements
    behaviours: int = 1000  # largest number of behaviours


MAX_BLOCK_DURATION = 1200.0  # [s] maximum time before or after the start of a block
DEFAULT_BOUNDS = DocumentBounds()  # maximum size of documents


class Composition(Enum):
    """BML composition mode of a block relative to earlier blocks."""

    MERGE = "MERGE"
    APPEND = "APPEND"
    REPLACE = "REPLACE"


@dataclass(frozen=True)
class BlockOrder:
    """Ids of blocks that a block follows, precedes, stops or starts."""

    after: tuple[str, ...] = ()  # ids of blocks that must end before this block starts
    chunk_after: tuple[str, ...] = ()  # ids of blocks that must retract (subside) before this block starts
    before: tuple[str, ...] = ()  # ids of blocks that start after this block has ended
    chunk_before: tuple[str, ...] = ()  # ids of blocks that start once this block retracts
    preplanned: bool = False  # whether the block waits for its activation
    interrupts: tuple[str, ...] = ()  # ids of blocks to stop when this block starts
    activates: tuple[str, ...] = ()  # ids of preplanned blocks to start together with this block


class NoticeType(Enum):
    """Types of warningFeedback, spelled as in BML 1.0."""

    PARSING_FAILURE = "PARSING_FAILURE"
    NO_SUCH_TARGET = "NO_SUCH_TARGET"
    IMPOSSIBLE_TO_SCHEDULE = "IMPOSSIBLE_TO_SCHEDULE"
    BEHAVIOR_TYPE_NOT_SUPPORTED = "BEHAVIOR_TYPE_NOT_SUPPORTED"
    CUSTOM_BEHAVIOUR_NOT_SUPPORTED = "CUSTOM_BEHAVIOUR_NOT_SUPPORTED"
    CUSTOM_ATTRIBUTE_NOT_SUPPORTED = "CUSTOM_ATTRIBUTE_NOT_SUPPORTED"
    CANNOT_CREATE_BEHAVIOR = "CANNOT_CREATE_BEHAVIOR"


@dataclass(frozen=True)
class Notice:
    """Warning to the sender of a block."""

    type: NoticeType
    id: str  # "block" or "block:behaviour"
    text: str


@dataclass(frozen=True)
class SyncRef:
    """Sync point of a behaviour plus an offset.

    The behaviour `bml` is the block itself (source: BML 1.0, 2.4).
    """

    block: str
    behaviour: str
    sync: str
    iteration: int | None = None
    offset: float = 0.0  # [s] offset added to the sync point's time


@dataclass(frozen=True)
class Manner:
    """Expressivity parameters given by a document.

    None if not given. Numbers lie within `EXPRESSIVITY_RANGES`.
    """

    spatial: float | None = None
    temporal: float | None = None
    fluidity: float | None = None
    power: float | None = None
    repetition: float | None = None
    openness: float | None = None
    tension: float | None = None
    intensity: float | None = None  # 0..1 intensity of Greta's signals
    activation: float | None = None
    style: str | None = None  # name of a style, which the other parameters modify


@dataclass(frozen=True)
class Behaviour:
    """Requested behaviour with its action and sync references."""

    id: str  # id, unique in the block; duplicates get a suffix and a notice
    type: str  # element name in the document, for reports
    action: Action
    place: Place
    syncs: Mapping[str, SyncRef] = field(default_factory=dict)  # sync point -> point that must coincide with it
    manner: Manner = Manner()
    required: bool = False
    agent: str | None = None  # other agent that performs the behaviour; None: this robot
    reason: str = ""  # reason for human readers; empty if the document gives none


@dataclass(frozen=True)
class Synchronize:
    """Constraint that all given sync points coincide."""

    refs: tuple[SyncRef, ...]
    place: Place
    required: bool = False


@dataclass(frozen=True)
class Precedence:
    """Constraint that `earlier` is not after any point in `later`.

    BML's `after` has this form; its `before` is converted into this form.
    """

    earlier: SyncRef
    later: tuple[SyncRef, ...]
    place: Place
    required: bool = False


@dataclass(frozen=True)
class Block:
    """Content of one <bml> element."""

    id: str
    behaviours: tuple[Behaviour, ...]
    constraints: tuple[Synchronize | Precedence, ...] = ()
    composition: Composition = Composition.MERGE
    character: str | None = None
    dialect: Dialect = "bml-1.0"
    notices: tuple[Notice, ...] = ()
    source: str = "<text>"  # file name, for messages
    text: str = field(
        default="", repr=False, compare=False
    )  # text of the whole document, for display; empty if unknown
    manners: Mapping[Modality, Manner] = field(default_factory=dict)  # expressivity of all behaviours of a modality
    order: BlockOrder = BlockOrder()
    pause: float | None = None  # [s] maximum pause of speeches that give none; None: default
    max_duration: float = MAX_BLOCK_DURATION  # [s] largest time from the start of the block


@dataclass(frozen=True)
class Drop:
    """Behaviour that will not be performed, with the reason."""

    behaviour: Behaviour
    reason: str


@dataclass(frozen=True)
class TimedBehaviour:
    """Behaviour with the block times [s] of its sync points, in order."""

    behaviour: Behaviour
    times: Mapping[str, float]  # sync point -> block time [s], which may be negative


@dataclass(frozen=True)
class Timeline:
    """All behaviours that will be performed, with their times."""

    block: Block
    timed: tuple[TimedBehaviour, ...]
    dropped: tuple[Drop, ...] = ()
    notices: tuple[Notice, ...] = ()  # warnings, including those of the block

    @property
    def start(self) -> float:
        """Earliest time of any behaviour, at most 0 [s]."""
        return min([0.0, *(time for timed in self.timed for time in timed.times.values())])

    @property
    def end(self) -> float:
        """Latest time of any behaviour, at least 0 [s]."""
        return max([0.0, *(time for timed in self.timed for time in timed.times.values())])
