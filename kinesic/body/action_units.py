"""Action units (FACS): the elementary face movements by which a face is told what to show.

The numbers and names are those of the Facial Action Coding System (P. Ekman, W. V. Friesen and J. C. Hager, 2002;
thesis 4.3.1). A key of `Command.face` is a number, after an L or R where the unit has sides: `L12` pulls the left
corner of the mouth, `26` drops the jaw. A number alone means both sides.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import radians
from types import MappingProxyType
from typing import Literal

FaceSide = Literal["left", "right", "both"]

ASIDE = radians(35)  # that eyes at full intensity look to a side
UPWARD = radians(25)
DOWNWARD = radians(30)
INWARD = radians(15)  # that each eye turns towards the nose: at full intensity both meet a few centimetres before it


@dataclass(frozen=True)
class ActionUnit:
    """One movement of the face that can be told apart."""

    number: int
    name: str
    sided: bool = True  # left and right can move apart


UNITS: Mapping[int, ActionUnit] = MappingProxyType(
    {
        unit.number: unit
        for unit in (
            ActionUnit(1, "inner brow raiser"),
            ActionUnit(2, "outer brow raiser"),
            ActionUnit(4, "brow lowerer"),
            ActionUnit(5, "upper lid raiser"),
            ActionUnit(6, "cheek raiser"),
            ActionUnit(7, "lid tightener"),
            ActionUnit(9, "nose wrinkler"),
            ActionUnit(10, "upper lip raiser"),
            ActionUnit(11, "nasolabial deepener"),
            ActionUnit(12, "lip corner puller"),
            ActionUnit(13, "sharp lip puller"),
            ActionUnit(14, "dimpler"),
            ActionUnit(15, "lip corner depressor"),
            ActionUnit(16, "lower lip depressor"),
            ActionUnit(17, "chin raiser", sided=False),
            ActionUnit(18, "lip pucker", sided=False),
            ActionUnit(19, "tongue show", sided=False),
            ActionUnit(20, "lip stretcher"),
            ActionUnit(22, "lip funneler", sided=False),
            ActionUnit(23, "lip tightener", sided=False),
            ActionUnit(24, "lip presser", sided=False),
            ActionUnit(25, "lips part", sided=False),
            ActionUnit(26, "jaw drop", sided=False),
            ActionUnit(27, "mouth stretch", sided=False),
            ActionUnit(28, "lip suck", sided=False),
            ActionUnit(29, "jaw thrust", sided=False),
            ActionUnit(30, "jaw sideways"),
            ActionUnit(32, "lip bite", sided=False),
            ActionUnit(34, "cheek puff", sided=False),
            ActionUnit(43, "eye closure"),
            ActionUnit(45, "blink"),
            ActionUnit(46, "wink"),
            ActionUnit(61, "eyes turn left", sided=False),
            ActionUnit(62, "eyes turn right", sided=False),
            ActionUnit(63, "eyes up", sided=False),
            ActionUnit(64, "eyes down", sided=False),
            ActionUnit(66, "cross-eye", sided=False),
        )
    }
)


def channels(number: int, side: FaceSide = "both") -> tuple[str, ...]:
    """Lists the keys of `Command.face` that move one action unit.

    Args:
        number: of the unit, one of `UNITS`.
        side: on which it moves; a unit without sides moves as a whole.
    """
    if not UNITS[number].sided:
        return (str(number),)
    return {"left": (f"L{number}",), "right": (f"R{number}",), "both": (f"L{number}", f"R{number}")}[side]


def face_keys(unit: str) -> tuple[str, ...]:
    """Lists the keys of `Command.face` for a unit as people write it: with its side, or a number for both sides.

    Returns:
        Nothing for an unknown unit.
    """
    if unit in CHANNELS:
        return (unit,)
    number = int(unit) if unit.isascii() and unit.isdigit() and len(unit) <= 2 else 0
    return channels(number) if number in UNITS else ()


def unknown_unit(unit: str) -> str:
    """Says that there is no such unit, and which would have worked."""
    if unit[:1] in ("L", "R") and face_keys(unit[1:]):
        return f"no action unit {unit}: {UNITS[int(unit[1:])].name} has no sides; write {unit[1:]}"
    sided = ", ".join(str(number) for number, each in UNITS.items() if each.sided)
    whole = ", ".join(str(number) for number, each in UNITS.items() if not each.sided)
    return f"no action unit {unit}; known: {sided} (on one side: L or R before it), {whole}"


CHANNELS: tuple[str, ...] = tuple(channel for number in UNITS for channel in channels(number))
