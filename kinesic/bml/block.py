"""The types that BML text becomes: what is asked (`Block`), and when it happens (`Timeline`)."""

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
    modality_of,
)

__all__ = [
    "BOUNDS",
    "FACE_SYNCS",
    "GAZE_SYNCS",
    "GESTURE_SYNCS",
    "RANGES",
    "SHIFT_SYNCS",
    "Action",
    "Activate",
    "Behaviour",
    "Block",
    "BlockCommand",
    "BlockOrder",
    "BmlError",
    "Bounds",
    "Composition",
    "Custom",
    "Dialect",
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
    "modality_of",
    "refusal",
]

Dialect = Literal["bml-1.0", "draft", "none", "fml-apml", "smartbody", "json"]

GESTURE_SYNCS = ("start", "ready", "strokeStart", "stroke", "strokeEnd", "relax", "end")
GAZE_SYNCS = ("start", "ready", "relax", "end")
FACE_SYNCS = ("start", "attackPeak", "relax", "end")
SHIFT_SYNCS = ("start", "end")

RANGES: Mapping[str, tuple[float, float]] = {  # of the parameters of expressivity (thesis 8.7)
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
    """A document is refused: names file, line, column, what is wrong and what would have worked."""


@dataclass(frozen=True)
class Place:
    """Where something stands in its document, from 1."""

    line: int
    column: int


def refusal(source: str, place: Place, what: str, remedy: str) -> BmlError:
    """Builds the error of a document that is refused.

    Args:
        source: name of the document.
        place: line and column, from 1.
        what: what is wrong, with the value.
        remedy: what would have worked.
    """
    return BmlError(f"{source}:{place.line}:{place.column}: {what}; {remedy}")


@dataclass(frozen=True)
class Bounds:
    """How large a document may be."""

    size: int = 4_000_000  # [bytes]
    depth: int = 64  # elements inside one another
    elements: int = 20_000


BOUNDS = Bounds()


class Composition(Enum):
    """How a block meets those that play already."""

    MERGE = "MERGE"
    APPEND = "APPEND"
    REPLACE = "REPLACE"


@dataclass(frozen=True)
class BlockOrder:
    """Which blocks a block follows, goes before, stops or starts, beside its composition; all by their ids."""

    after: tuple[str, ...] = ()  # it begins when these have ended
    chunk_after: tuple[str, ...] = ()  # it begins when these subside: while they retract
    before: tuple[str, ...] = ()  # these begin when it has ended
    chunk_before: tuple[str, ...] = ()  # these begin when it subsides
    preplanned: bool = False  # it begins when it is activated
    interrupts: tuple[str, ...] = ()  # these stop when it begins
    activates: tuple[str, ...] = ()  # these, preplanned, begin with it


class NoticeType(Enum):
    """Types of warningFeedback, as BML 1.0 spells them."""

    PARSING_FAILURE = "PARSING_FAILURE"
    NO_SUCH_TARGET = "NO_SUCH_TARGET"
    IMPOSSIBLE_TO_SCHEDULE = "IMPOSSIBLE_TO_SCHEDULE"
    BEHAVIOR_TYPE_NOT_SUPPORTED = "BEHAVIOR_TYPE_NOT_SUPPORTED"
    CUSTOM_BEHAVIOUR_NOT_SUPPORTED = "CUSTOM_BEHAVIOUR_NOT_SUPPORTED"
    CUSTOM_ATTRIBUTE_NOT_SUPPORTED = "CUSTOM_ATTRIBUTE_NOT_SUPPORTED"
    CANNOT_CREATE_BEHAVIOR = "CANNOT_CREATE_BEHAVIOR"


@dataclass(frozen=True)
class Notice:
    """One warning to the sender."""

    type: NoticeType
    id: str  # "block" or "block:behaviour"
    text: str


@dataclass(frozen=True)
class SyncRef:
    """A sync point of a behaviour plus an offset; behaviour `bml` is the block itself (facts: BML 1.0, 2.4)."""

    block: str
    behaviour: str
    sync: str
    iteration: int | None = None
    offset: float = 0.0  # [s]


@dataclass(frozen=True)
class Manner:
    """Expressivity that a document carries, inside `RANGES`; None where it says nothing."""

    spatial: float | None = None
    temporal: float | None = None
    fluidity: float | None = None
    power: float | None = None
    repetition: float | None = None
    openness: float | None = None
    tension: float | None = None
    intensity: float | None = None  # 0..1, of Greta's signals
    activation: float | None = None
    style: str | None = None  # preset that the numbers change


@dataclass(frozen=True)
class Behaviour:
    """One thing that the body is asked to do."""

    id: str  # unique in its block (duplicates of a dialect get a suffix, and a notice)
    type: str  # element name as written, for reports
    action: Action
    place: Place
    syncs: Mapping[str, SyncRef] = field(default_factory=dict)  # sync point -> what it must coincide with
    manner: Manner = Manner()
    required: bool = False
    agent: str | None = None  # who else performs it; None: this robot
    reason: str = ""  # why it is asked for, for people; empty: the document does not say


@dataclass(frozen=True)
class Synchronize:
    """All these points coincide."""

    refs: tuple[SyncRef, ...]
    place: Place
    required: bool = False


@dataclass(frozen=True)
class Precedence:
    """`earlier` is not after any of `later` (BML's `after`; `before` is turned round into this form)."""

    earlier: SyncRef
    later: tuple[SyncRef, ...]
    place: Place
    required: bool = False


@dataclass(frozen=True)
class Block:
    """One <bml> element."""

    id: str
    behaviours: tuple[Behaviour, ...]
    constraints: tuple[Synchronize | Precedence, ...] = ()
    composition: Composition = Composition.MERGE
    character: str | None = None
    dialect: Dialect = "bml-1.0"
    notices: tuple[Notice, ...] = ()
    source: str = "<text>"  # file name, for messages
    text: str = field(default="", repr=False, compare=False)  # of the whole document, for people; empty if unknown
    manners: Mapping[Modality, Manner] = field(default_factory=dict)  # of all its behaviours of a modality
    succession: BlockOrder = BlockOrder()
    pause: float | None = None  # [s] of its speeches, where they do not say; None: as is usual


@dataclass(frozen=True)
class Drop:
    """A behaviour that will not be performed, and why."""

    behaviour: Behaviour
    why: str


@dataclass(frozen=True)
class TimedBehaviour:
    """A behaviour with all its sync points in seconds of block time, in the order of its type."""

    behaviour: Behaviour
    times: Mapping[str, float]  # sync point -> [s]; may be negative


@dataclass(frozen=True)
class Timeline:
    """Every behaviour that will be performed, with its times."""

    block: Block
    timed: tuple[TimedBehaviour, ...]
    dropped: tuple[Drop, ...] = ()
    notices: tuple[Notice, ...] = ()  # those of the block included

    @property
    def start(self) -> float:
        """Earliest time of any behaviour, at most 0 [s]."""
        return min([0.0, *(time for timed in self.timed for time in timed.times.values())])

    @property
    def end(self) -> float:
        """Latest time of any behaviour, at least 0 [s]."""
        return max([0.0, *(time for timed in self.timed for time in timed.times.values())])
