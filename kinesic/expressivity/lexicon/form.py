"""The form of a gesture: what the lexicon says about it, before timing and manner."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from kinesic.body.arrays import Floats
from kinesic.body.robot import Side
from kinesic.expressivity.keyframes import Touch
from kinesic.expressivity.lexicon.body_form import NO_BODY, BodyForm
from kinesic.expressivity.lexicon.hand_shapes import Finger, FingerMotion
from kinesic.expressivity.lexicon.paths import HandPath
from kinesic.expressivity.style.effort import Tempo

MatchKind = Literal["exact", "synonym", "class"]  # the name itself; another name of it; one for all of its class

ONE_WAY = 2  # keys of a gesture that goes from one place to another


@dataclass(frozen=True, eq=False)
class HandPose:
    """One hand in one stroke key; directions and positions are written for the hand's own side.

    Axes: forward, outward (to the hand's own side), up; the origin is that of gesture space
    (`Robot.gesture_origin`), the unit is the arm length.
    """

    position: Floats  # (3,) forward, outward, up [arm lengths]
    fixed: tuple[bool, bool, bool] = (False, False, False)  # axes that spatial extent leaves alone
    palm: Floats | None = None  # (3,) unit: direction that the palm faces
    pointing: Floats | None = None  # (3,) unit: direction along the hand, wrist to fingers
    shape: str | None = None  # name of a hand shape, for robots with fingers
    openness: float = 0.0  # of the elbow, 0..1
    touch: Touch | None = None  # what the hand is laid on here
    path: HandPath | None = None  # how it comes here from the key before [arm lengths]; None: straight
    tip: Finger | None = None  # whose tip touches, on hands that have it; None: palm or finger, whichever is nearer


@dataclass(frozen=True, eq=False)
class StrokeKey:
    """One key pose of a stroke; a side that is missing stays as it is."""

    hands: Mapping[Side, HandPose]


@dataclass(frozen=True, eq=False)
class GestureForm:
    """One entry of a lexicon."""

    id: str
    category: str  # beat, deictic, iconic, metaphoric, emblem, rest, ...
    keys: tuple[StrokeKey, ...]  # in order, from strokeStart to strokeEnd; one key: arrive and hold
    rest: bool = False  # a posture that stays until the next one (arms crossed, hands together)
    tempo: Tempo = "neutral"  # how it is done by its meaning: all at once, or with all the time in the world
    body: BodyForm = NO_BODY  # what the rest of the body does
    fingers: FingerMotion | None = None  # what fingers do while the stroke lasts
    fallback: str = ""  # id of a gesture for a hand that cannot make its shapes

    @property
    def shapes(self) -> tuple[str, ...]:
        """Hand shapes that it takes, each once, in order."""
        return tuple(dict.fromkeys(pose.shape for key in self.keys for pose in key.hands.values() if pose.shape))

    @property
    def sides(self) -> frozenset[Side]:
        """Hands that take part."""
        return frozenset(side for key in self.keys for side in key.hands)

    @property
    def stays(self) -> bool:
        """Whether a hand comes to the head to stay there, as one that listens: nobody does that twice in a row."""
        touching = any(pose.touch == "head" for pose in self.keys[-1].hands.values())
        return touching and len(self.keys) == ONE_WAY and self.tempo == "sustained"


@dataclass(frozen=True, eq=False)
class Match:
    """What the lexicon offers for a lexeme."""

    form: GestureForm  # with the sides that the behaviour's mode asks for
    kind: MatchKind = "exact"  # how it was found
    substitute: str = ""  # what of the lexeme it does not mean; empty when it means the same
