"""TOML tables of body motion that accompanies gestures, in degrees."""

from collections.abc import Mapping
from math import radians

import msgspec

from kinesic.bml.block import Face
from kinesic.body.config import suggestion
from kinesic.expressivity.face.expressions import find_expression
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.lexicon.body_form import BodyForm, LookAt

LARGEST_ANGLE = 45.0  # [deg] largest accepted rotation of any body part
LARGEST_SHOULDER_DROP = 10.0  # [deg] largest accepted lowering of the shoulders


class TurnTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML table of a head or trunk rotation [deg]."""

    turn: float = 0.0  # [deg] rotation to the left
    tilt: float = 0.0  # [deg] rotation forward or down
    roll: float = 0.0  # [deg] rotation to the right side


class BodyFormTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML table of the body motion of a gesture or category.

    Missing keys are inherited from the category.
    """

    head: TurnTable | None = None  # rotation of the head from upright
    nod: float | None = None  # [deg] down with each stroke
    shake: float | None = None  # [deg] to both sides during the stroke; below 0 first to the right
    trunk: TurnTable | None = None  # rotation of the trunk from upright
    towards: float | None = None  # [deg] largest trunk rotation towards the gaze target
    shoulders: float | None = None  # [deg] elevation of the collar bones
    gaze: LookAt | None = None  # target of the gaze
    look: float | None = None  # 0..1: fraction of a gaze performed by the head
    face: dict[str, float] | None = None  # amount 0..1 of each expression


Bodies = Mapping[str, BodyFormTable]  # by category
PLAIN_TABLE = BodyFormTable()  # body motion of a gesture without a table


def overlay_table(table: BodyFormTable, category: BodyFormTable) -> BodyFormTable:
    """Return a category's table, overridden by the keys that a gesture sets."""
    values = {name: value for name, value in msgspec.structs.asdict(table).items() if value is not None}
    return msgspec.structs.replace(category, **values)


def body_form(table: BodyFormTable) -> BodyForm:
    """Convert a table to a body form, and check its ranges.

    Raises:
        ValueError: an amount is out of range, or the face has no such expression.
    """
    return BodyForm(
        head=_turn("head", table.head),
        nod=_angle("nod", table.nod, 0.0),
        shake=_angle("shake", table.shake, 0.0),
        trunk=_turn("trunk", table.trunk),
        towards=_angle("towards", table.towards, 0.0),
        shoulders=_angle("shoulders", table.shoulders, -LARGEST_SHOULDER_DROP),
        gaze=table.gaze or "ahead",
        look=_fraction("look", table.look or 0.0),
        face=tuple((lexeme, _expressed(lexeme, amount)) for lexeme, amount in (table.face or {}).items()),
    )


def _turn(part: str, table: TurnTable | None) -> Turn:
    if table is None:
        return Turn()
    return Turn(*(_angle(f"{part}.{name}", getattr(table, name), -LARGEST_ANGLE) for name in ("turn", "tilt", "roll")))


def _angle(name: str, value: float | None, least: float) -> float:
    """Convert an angle in degrees to radians [rad], and check its range.

    Raises:
        ValueError: the angle is out of range.
    """
    angle = value or 0.0
    if not least <= angle <= LARGEST_ANGLE:
        raise ValueError(f"body: {name} is {angle:g} deg, outside [{least:g}, {LARGEST_ANGLE:g}]")
    return radians(angle)


def _fraction(name: str, value: float) -> float:
    if not 0.0 <= value <= 1.0:
        raise ValueError(f"body: {name} is {value:g}, outside [0, 1]")
    return value


def _expressed(lexeme: str, amount: float) -> float:
    if find_expression(Face((lexeme,))).unknown:
        raise ValueError(f"body: no expression for {lexeme}{suggestion(lexeme, ['smile', 'raise_brows', 'sad'])}")
    return _fraction(f"face.{lexeme}", amount)
