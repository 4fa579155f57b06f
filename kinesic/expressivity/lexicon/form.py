"""The form of a gesture: what the lexicon says about it, before timing and manner.

A hand shape is for a hand with five fingers; a robot without fingers passes over it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from kinesic.body.arrays import Floats
from kinesic.body.robot import Side
from kinesic.expressivity.keyframes import Touch
from kinesic.expressivity.lexicon.body_form import NO_BODY, BodyForm
from kinesic.expressivity.lexicon.paths import HandPath
from kinesic.expressivity.style.effort import Tempo

Kind = Literal["exact", "synonym", "class"]  # the name itself; another name of it; one for all of its class

HandShape = Literal[
    "relaxed",
    "open",
    "spread",
    "flat",
    "curved",
    "claw",
    "fist",
    "index",
    "two",
    "three",
    "four",
    "thumb",
    "little",
    "horns",
    "phone",
    "pistol",
    "together",
    "crossed",
    "ring",
    "pinch",
    "purse",
    "grip",
]


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
    shape: str | None = None  # hand shape, for robots with fingers
    openness: float = 0.0  # of the elbow, 0..1
    touch: Touch | None = None  # what the hand is laid on here
    path: HandPath | None = None  # how it comes here from the key before [arm lengths]; None: straight


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

    @property
    def shapes(self) -> tuple[str, ...]:
        """Hand shapes that it takes, each once, in order."""
        return tuple(dict.fromkeys(pose.shape for key in self.keys for pose in key.hands.values() if pose.shape))

    @property
    def sides(self) -> frozenset[Side]:
        """Hands that take part."""
        return frozenset(side for key in self.keys for side in key.hands)


@dataclass(frozen=True, eq=False)
class Match:
    """What the lexicon offers for a lexeme."""

    form: GestureForm  # with the sides that the behaviour's mode asks for
    kind: Kind = "exact"  # how it was found
    substitute: str = ""  # what of the lexeme it does not mean; empty when it means the same


@dataclass(frozen=True)
class Shape:
    """How the fingers are held."""

    says: str  # in words
    straight: tuple[float, float, float, float, float]  # thumb .. little finger: 0 closed .. 1 straight
    apart: float = 0.0  # fingers, -1 crossed .. 0 side by side .. 1 as far as they go


PLAIN_SHAPES = frozenset(  # that a hand without fingers comes near to; the second line is Greta's names
    (
        "relaxed open flat curved " + "form_open form_openapart form_default open_default open_thumbout open_thumbin "
        "bend_curved relax reset thumb_away thumb_default"
    ).split()
)


SHAPES: Mapping[str, Shape] = {
    "relaxed": Shape("all fingers a little bent, as the hand hangs", (0.7, 0.8, 0.75, 0.7, 0.7), 0.2),
    "open": Shape("all fingers straight and a little apart", (1.0, 1.0, 1.0, 1.0, 1.0), 0.4),
    "spread": Shape("all fingers straight and as far apart as they go: five, fright", (1.0, 1.0, 1.0, 1.0, 1.0), 1.0),
    "flat": Shape("all fingers straight and side by side, the thumb beside them", (0.8, 1.0, 1.0, 1.0, 1.0)),
    "curved": Shape("all fingers bent as around a ball, the thumb opposite", (0.7, 0.6, 0.6, 0.6, 0.6), 0.3),
    "claw": Shape("fingers apart and bent hard at their ends", (0.6, 0.5, 0.5, 0.5, 0.5), 0.9),
    "fist": Shape("all fingers closed, the thumb over them", (0.1, 0.0, 0.0, 0.0, 0.0)),
    "index": Shape("the forefinger straight, the others closed", (0.1, 1.0, 0.0, 0.0, 0.0)),
    "two": Shape("forefinger and middle finger straight and apart: two, victory", (0.1, 1.0, 1.0, 0.0, 0.0), 0.9),
    "three": Shape("thumb, forefinger and middle finger straight and apart", (1.0, 1.0, 1.0, 0.0, 0.0), 0.8),
    "four": Shape("all fingers straight and apart, the thumb in the palm", (0.1, 1.0, 1.0, 1.0, 1.0), 0.7),
    "thumb": Shape("the thumb straight, the fingers closed", (1.0, 0.0, 0.0, 0.0, 0.0)),
    "little": Shape("the little finger straight, the others closed", (0.1, 0.0, 0.0, 0.0, 1.0)),
    "horns": Shape("forefinger and little finger straight, the others closed", (0.1, 1.0, 0.0, 0.0, 1.0), 0.5),
    "phone": Shape("thumb and little finger straight, the others closed", (1.0, 0.0, 0.0, 0.0, 1.0), 0.5),
    "pistol": Shape("thumb and forefinger straight at a right angle, the others closed", (1.0, 1.0, 0.0, 0.0, 0.0)),
    "together": Shape("forefinger and middle finger straight, side by side: an oath, a salute", (0.1, 1.0, 1.0, 0, 0)),
    "crossed": Shape("the middle finger laid over the forefinger, the others closed", (0.1, 1.0, 1.0, 0.0, 0.0), -0.5),
    "ring": Shape("the tips of thumb and forefinger meet, the others straight", (0.5, 0.4, 1.0, 1.0, 1.0), 0.6),
    "pinch": Shape("thumb and forefinger hold something small, the others bent", (0.5, 0.5, 0.3, 0.25, 0.2)),
    "purse": Shape("all finger tips meet the thumb's, as around a pebble", (0.6, 0.65, 0.65, 0.65, 0.65), -0.2),
    "grip": Shape("all fingers around a rod: a glass, a handle, a wheel", (0.4, 0.3, 0.3, 0.3, 0.3)),
}
