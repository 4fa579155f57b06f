"""Key frames: where hands, head and torso are at key times (thesis 8.5: the full body at each key)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from kinesic.bml.block import Notice, Timeline
from kinesic.body.arrays import Floats
from kinesic.body.reach import Reach
from kinesic.body.robot import PartName, Side
from kinesic.expressivity.lexicon.hand_shapes import Finger
from kinesic.motion.keys import KeyPassage

Touch = Literal["hand", "forearm", "upper_arm", "head", "chest", "lap"]  # arm and hand: those of the other side


@dataclass(frozen=True)
class Outcome:
    """What became of a behaviour."""

    kind: Literal["realised", "partly", "substituted", "dropped"]
    why: str = ""


@dataclass(frozen=True)
class Turn:
    """A rotation of head or torso away from upright: torsion first, then tilt, then roll."""

    torsion: float = 0.0  # [rad] + left
    tilt: float = 0.0  # [rad] + down, forward
    roll: float = 0.0  # [rad] + to the right


@dataclass(frozen=True)
class BodyMove:
    """What the rest of the body does in one gesture, where nothing else is asked of it."""

    head: Turn = Turn()  # at the stroke
    nod: float = 0.0  # [rad] down at each stroke, beyond where the head is
    shake: float = 0.0  # [rad] of the head to either side, first to the left; below 0 to the right
    trunk: Turn = Turn()
    shoulders: float = 0.0  # [rad] that they rise above the hands that take part
    eyes: Turn | None = None  # where they look, in the world; None: wherever they did
    face: tuple[tuple[str, float], ...] = ()  # lexemes of expressions, and their amounts
    gave_way: tuple[str, ...] = ()  # parts that something else of the document needs meanwhile

    @property
    def still(self) -> bool:
        """Whether only the hands move."""
        return self.head == self.trunk == Turn() and self.nod == self.shake == self.shoulders == 0.0


@dataclass(frozen=True)
class Succession:
    """How much later than others a part of a body moves in one gesture."""

    leader: Side = "r"  # of two hands the one that comes at the times of the gesture
    behind: float = 0.0  # [s] that the other one follows
    loose: float = 0.0  # [s] that the wrist comes later than the shoulder on the ways there and back

    def behind_of(self, side: Side) -> float:
        """How much later than the gesture's times one of its hands is [s]."""
        return 0.0 if side == self.leader else self.behind


NO_SUCCESSION = Succession()


@dataclass(frozen=True)
class HeldTurns:
    """Rotations that a behaviour holds from its end on, alone."""

    kind: Literal["look", "posture"]  # of two of one kind the later one alone holds
    head: Turn = Turn()  # the torso's part included
    torso: Turn = Turn()


@dataclass(frozen=True, eq=False)
class Hand:
    """Where one hand is."""

    reach: Reach | None = None  # in the world as if the torso stood upright; None: at rest
    aim: Floats | None = None  # (3,) [m] in the world: what the arm points at from wherever its shoulder then is
    touch: Touch | None = None  # what the hand is laid on; performed as a hover
    openness: float = 0.0  # 0 the elbow hangs as the hand lets it .. 1 it stands far out
    effort: float = 0.0  # 0 the shoulder stays .. 1 the arm pulls it along
    passing: bool = False  # on a path: the elbow comes along as it is
    lift: float = 0.0  # [rad] that the shoulder rises, wherever the hand is
    shape: str | None = None  # name of a hand shape; None: relaxed
    tip: Finger | None = None  # whose tip touches; None: palm or finger, whichever is nearer


@dataclass(frozen=True, eq=False)
class FingerKey:
    """The fingers of one hand at one time."""

    time: float  # [s] block time
    angles: Floats  # (f,) [rad] of the hand's finger drives, in joint order


@dataclass(frozen=True, eq=False)
class KeyFrame:
    """The whole upper body at one key time."""

    time: float  # [s] block time
    torso: Turn
    head: Turn
    hands: Mapping[Side, Hand]
    given: frozenset[PartName]  # parts that a behaviour asks for here
    syncs: tuple[tuple[str, str], ...] = ()  # (behaviour id, sync point) that fall on this key
    passages: Mapping[PartName, KeyPassage] = field(default_factory=dict)  # of given parts; the others pass plainly
    filled: frozenset[PartName] = frozenset()  # parts that are on their way here between keys of their own

    @property
    def known(self) -> frozenset[PartName]:
        """Parts whose place this frame says; the others go along with them."""
        return self.given | self.filled


@dataclass(frozen=True, eq=False)
class KeyFrames:
    """One block as key frames, in strictly increasing time, at rest before the first and after the last."""

    timeline: Timeline
    frames: tuple[KeyFrame, ...]
    outcomes: Mapping[str, Outcome]  # behaviour id -> what became of it, dropped ones included
    uses: Mapping[str, frozenset[PartName]] = field(default_factory=dict)  # behaviour id -> the parts it moves
    notices: tuple[Notice, ...] = ()  # those of the timeline included
    bodies: Mapping[str, BodyMove] = field(default_factory=dict)  # id of a gesture -> what the body does beside it
    fingers: Mapping[Side, tuple[FingerKey, ...]] = field(default_factory=dict)  # of hands whose fingers move
    shapes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)  # behaviour id -> hand shapes asked for
    successions: Mapping[str, Succession] = field(default_factory=dict)  # id of what hands do -> what moves later
    held: Mapping[str, HeldTurns] = field(default_factory=dict)  # id of a behaviour that never goes back -> it holds
