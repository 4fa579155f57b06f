"""Body motion that accompanies a gesture, as defined in the lexicon."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import degrees
from typing import Literal

from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.turns import UPRIGHT_TURN, scale_turn, turn_angles

# Gaze target: the listener, the robot's hands, the pointed place, or away by twice the rotation of the head.
LookAt = Literal["ahead", "hands", "place", "away"]


@dataclass(frozen=True)
class BodyForm:
    """Motion of head, trunk, shoulders, gaze and face at the stroke.

    It belongs to the hands as the gesture form defines them.
    """

    head: Turn = UPRIGHT_TURN  # rotation from upright, independent of the trunk
    nod: float = 0.0  # [rad] tilt down with each stroke
    shake: float = 0.0  # [rad] shake to both sides during the stroke, first to the left; below 0 first to the right
    trunk: Turn = UPRIGHT_TURN
    towards: float = 0.0  # [rad] largest trunk rotation towards the gaze target
    along: float = 0.0  # weight of the trunk rotation that follows the hands, set by the style
    shoulders: float = 0.0  # [rad] elevation of the collar bones on the sides of the hands
    gaze: LookAt = "ahead"  # target of the gaze
    look: float = 0.0  # fraction of a gaze performed by the head; the eyes perform the rest
    face: tuple[tuple[str, float], ...] = ()  # (lexeme of an expression, amount 0..1)

    @property
    def mirrored(self) -> "BodyForm":
        """Body motion with left and right exchanged."""
        return replace(self, head=_mirror(self.head), shake=-self.shake, trunk=_mirror(self.trunk))

    @property
    def symmetric(self) -> "BodyForm":
        """Body motion without rotations to the side."""
        return replace(self, head=Turn(tilt=self.head.tilt), trunk=Turn(tilt=self.trunk.tilt))

    def weighed(self, *, head: float, trunk: float, shoulders: float, face: float) -> "BodyForm":
        """Scale the motion of head, trunk, shoulders and face by separate weights.

        Without head weight the gaze stays ahead.
        """
        return BodyForm(
            head=scale_turn(self.head, head),
            nod=self.nod * head,
            shake=self.shake * head,
            trunk=scale_turn(self.trunk, trunk),
            towards=self.towards * trunk,
            along=trunk,
            shoulders=self.shoulders * shoulders,
            gaze=self.gaze if head > 0.0 else "ahead",
            look=min(self.look * head, 1.0),
            face=tuple((lexeme, min(amount * face, 1.0)) for lexeme, amount in self.face if face > 0.0),
        )

    def __str__(self) -> str:
        """Return a short description of the body motion.

        It is like `nod 4, shoulders 3 deg; eyes on the hands; raise_brows 0.2`. It is empty when only the hands move.
        """
        angles = {
            **_named("head", self.head),
            "nod": self.nod,
            "shake": abs(self.shake),
            **_named("trunk", self.trunk),
            "trunk towards it": self.towards,
            "shoulders": self.shoulders,
        }
        moved = ", ".join(f"{name} {round(degrees(angle), 1):g}" for name, angle in angles.items() if angle)
        shown = ", ".join(f"{lexeme} {amount:g}" for lexeme, amount in self.face)
        return "; ".join(filter(None, (f"{moved} deg" if moved else "", GAZE_TEXTS[self.gaze], shown)))


GAZE_TEXTS: Mapping[LookAt, str] = {
    "ahead": "",
    "hands": "eyes on the hands",
    "place": "eyes on the place",
    "away": "eyes away",
}
NO_BODY = BodyForm()  # body motion of gestures that move only the hands


def _named(part: str, turn: Turn) -> dict[str, float]:
    labels = (
        ("left", "right"),
        ("down", "up") if part == "head" else ("forward", "back"),
        ("aside right", "aside left"),
    )
    angles = zip(turn_angles(turn), labels, strict=True)
    return {f"{part} {plus if angle > 0 else minus}": abs(angle) for angle, (plus, minus) in angles}


def _mirror(turn: Turn) -> Turn:
    return Turn(-turn.torsion, turn.tilt, -turn.roll)
