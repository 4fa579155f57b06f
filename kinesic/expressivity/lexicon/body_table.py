"""The tables `[bodies.CATEGORY]` and `body` of `configs/gestures/*.toml`, in degrees."""

from collections.abc import Mapping
from math import radians

import msgspec

from kinesic.bml.block import Face
from kinesic.body.config import suggestion
from kinesic.expressivity.face.expressions import find_expression
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.lexicon.body_form import BodyForm, LookAt

LARGEST_ANGLE = 45.0  # [deg] of any part
LOWEST = 10.0  # [deg] that shoulders sink at most


class TurnTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A rotation of head or trunk [deg]."""

    turn: float = 0.0  # + left
    tilt: float = 0.0  # + forward, down
    roll: float = 0.0  # + to the right


class BodyFormTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What the body does in a gesture, or in all of a category; what is left out is as the category has it."""

    head: TurnTable | None = None
    nod: float | None = None  # [deg]
    shake: float | None = None  # [deg]
    trunk: TurnTable | None = None
    towards: float | None = None  # [deg]
    shoulders: float | None = None  # [deg]
    gaze: LookAt | None = None
    look: float | None = None  # 0..1
    face: dict[str, float] | None = None  # lexeme of an expression -> amount 0..1


Bodies = Mapping[str, BodyFormTable]  # by category
PLAIN_TABLE = BodyFormTable()


def overlay_table(table: BodyFormTable, category: BodyFormTable) -> BodyFormTable:
    """Lays what a gesture says over what its category says."""
    said = {name: value for name, value in msgspec.structs.asdict(table).items() if value is not None}
    return msgspec.structs.replace(category, **said)


def body_form(table: BodyFormTable) -> BodyForm:
    """Reads a table.

    Raises:
        ValueError: an amount is out of range, or a face has no such expression.
    """
    return BodyForm(
        head=_turn("head", table.head),
        nod=_angle("nod", table.nod, 0.0),
        shake=_angle("shake", table.shake, 0.0),
        trunk=_turn("trunk", table.trunk),
        towards=_angle("towards", table.towards, 0.0),
        shoulders=_angle("shoulders", table.shoulders, -LOWEST),
        gaze=table.gaze or "ahead",
        look=_share("look", table.look or 0.0),
        face=tuple((lexeme, _expressed(lexeme, amount)) for lexeme, amount in (table.face or {}).items()),
    )


def _turn(part: str, table: TurnTable | None) -> Turn:
    if table is None:
        return Turn()
    return Turn(*(_angle(f"{part}.{name}", getattr(table, name), -LARGEST_ANGLE) for name in ("turn", "tilt", "roll")))


def _angle(name: str, written: float | None, least: float) -> float:
    """An angle [rad] that is written in degrees."""
    angle = written or 0.0
    if not least <= angle <= LARGEST_ANGLE:
        raise ValueError(f"body: {name} is {angle:g} deg, outside [{least:g}, {LARGEST_ANGLE:g}]")
    return radians(angle)


def _share(name: str, written: float) -> float:
    if not 0.0 <= written <= 1.0:
        raise ValueError(f"body: {name} is {written:g}, outside [0, 1]")
    return written


def _expressed(lexeme: str, amount: float) -> float:
    if find_expression(Face((lexeme,))).unknown:
        raise ValueError(f"body: no expression for {lexeme}{suggestion(lexeme, ['smile', 'raise_brows', 'sad'])}")
    return _share(f"face.{lexeme}", amount)
