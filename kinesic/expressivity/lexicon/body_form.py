"""What head, trunk, collar bones, gaze and face do beside the hands of a gesture, as the lexicon says it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import degrees
from typing import Literal

from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.turns import UPRIGHT, scale_turn, turn_angles

LookAt = Literal["ahead", "hands", "place", "away"]  # the listener; the own hands; where they point; beyond the head


@dataclass(frozen=True)
class BodyForm:
    """The body's part in a gesture at its stroke, for the hands as the form has them."""

    head: Turn = UPRIGHT  # away from upright, whatever the trunk does
    nod: float = 0.0  # [rad] down with each stroke
    shake: float = 0.0  # [rad] to either side while the stroke lasts, first to the left, or below 0 to the right
    trunk: Turn = UPRIGHT
    towards: float = 0.0  # [rad] that the trunk turns at most to what is looked at
    shoulders: float = 0.0  # [rad] that the collar bones of its hands rise
    gaze: LookAt = "ahead"
    look: float = 0.0  # share of a gaze that the head takes; eyes do the rest
    face: tuple[tuple[str, float], ...] = ()  # lexemes of expressions, and their amounts 0..1

    @property
    def mirrored(self) -> "BodyForm":
        """The same with left for right."""
        return replace(self, head=_mirror(self.head), shake=-self.shake, trunk=_mirror(self.trunk))

    @property
    def symmetric(self) -> "BodyForm":
        """Without what goes to one side: for a hand and its mirror image together."""
        return replace(self, head=Turn(tilt=self.head.tilt), trunk=Turn(tilt=self.trunk.tilt))

    def weighed(self, *, head: float, trunk: float, shoulders: float, face: float) -> "BodyForm":
        """Makes each part smaller or larger; nothing is left of the gaze where the head has no weight."""
        return BodyForm(
            head=scale_turn(self.head, head),
            nod=self.nod * head,
            shake=self.shake * head,
            trunk=scale_turn(self.trunk, trunk),
            towards=self.towards * trunk,
            shoulders=self.shoulders * shoulders,
            gaze=self.gaze if head > 0.0 else "ahead",
            look=min(self.look * head, 1.0),
            face=tuple((lexeme, min(amount * face, 1.0)) for lexeme, amount in self.face if face > 0.0),
        )

    def __str__(self) -> str:
        """In words: `nod 4, shoulders 3 deg; eyes on the hands; raise_brows 0.2`; empty when only the hands move."""
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
        return "; ".join(filter(None, (f"{moved} deg" if moved else "", GAZES[self.gaze], shown)))


GAZES: Mapping[LookAt, str] = {
    "ahead": "",
    "hands": "eyes on the hands",
    "place": "eyes on the place",
    "away": "eyes away",
}
NO_BODY = BodyForm()  # the hands alone


def _named(part: str, turn: Turn) -> dict[str, float]:
    ways = (("left", "right"), ("down", "up") if part == "head" else ("forward", "back"), ("aside right", "aside left"))
    angles = zip(turn_angles(turn), ways, strict=True)
    return {f"{part} {plus if angle > 0 else minus}": abs(angle) for angle, (plus, minus) in angles}


def _mirror(turn: Turn) -> Turn:
    return Turn(-turn.torsion, turn.tilt, -turn.roll)
