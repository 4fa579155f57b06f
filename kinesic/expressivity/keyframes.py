"""Key frames of hands, head and torso (thesis 8.5)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from kinesic.bml.block import Notice, Timeline
from kinesic.body.arrays import Floats
from kinesic.body.reach import Reach
from kinesic.body.robot import PartName, Side
from kinesic.expressivity.lexicon.hand_shapes import Surface
from kinesic.motion.keys import KeyPassage

Touch = Literal[
    "hand", "forearm", "upper_arm", "head", "chest", "lap"
]  # touched body part; arm and hand mean the arm and hand of the other side


@dataclass(frozen=True)
class Outcome:
    """Outcome of a behaviour, with the reason for a change."""

    kind: Literal["realised", "partly", "substituted", "dropped"]
    why: str = ""


@dataclass(frozen=True)
class Turn:
    """Rotation of head or torso from upright.

    The order is torsion, tilt, roll.
    """

    torsion: float = 0.0  # [rad] + left
    tilt: float = 0.0  # [rad] + down, forward
    roll: float = 0.0  # [rad] + to the right


@dataclass(frozen=True)
class BodyMove:
    """Body motion that accompanies one gesture."""

    head: Turn = Turn()  # rotation of the head at the stroke
    nod: float = 0.0  # [rad] additional tilt down at each stroke
    shake: float = 0.0  # [rad] shake of the head to both sides, first to the left; below 0 first to the right
    trunk: Turn = Turn()  # rotation of the trunk at the stroke
    trunk_start: Turn | None = None  # rotation at the start of the stroke; None: without a key
    shoulders: float = 0.0  # [rad] elevation on the sides of the hands that take part
    eyes: Turn | None = None  # gaze direction in the world; None: unchanged
    face: tuple[tuple[str, float], ...] = ()  # (lexeme of an expression, amount)
    gave_way: tuple[str, ...] = ()  # body parts whose motion yields to other behaviours of the document

    @property
    def still(self) -> bool:
        """Whether the motion leaves head, trunk and shoulders unmoved."""
        return self.head == self.trunk == Turn() and self.nod == self.shake == self.shoulders == 0.0


@dataclass(frozen=True)
class Succession:
    """Delays between the hands, and between the joints of an arm."""

    leader: Side = "r"  # hand without a delay
    behind: float = 0.0  # [s] delay of the hand that follows
    loose: float = 0.0  # [s] delay of the wrist after the shoulder in preparation and retraction

    def behind_of(self, side: Side) -> float:
        """Return the delay of one hand relative to the gesture [s]."""
        return 0.0 if side == self.leader else self.behind


NO_SUCCESSION = Succession()  # zero delays: all joints move at the same time


@dataclass(frozen=True)
class HeldTurns:
    """Head and torso rotations that remain after a behaviour ends."""

    kind: Literal["look", "posture"]  # a later behaviour replaces an earlier one of the same kind
    head: Turn = Turn()  # rotation from upright, including the rotation of the torso
    torso: Turn = Turn()


@dataclass(frozen=True, eq=False)
class Hand:
    """Pose of one hand, with the properties of its arm."""

    reach: Reach | None = None  # hand target in the world with an upright torso; None: at rest
    aim: Floats | None = None  # (3,) [m] pointed place in the world, for any position of the shoulder
    touch: Touch | None = None  # touched body part; performed as a hover
    openness: float = 0.0  # 0 the elbow hangs .. 1 it stands far out
    effort: float = 0.0  # 0 the shoulder stays .. 1 it follows the arm
    passing: bool = False  # whether the key is on a path, where the elbow keeps its swivel
    lift: float = 0.0  # [rad] elevation of the shoulder, for any hand position
    shape: str | None = None  # name of a hand shape; None: relaxed
    tip: Surface | None = None  # touching surface; None: palm or finger, whichever is nearer


@dataclass(frozen=True, eq=False)
class FingerKey:
    """Finger angles of one hand at one time."""

    time: float  # [s] block time
    angles: Floats  # (f,) [rad] angles of the finger drives, in joint order


@dataclass(frozen=True, eq=False)
class KeyFrame:
    """Poses of the whole upper body at one key time."""

    time: float  # [s] block time
    torso: Turn
    head: Turn
    hands: Mapping[Side, Hand]
    given: frozenset[PartName]  # parts with a key of a behaviour
    syncs: tuple[tuple[str, str], ...] = ()  # (behaviour id, sync point) at this key
    passages: Mapping[PartName, KeyPassage] = field(default_factory=dict)  # spline parameters of the parts in `given`
    filled: frozenset[PartName] = frozenset()  # parts interpolated between their own keys

    @property
    def posed_parts(self) -> frozenset[PartName]:
        """Body parts that have a key or interpolated pose in this frame.

        The other parts follow them.
        """
        return self.given | self.filled


@dataclass(frozen=True, eq=False)
class KeyFrames:
    """Key frames of one block in strictly increasing time.

    The body is at rest before the first and after the last frame.
    """

    timeline: Timeline
    frames: tuple[KeyFrame, ...]
    outcomes: Mapping[str, Outcome]  # outcomes by behaviour id, including dropped behaviours
    uses: Mapping[str, frozenset[PartName]] = field(default_factory=dict)  # behaviour id -> moved parts
    notices: tuple[Notice, ...] = ()  # warnings, including the notices of the timeline
    bodies: Mapping[str, BodyMove] = field(default_factory=dict)  # gesture id -> accompanying body motion
    fingers: Mapping[Side, tuple[FingerKey, ...]] = field(default_factory=dict)  # keys of hands with moving fingers
    shapes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)  # behaviour id -> requested hand shapes
    successions: Mapping[str, Succession] = field(default_factory=dict)  # stroke id -> delays of hands and joints
    held: Mapping[str, HeldTurns] = field(default_factory=dict)  # id of a lasting behaviour -> held rotations
