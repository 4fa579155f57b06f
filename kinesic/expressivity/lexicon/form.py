"""Gesture forms: hand poses and body motion before timing and expressivity."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from kinesic.body.arrays import Floats
from kinesic.body.html_view import NotebookView
from kinesic.body.robot import SIDE_NAMES, Side
from kinesic.expressivity.keyframes import Touch
from kinesic.expressivity.lexicon.body_form import NO_BODY, BodyForm
from kinesic.expressivity.lexicon.hand_shapes import FingerMotion, Surface
from kinesic.expressivity.lexicon.paths import HandPath
from kinesic.expressivity.style.effort import Tempo

MatchKind = Literal["exact", "synonym", "class"]  # gesture name; synonym; name of a class that it represents

SINGLE_MOVE_KEYS = 2  # key count of a gesture that moves once between two positions


@dataclass(frozen=True, eq=False)
class HandPose:
    """Pose of one hand in a stroke key.

    Axes: forward, outward (to the hand's own side), up; the origin is that of gesture space
    (`Robot.gesture_origin`), the unit is the arm length.
    """

    position: Floats  # (3,) forward, outward, up [arm lengths]
    fixed: tuple[bool, bool, bool] = (False, False, False)  # axes that spatial extent does not scale
    palm: Floats | None = None  # (3,) unit normal of the palm
    pointing: Floats | None = None  # (3,) unit direction from wrist to fingers
    shape: str | None = None  # name of a hand shape, for robots with fingers
    openness: float = 0.0  # 0 elbow at the body .. 1 elbow away from the body
    touch: Touch | None = None  # touched body part
    path: HandPath | None = None  # path from the previous key [arm lengths]; None: straight
    tip: Surface | None = None  # touching palm or, on hands with fingers, fingertip; None: the nearest part
    aim: Floats | None = None  # (3,) [m] pointed place in the world, on a captured gesture with a target
    captured: bool = False  # whether a robot of other proportions pulls the position into its reach, without a lean

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        for values in (self.position, self.palm, self.pointing, self.aim):
            if values is not None:
                values.setflags(write=False)


@dataclass(frozen=True, eq=False)
class StrokeKey:
    """Key pose of one or both hands in a stroke.

    Missing hands keep their pose.
    """

    hands: Mapping[Side, HandPose]


@dataclass(frozen=True, eq=False)
class GestureForm(NotebookView):
    """Gesture in the lexicon: stroke keys, category, tempo and body motion."""

    id: str
    category: str  # beat, deictic, iconic, metaphoric, emblem, rest, ...
    keys: tuple[StrokeKey, ...]  # keys in order, from strokeStart to strokeEnd; a single key: arrive and hold
    rest: bool = False  # whether the gesture is a posture that is held until the next posture, such as arms crossed
    tempo: Tempo = "neutral"  # sudden or sustained if the meaning of the gesture requires it
    body: BodyForm = NO_BODY  # accompanying body motion
    fingers: FingerMotion | None = None  # finger motion during the stroke
    fallback: str = ""  # id of the gesture for hands that cannot make its shapes

    def __str__(self) -> str:
        """Return a one-line summary: name, category, hands, keys, shapes."""
        hands = "both hands" if len(self.sides) != 1 else f"{SIDE_NAMES[next(iter(self.sides))]} hand"
        keys = f"{len(self.keys)} key{'s' if len(self.keys) != 1 else ''}"
        return ", ".join([f"gesture {self.id} ({self.category}): {hands}, {keys}", *self.shapes])

    def __repr__(self) -> str:
        return f"<{self}>"

    @property
    def shapes(self) -> tuple[str, ...]:
        """Names of the hand shapes in order, without duplicates."""
        return tuple(dict.fromkeys(pose.shape for key in self.keys for pose in key.hands.values() if pose.shape))

    @property
    def sides(self) -> frozenset[Side]:
        """Hands that take part in the gesture."""
        return frozenset(side for key in self.keys for side in key.hands)

    @property
    def stays(self) -> bool:
        """Whether a hand stays at the head, as in listening.

        Such a gesture is not repeated.
        """
        touching = any(pose.touch == "head" for pose in self.keys[-1].hands.values())
        return touching and len(self.keys) == SINGLE_MOVE_KEYS and self.tempo == "sustained"


@dataclass(frozen=True, eq=False)
class Match(NotebookView):
    """Lexicon gesture found for a lexeme, with substitutions."""

    form: GestureForm  # gesture for the hands of the requested mode
    kind: MatchKind = "exact"
    substitute: str = ""  # difference in meaning from the lexeme; empty when the meaning is the same

    def __repr__(self) -> str:
        return f"<{self.kind} match: {self.form}{', ' if self.substitute else ''}{self.substitute}>"
